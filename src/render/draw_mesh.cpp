// SPDX-License-Identifier: MIT
#include "render/draw_mesh.h"

#include <algorithm>
#include <cmath>

namespace swallowclip::render {
namespace {

Vec3f areaNormal(const Triangle& t, std::span<const Vec3f> p) {
  return (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]);
}

// Corners around each vertex, as CSR: corner index = 3 * triangle + k.
struct Corners {
  std::vector<int> begin, list;
};

Corners cornersOf(std::span<const Triangle> triangles, std::size_t vertices) {
  Corners c;
  c.begin.assign(vertices + 1, 0);
  for (const Triangle& t : triangles)
    for (int v : t) ++c.begin[v + 1];
  for (std::size_t v = 0; v < vertices; ++v) c.begin[v + 1] += c.begin[v];
  c.list.resize(triangles.size() * 3);
  std::vector<int> fill(c.begin.begin(), c.begin.end() - 1);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) c.list[fill[triangles[i][k]]++] = static_cast<int>(3 * i + k);
  return c;
}
}  // namespace

DrawMesh buildDrawMesh(std::span<const Triangle> triangles, std::span<const Vec3f> positions,
                       double creaseAngle_rad) {
  DrawMesh mesh;
  mesh.triangles.assign(triangles.begin(), triangles.end());
  mesh.rest.assign(positions.begin(), positions.end());
  mesh.indices.resize(triangles.size() * 3);
  std::vector<Vec3f> normal(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i)
    normal[i] = areaNormal(triangles[i], positions).normalized();
  std::vector<Vec3> exact;
  for (const Vec3f& p : positions) exact.push_back(p.cast<double>());
  mesh.closed = checkManifold(triangles, static_cast<int>(positions.size())).closed() &&
                volume(exact, triangles) > 0;
  const Corners corners = cornersOf(triangles, positions.size());
  const float agree = static_cast<float>(std::cos(creaseAngle_rad));
  std::vector<int> parent;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const int begin = corners.begin[v], n = corners.begin[v + 1] - begin;
    // join corners whose triangles share an edge at v and agree; what stays apart is a crease
    parent.resize(n);
    for (int a = 0; a < n; ++a) parent[a] = a;
    const auto root = [&](int a) {
      while (parent[a] != a) a = parent[a];
      return a;
    };
    const auto next = [&](int a, int step) {
      const int c = corners.list[begin + a];
      return triangles[c / 3][(c % 3 + step) % 3];
    };
    for (int a = 0; a < n; ++a)
      for (int b = a + 1; b < n; ++b) {
        const bool edge = next(a, 1) == next(b, 2) || next(a, 2) == next(b, 1);
        const Vec3f& na = normal[corners.list[begin + a] / 3];
        if (edge && na.dot(normal[corners.list[begin + b] / 3]) >= agree)
          parent[std::max(root(a), root(b))] = std::min(root(a), root(b));
      }
    std::vector<int> vertexOfRoot(n, -1);
    for (int a = 0; a < n; ++a) {
      int& made = vertexOfRoot[root(a)];
      if (made < 0) {
        made = static_cast<int>(mesh.source.size());
        mesh.source.push_back(static_cast<int>(v));
      }
      mesh.indices[corners.list[begin + a]] = static_cast<std::uint32_t>(made);
    }
  }
  return mesh;
}

std::vector<Vertex> drawVertices(const DrawMesh& mesh, std::span<const Vec3f> positions) {
  std::vector<Vertex> out(mesh.source.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = {positions[mesh.source[i]], Vec3f::Zero(), mesh.rest[mesh.source[i]]};
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    Vertex &a = out[mesh.indices[i]], &b = out[mesh.indices[i + 1]], &c = out[mesh.indices[i + 2]];
    const Vec3f n = (b.position - a.position).cross(c.position - a.position);
    a.normal += n;
    b.normal += n;
    c.normal += n;
  }
  for (Vertex& v : out) {
    const float length = v.normal.norm();
    v.normal = length > 0 ? Vec3f(v.normal / length) : Vec3f(0, 0, 1);
  }
  return out;
}

std::vector<Vec3f> sectionSegments(std::span<const Triangle> triangles,
                                   std::span<const Vec3f> positions, const Vec3f& normal,
                                   float offset_m) {
  std::vector<float> height(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    height[i] = normal.dot(positions[i]) - offset_m;
  std::vector<Vec3f> out;
  for (const Triangle& t : triangles) {
    Vec3f down = Vec3f::Zero(), up = Vec3f::Zero();
    int crossings = 0;
    for (int k = 0; k < 3; ++k) {
      // each edge is cut from its lower to its higher index: both neighbours get the same point
      const int a = std::min(t[k], t[(k + 1) % 3]), b = std::max(t[k], t[(k + 1) % 3]);
      if ((height[a] > 0) == (height[b] > 0)) continue;
      const float f = height[a] / (height[a] - height[b]);
      (height[t[k]] > 0 ? down : up) = positions[a] + f * (positions[b] - positions[a]);
      ++crossings;
    }
    if (crossings == 2) out.insert(out.end(), {down, up});
  }
  return out;
}

std::vector<Vertex> sectionFan(std::span<const Vec3f> segments, const Vec3f& normal) {
  std::vector<Vertex> out;
  if (segments.empty()) return out;
  Vec3f centre = Vec3f::Zero();
  for (const Vec3f& p : segments) centre += p;
  centre /= static_cast<float>(segments.size());
  out.reserve(segments.size() / 2 * 3);
  for (std::size_t i = 0; i + 1 < segments.size(); i += 2)
    for (const Vec3f& p : {centre, segments[i], segments[i + 1]}) out.push_back({p, normal, p});
  return out;
}

std::vector<Vertex> sectionOutline(std::span<const Vec3f> segments, const Vec3f& normal,
                                   float width_m, float lift_m) {
  std::vector<Vertex> out;
  for (std::size_t i = 0; i + 1 < segments.size(); i += 2) {
    const Vec3f step = segments[i + 1] - segments[i];
    if (step.squaredNorm() < 1e-14f) continue;
    const Vec3f along = step.normalized() * (0.4f * width_m);
    const Vec3f side = normal.cross(along).normalized() * (0.5f * width_m);
    const Vec3f lift = normal * lift_m;
    const Vec3f p0 = segments[i] - along + lift, p1 = segments[i + 1] + along + lift;
    for (const Vec3f& p : {Vec3f(p0 - side), Vec3f(p1 - side), Vec3f(p1 + side), Vec3f(p0 - side),
                           Vec3f(p1 + side), Vec3f(p0 + side)})
      out.push_back({p, normal, p});
  }
  return out;
}
}  // namespace swallowclip::render
