// SPDX-License-Identifier: MIT
#include "core/tri_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace swallowclip {

std::string ManifoldReport::text() const {
  if (closed()) return "closed 2-manifold";
  return fmt::format(
      "{} open, {} non-manifold and {} flipped edges, {} pinched vertices, {} degenerate triangles "
      "(first bad edge: vertices {} and {})",
      openEdges, nonManifoldEdges, flippedEdges, badVertices, degenerate, firstBadEdge[0],
      firstBadEdge[1]);
}

namespace {
// A vertex is regular when its triangles form one fan: as many as there are distinct
// neighbours, and connected by walking next-edges.
int countPinchedVertices(std::span<const Triangle> triangles, int vertexCount) {
  std::vector<std::vector<std::pair<int, int>>> spokes(vertexCount);
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) spokes[t[k]].push_back({t[(k + 1) % 3], t[(k + 2) % 3]});
  int bad = 0;
  for (auto& s : spokes) {
    if (s.empty()) continue;
    std::sort(s.begin(), s.end());
    const int start = s[0].first;
    int at = start;
    size_t walked = 0;
    do {
      auto it = std::lower_bound(s.begin(), s.end(), std::pair{at, -1});
      if (it == s.end() || it->first != at) break;
      at = it->second;
      ++walked;
    } while (at != start && walked <= s.size());
    if (walked != s.size()) ++bad;
  }
  return bad;
}
}  // namespace

ManifoldReport checkManifold(std::span<const Triangle> triangles, int vertexCount) {
  ManifoldReport r;
  // per undirected edge: walks forwards and backwards
  std::map<std::pair<int, int>, std::array<int, 2>> edges;
  for (const Triangle& t : triangles) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) ++r.degenerate;
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      ++edges[{std::min(a, b), std::max(a, b)}][a < b ? 0 : 1];
    }
  }
  for (const auto& [edge, n] : edges) {
    if (n[0] == 1 && n[1] == 1) continue;
    if (r.firstBadEdge[0] < 0) r.firstBadEdge = {edge.first, edge.second};
    if (n[0] + n[1] == 1)
      ++r.openEdges;
    else if (n[0] + n[1] == 2)
      ++r.flippedEdges;
    else
      ++r.nonManifoldEdges;
  }
  if (r.closed()) r.badVertices = countPinchedVertices(triangles, vertexCount);
  return r;
}

double volume(std::span<const Vec3> p, std::span<const Triangle> triangles) {
  double v = 0;
  for (const Triangle& t : triangles) v += p[t[0]].dot(p[t[1]].cross(p[t[2]]));
  return v / 6;
}
double volume(const TriMesh& m) {
  return volume(m.positions, m.triangles);
}

std::vector<Vec3> vertexNormals(std::span<const Vec3> p, std::span<const Triangle> triangles) {
  std::vector<Vec3> n(p.size(), Vec3::Zero());
  for (const Triangle& t : triangles) {
    const Vec3 a = (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]);
    for (int k : t) n[k] += a;
  }
  for (Vec3& v : n) {
    const double l = v.norm();
    v = l > 0 ? Vec3(v / l) : Vec3::UnitZ();
  }
  return n;
}

Vec3 closestBarycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double v = d1 / (d1 - d3);
    return {1 - v, v, 0};
  }
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double w = d2 / (d2 - d6);
    return {1 - w, 0, w};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double denominator = 1 / (va + vb + vc);
  const double v = vb * denominator, w = vc * denominator;
  return {1 - v - w, v, w};
}

double windingNumber(const Vec3& p, std::span<const Vec3> x, std::span<const Triangle> triangles) {
  double sum = 0;
  for (const Triangle& t : triangles) {
    const Vec3 a = x[t[0]] - p, b = x[t[1]] - p, c = x[t[2]] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)),
                          la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4 * kPi);
}
}  // namespace swallowclip
