// SPDX-License-Identifier: MIT
#include "anatomy/mesh_repair.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

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
/// Hole filling costs the cube of the edge count; beyond this it is no hole but an open surface.
constexpr int kMaxHoleEdges = 1500;
constexpr int kEdgesNamed = 4;  ///< in messages

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
}  // namespace

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

namespace {
namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using CgalMesh = CGAL::Surface_mesh<Point>;

/// "4 open and 2 non-manifold edges, the first from (1.0, 2.0, 3.0) to (...) mm, ..."
std::string badEdges(std::span<const Triangle> triangles, std::span<const Vec3> p) {
  const ManifoldReport r = checkManifold(triangles, int(p.size()));
  std::map<std::pair<int, int>, std::array<int, 2>> uses;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      ++uses[std::minmax(a, b)][a < b];
    }
  std::string text = fmt::format("{} open, {} non-manifold, {} flipped edges, {} pinched vertices",
                                 r.openEdges, r.nonManifoldEdges, r.flippedEdges, r.badVertices);
  int named = 0;
  for (const auto& [edge, n] : uses) {
    if ((n[0] == 1 && n[1] == 1) || named++ >= kEdgesNamed) continue;
    const Vec3 a = p[edge.first] * 1e3, b = p[edge.second] * 1e3;
    text += fmt::format("{} {}-{} from ({:.2f}, {:.2f}, {:.2f}) to ({:.2f}, {:.2f}, {:.2f}) mm",
                        named == 1 ? "; edges" : ",", edge.first, edge.second, a.x(), a.y(), a.z(),
                        b.x(), b.y(), b.z());
  }
  return named > kEdgesNamed ? text + " ..." : text;
}

/// Fills every hole with triangles between its own vertices. Returns "" or what stood in the way.
std::string fillHoles(CgalMesh& mesh, int& holes, int& largest) {
  std::vector<CgalMesh::Halfedge_index> cycles;
  pmp::extract_boundary_cycles(mesh, std::back_inserter(cycles));
  for (const auto start : cycles) {
    int edges = 0;
    auto h = start;
    do h = mesh.next(h), ++edges;
    while (h != start);
    largest = std::max(largest, edges);
    if (edges > kMaxHoleEdges)
      return fmt::format("a hole of {} edges is more than can be filled ({})", edges,
                         kMaxHoleEdges);
    std::vector<CgalMesh::Face_index> patch;
    pmp::triangulate_hole(mesh, start, std::back_inserter(patch));
    if (patch.empty()) return fmt::format("a hole of {} edges can't be filled", edges);
    ++holes;
  }
  return "";
}

/// Triangles of `mesh` over the vertices of `map`, found again by position (repair moves none);
/// vertices that the repair doubled (pinched ones) are appended.
void takeOver(const CgalMesh& mesh, std::span<const Vec3> p, SurfaceMap& map) {
  std::map<std::array<double, 3>, int> old;
  for (int v = 0; v < int(p.size()); ++v) old.try_emplace({p[v].x(), p[v].y(), p[v].z()}, v);
  std::vector<int> number(mesh.num_vertices(), -1);
  std::vector<std::uint8_t> taken(p.size(), 0);
  for (const auto v : mesh.vertices()) {
    const Point& x = mesh.point(v);
    const int from = old.at({x.x(), x.y(), x.z()});
    number[v] = from;
    if (taken[from]++ == 0) continue;
    number[v] = int(map.corner.size());
    map.corner.push_back(map.corner[from]);
    map.mirrored.push_back(map.mirrored[from]);
    map.onPlane.push_back(map.onPlane[from]);
  }
  map.triangles.clear();
  for (const auto f : mesh.faces()) {
    Triangle t{};
    int k = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f))) t[k++] = number[v];
    map.triangles.push_back(t);
  }
}

/// How many pairs of triangles cross each other: told, not mended.
std::size_t crossings(const SurfaceMap& map, std::span<const Vec3> p) {
  CgalMesh mesh;
  for (const Vec3& x : p) mesh.add_vertex(Point(x.x(), x.y(), x.z()));
  using Vertex = CgalMesh::Vertex_index;
  for (const Triangle& t : map.triangles)
    mesh.add_face(Vertex(unsigned(t[0])), Vertex(unsigned(t[1])), Vertex(unsigned(t[2])));
  std::vector<std::pair<CgalMesh::Face_index, CgalMesh::Face_index>> pairs;
  pmp::self_intersections(mesh, std::back_inserter(pairs));
  return pairs.size();
}

Result<void> repairSurface(SurfaceMap& map, const RawMesh& rest, bool isSequence,
                           const std::string& name, std::vector<std::string>& report) {
  const std::vector<Vec3> p = map.apply(rest.corners);
  std::set<std::array<double, 3>> places;
  for (const Vec3& x : p) places.insert({x.x(), x.y(), x.z()});
  if (isSequence && places.size() != p.size())
    return usageError(rest.file,
                      fmt::format("{}: a sequence with sheets that touch on frame 0 "
                                  "can't be repaired",
                                  name),
                      "Close it in the modelling program, or say \"closure\": \"draw_only\".");
  std::set<Triangle> seen;
  std::vector<std::array<std::size_t, 3>> polygons;
  for (const Triangle& t : map.triangles) {
    Triangle key = t;
    std::sort(key.begin(), key.end());
    if (seen.insert(key).second)
      polygons.push_back({std::size_t(t[0]), std::size_t(t[1]), std::size_t(t[2])});
  }
  const std::size_t doubles = map.triangles.size() - polygons.size();
  std::vector<Point> points;
  for (const Vec3& x : p) points.emplace_back(x.x(), x.y(), x.z());
  pmp::orient_polygon_soup(points, polygons);
  CgalMesh mesh;
  pmp::polygon_soup_to_polygon_mesh(points, polygons, mesh);
  const auto stitched = pmp::stitch_borders(mesh);
  int holes = 0, largest = 0;
  const std::size_t before = mesh.number_of_faces();
  const std::string obstacle = fillHoles(mesh, holes, largest);
  const std::size_t filled = mesh.number_of_faces() - before;
  mesh.collect_garbage();
  if (obstacle.empty() && !pmp::does_self_intersect(mesh)) pmp::orient_to_bound_a_volume(mesh);
  takeOver(mesh, p, map);
  compact(map);
  report.push_back(
      fmt::format("{}: repaired: {} duplicate triangles removed, {} edges stitched, {} "
                  "holes filled with {} triangles (largest {} edges), no vertex moved",
                  name, doubles, stitched, holes, filled, largest));
  const std::vector<Vec3> q = map.apply(rest.corners);
  if (obstacle.empty() && checkManifold(map.triangles, int(q.size())).closed()) return {};
  return usageError(rest.file,
                    fmt::format("{} can't be closed: {}; {}", name,
                                obstacle.empty() ? "it stays no 2-manifold" : obstacle,
                                badEdges(map.triangles, q)),
                    "Close it in a modelling program, or say \"closure\": \"draw_only\".");
}
}  // namespace

Result<void> closeSurface(SurfaceMap& map, const RawMesh& rest, SurfaceClosure closure,
                          bool isSequence, const std::string& name,
                          std::vector<std::string>& report) {
  const auto closed = [&] { return checkManifold(map.triangles, int(map.corner.size())).closed(); };
  if (!closed()) {
    const std::vector<Vec3> p = map.apply(rest.corners);
    if (closure == SurfaceClosure::requireClosed)
      return usageError(
          rest.file, fmt::format("{} must be closed, but has {}", name, badEdges(map.triangles, p)),
          "Close it, or say \"closure\": \"repair\" or \"draw_only\".");
    if (closure == SurfaceClosure::drawOnly) {
      report.push_back(fmt::format("{}: draw only: {}", name, badEdges(map.triangles, p)));
      return {};
    }
    if (auto done = repairSurface(map, rest, isSequence, name, report); !done) return done;
  }
  const std::vector<Vec3> p = map.apply(rest.corners);
  if (const std::size_t pairs = closure == SurfaceClosure::drawOnly ? 0 : crossings(map, p);
      pairs > 0)
    report.push_back(
        fmt::format("{}: crosses itself at {} pairs of triangles; left so", name, pairs));
  if (volume(p, map.triangles) < 0) {
    for (Triangle& t : map.triangles) std::swap(t[1], t[2]);
    report.push_back(fmt::format("{}: faced inward; turned outward", name));
  }
  return {};
}
}  // namespace swallowclip::anatomy
