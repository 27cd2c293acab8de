// SPDX-License-Identifier: MIT
#include "anatomy/mesh_repair.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>

namespace swallowclip::anatomy {
namespace {

/// Corners nearer than this share of the bounding-box diagonal are one vertex: well above the
/// rounding of text files (6 digits), well below any edge. Assumed, 1e-7..1e-5.
constexpr double kWeldShare = 1e-6;
/// A frame whose median edge is this many times longer than on frame 0 has another vertex order
/// (tissue stretches by less than 2). Assumed, 2..5.
constexpr double kScrambledStretch = 3;

double diagonal(std::span<const Vec3> p) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : p) box.extend(x);
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

struct UnionFind {
  std::vector<int> parent;
  explicit UnionFind(std::size_t n) : parent(n) { std::iota(parent.begin(), parent.end(), 0); }
  int root(int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  }
  /// The lower index leads, so that the outcome doesn't depend on the order of joining.
  void join(int a, int b) {
    a = root(a), b = root(b);
    if (a != b) parent[std::max(a, b)] = std::min(a, b);
  }
};

/// Leader (lowest corner) of all corners within `tolerance` of each other.
std::vector<int> weldGroups(std::span<const Vec3> p, double tolerance) {
  UnionFind groups(p.size());
  Eigen::AlignedBox3d box;
  for (const Vec3& x : p) box.extend(x);
  // cells of two tolerances; 1e6 cells across fit in 21 bits per axis
  const auto cellOf = [&](const Vec3& x) -> Eigen::Array3i {
    return ((x - box.min()) / (2 * tolerance)).array().floor().cast<int>() + 1;
  };
  const auto key = [](const Eigen::Array3i& c) {
    return (std::int64_t(c[0]) << 42) | (std::int64_t(c[1]) << 21) | std::int64_t(c[2]);
  };
  std::unordered_map<std::int64_t, std::vector<int>> cells;
  for (int i = 0; i < int(p.size()); ++i) {
    const Eigen::Array3i c = cellOf(p[i]);
    bool exact = false;
    if (const auto own = cells.find(key(c)); own != cells.end())
      for (int j : own->second)
        if (p[j] == p[i]) {
          groups.join(i, j);
          exact = true;
          break;
        }
    if (exact) continue;  // its twin has met the neighbours already
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz)
          if (const auto it = cells.find(key(c + Eigen::Array3i(dx, dy, dz))); it != cells.end())
            for (int j : it->second)
              if ((p[j] - p[i]).norm() <= tolerance) groups.join(i, j);
    cells[key(c)].push_back(i);
  }
  std::vector<int> leader(p.size());
  for (int i = 0; i < int(p.size()); ++i) leader[i] = groups.root(i);
  return leader;
}

/// Corner triangles, cut on frame 0 only: a reader would cut each frame's quads along another
/// diagonal.
std::vector<Triangle> cutPolygons(const RawMesh& m) {
  std::vector<Triangle> triangles;
  for (const auto& f : m.faces) {
    const auto length2 = [&](int a, int b) {
      return (m.corners[f[a]] - m.corners[f[b]]).squaredNorm();
    };
    if (f.size() == 4 && length2(1, 3) < length2(0, 2)) {
      triangles.push_back({f[0], f[1], f[3]});
      triangles.push_back({f[1], f[2], f[3]});
      continue;
    }
    for (std::size_t k = 2; k < f.size(); ++k) triangles.push_back({f[0], f[k - 1], f[k]});
  }
  return triangles;
}

/// Two corners of neighbouring triangles that are one tissue point at either end of a shared edge.
struct SharedEdge {
  int a0, a1, b0, b1;  ///< edge a0-b0 in one triangle, a1-b1 in the other
};

std::vector<SharedEdge> sharedEdges(std::span<const Triangle> corners,
                                    std::span<const int> leader) {
  struct Use {
    int a, b;
  };
  std::map<std::pair<int, int>, std::vector<Use>> uses;
  for (const Triangle& t : corners)
    for (int k = 0; k < 3; ++k) {
      int a = t[k], b = t[(k + 1) % 3];
      if (leader[a] == leader[b]) continue;
      if (leader[a] > leader[b]) std::swap(a, b);
      uses[{leader[a], leader[b]}].push_back({a, b});
    }
  std::vector<SharedEdge> shared;
  for (const auto& [edge, u] : uses)
    if (u.size() == 2) shared.push_back({u[0].a, u[1].a, u[0].b, u[1].b});
  return shared;
}

Result<void> checkCounts(const RawMesh& first, const RawMesh& m) {
  const char* remedy =
      "Export all frames from one mesh, without modifiers that add or reorder vertices.";
  if (m.fileVertices != first.fileVertices || m.faces.size() != first.faces.size() ||
      m.corners.size() != first.corners.size())
    return usageError(
        m.file,
        fmt::format("has {} vertices and {} faces, but frame 0 ({}) has {} and {}", m.fileVertices,
                    m.faces.size(), first.file, first.fileVertices, first.faces.size()),
        remedy);
  for (std::size_t f = 0; f < m.faces.size(); ++f)
    if (m.faces[f] != first.faces[f])
      return usageError(m.file,
                        fmt::format("face {} of {} joins other vertices than in frame 0 ({})", f,
                                    m.faces.size(), first.file),
                        remedy);
  return {};
}

Result<void> checkSharedEdges(const RawMesh& first, const RawMesh& m,
                              std::span<const SharedEdge> shared) {
  const double near = 2 * kWeldShare * std::max(diagonal(first.corners), diagonal(m.corners));
  int torn = 0;
  std::vector<double> stretch;
  for (const SharedEdge& e : shared) {
    torn += (m.corners[e.a0] - m.corners[e.a1]).norm() > near ||
            (m.corners[e.b0] - m.corners[e.b1]).norm() > near;
    stretch.push_back((m.corners[e.a0] - m.corners[e.b0]).norm() /
                      (first.corners[e.a0] - first.corners[e.b0]).norm());
  }
  const char* remedy = "Export all frames with the same vertex and face order.";
  if (torn > 0)
    return usageError(m.file,
                      fmt::format("its {} faces are not those of frame 0 ({}): {} of {} edges "
                                  "shared there have come apart",
                                  m.faces.size(), first.file, torn, shared.size()),
                      remedy);
  if (stretch.empty()) return {};
  std::nth_element(stretch.begin(), stretch.begin() + stretch.size() / 2, stretch.end());
  const double median = stretch[stretch.size() / 2];
  if (median > kScrambledStretch || median < 1 / kScrambledStretch)
    return usageError(m.file,
                      fmt::format("half of its {} edges are {:.1f} times as long as in frame 0 "
                                  "({}): the vertices are in another order or unit",
                                  shared.size(), median, first.file),
                      remedy);
  return {};
}

/// Fans (corners joined through shared edges) that coincide on frame 0 but part in another frame
/// get leaders of their own. Returns how many new vertices that made.
int separateTouching(std::span<const RawMesh> frames, std::span<const SharedEdge> shared,
                     std::vector<int>& leader) {
  UnionFind fans(leader.size());
  for (const SharedEdge& e : shared) fans.join(e.a0, e.a1), fans.join(e.b0, e.b1);
  std::map<int, std::set<int>> fansOf;
  for (int i = 0; i < int(leader.size()); ++i) fansOf[leader[i]].insert(fans.root(i));
  int added = 0;
  std::vector<double> near;
  for (const RawMesh& m : frames) near.push_back(2 * kWeldShare * diagonal(m.corners));
  std::map<int, int> fanLeader;
  for (const auto& [group, members] : fansOf) {
    std::vector<int> leaders;
    for (int fan : members) {
      const auto together = [&](int other) {
        for (std::size_t k = 0; k < frames.size(); ++k)
          if ((frames[k].corners[fan] - frames[k].corners[other]).norm() > near[k]) return false;
        return true;
      };
      const auto it = std::find_if(leaders.begin(), leaders.end(), together);
      fanLeader[fan] = it == leaders.end() ? fan : *it;
      if (it == leaders.end()) leaders.push_back(fan);
    }
    added += int(leaders.size()) - 1;
  }
  for (int i = 0; i < int(leader.size()); ++i) leader[i] = fanLeader[fans.root(i)];
  return added;
}

}  // namespace

/// Renumbers so that only used vertices remain, in their old order.
void compact(SurfaceMap& map) {
  std::vector<int> number(map.corner.size(), -1);
  for (const Triangle& t : map.triangles)
    for (int v : t) number[v] = 0;
  SurfaceMap out;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = int(out.corner.size());
    out.corner.push_back(map.corner[v]);
    out.mirrored.push_back(map.mirrored[v]);
    out.onPlane.push_back(map.onPlane[v]);
  }
  out.triangles = std::move(map.triangles);
  for (Triangle& t : out.triangles)
    for (int& v : t) v = number[v];
  map = std::move(out);
}

std::vector<Vec3> SurfaceMap::apply(std::span<const Vec3> corners) const {
  std::vector<Vec3> p(corner.size());
  for (std::size_t v = 0; v < p.size(); ++v) {
    p[v] = corners[corner[v]];
    if (mirrored[v]) p[v].x() = -p[v].x();
    if (onPlane[v]) p[v].x() = 0;
  }
  return p;
}

double SurfaceMap::seamShift(std::span<const Vec3> corners) const {
  double worst = 0;
  for (std::size_t v = 0; v < corner.size(); ++v)
    if (onPlane[v]) worst = std::max(worst, std::abs(corners[corner[v]].x()));
  return worst;
}

Result<SurfaceMap> weldFrames(std::span<const RawMesh> frames, std::vector<std::string>& report) {
  const RawMesh& first = frames.front();
  std::vector<int> leader = weldGroups(first.corners, kWeldShare * diagonal(first.corners));
  const std::vector<Triangle> triangles = cutPolygons(first);
  const std::vector<SharedEdge> shared = sharedEdges(triangles, leader);
  for (std::size_t k = 1; k < frames.size(); ++k) {
    if (auto same = checkCounts(first, frames[k]); !same) return std::unexpected(same.error());
    if (auto same = checkSharedEdges(first, frames[k], shared); !same)
      return std::unexpected(same.error());
  }
  if (frames.size() > 1)
    if (const int parted = separateTouching(frames, shared, leader); parted > 0)
      report.push_back(fmt::format(
          "{}: {} vertices only touch on frame 0 and part later; kept apart", first.file, parted));
  SurfaceMap map;
  for (int i = 0; i < int(leader.size()); ++i) map.corner.push_back(i);
  map.mirrored.assign(leader.size(), 0);
  map.onPlane.assign(leader.size(), 0);
  int collapsed = 0;
  for (const Triangle& t : triangles) {
    const Triangle w{leader[t[0]], leader[t[1]], leader[t[2]]};
    if (w[0] == w[1] || w[1] == w[2] || w[2] == w[0])
      ++collapsed;
    else
      map.triangles.push_back(w);
  }
  compact(map);
  if (collapsed > 0)
    report.push_back(fmt::format("{}: {} triangles without area left out", first.file, collapsed));
  if (map.triangles.empty())
    return usageError(first.file, "has no triangle with an area", "Export its faces too.");
  return map;
}

Result<void> mirrorHalf(SurfaceMap& map, const RawMesh& rest, HalfSide side, double tolerance_m,
                        const std::string& name, std::vector<std::string>& report) {
  if (side == HalfSide::whole) return {};
  const std::vector<Vec3> p = map.apply(rest.corners);
  double lo = 0, hi = 0;
  for (const Vec3& x : p) lo = std::min(lo, x.x()), hi = std::max(hi, x.x());
  const auto inPlane = [&](int v) { return std::abs(p[v].x()) <= tolerance_m; };
  std::map<std::pair<int, int>, int> edgeUses;
  int caps = 0;
  for (const Triangle& t : map.triangles) {
    caps += inPlane(t[0]) && inPlane(t[1]) && inPlane(t[2]);
    for (int k = 0; k < 3; ++k) ++edgeUses[std::minmax(t[k], t[(k + 1) % 3])];
  }
  int openInPlane = 0;
  for (const auto& [edge, uses] : edgeUses)
    openInPlane += uses == 1 && inPlane(edge.first) && inPlane(edge.second);
  const bool cut = caps + openInPlane > 0;
  if (side == HalfSide::guess) {
    if (!cut || (lo < -tolerance_m) == (hi > tolerance_m)) return {};
    side = hi > tolerance_m ? HalfSide::left : HalfSide::right;
    report.push_back(
        fmt::format("{}: guessed to be a {} half (all on one side of x = 0, cut there)", name,
                    side == HalfSide::left ? "left" : "right"));
  }
  const double beyond = side == HalfSide::left ? -lo : hi;
  if (beyond > tolerance_m || !cut)
    return usageError(
        rest.file,
        fmt::format("{} is called a {} half, but x runs from {:.2f} to {:.2f} mm and {} edges or "
                    "faces lie in the midsagittal plane x = 0 (tolerance {:.2f} mm)",
                    name, side == HalfSide::left ? "left" : "right", lo * 1e3, hi * 1e3,
                    caps + openInPlane, tolerance_m * 1e3),
        "Set \"half\" to \"whole\", or \"origin_mm\" and \"axes\" so that the cut lies on x = 0.");
  std::erase_if(map.triangles,
                [&](const Triangle& t) { return inPlane(t[0]) && inPlane(t[1]) && inPlane(t[2]); });
  for (std::size_t v = 0; v < p.size(); ++v) map.onPlane[v] = inPlane(int(v));
  compact(map);
  const int n = int(map.corner.size());
  std::vector<int> twin(n);
  for (int v = 0; v < n; ++v) {
    twin[v] = map.onPlane[v] ? v : int(map.corner.size());
    if (map.onPlane[v]) continue;
    map.corner.push_back(map.corner[v]);
    map.mirrored.push_back(1);
    map.onPlane.push_back(0);
  }
  const std::size_t half = map.triangles.size();
  for (std::size_t k = 0; k < half; ++k) {
    const Triangle t = map.triangles[k];
    map.triangles.push_back({twin[t[0]], twin[t[2]], twin[t[1]]});
  }
  const int added = int(map.corner.size()) - n;
  report.push_back(fmt::format(
      "{}: {} midsagittal faces removed, {} vertices mirrored, {} stitched on the seam (moved by "
      "at "
      "most {:.3f} mm, tolerance {:.3f} mm)",
      name, caps, added, n - added, map.seamShift(rest.corners) * 1e3, tolerance_m * 1e3));
  return {};
}
}  // namespace swallowclip::anatomy
