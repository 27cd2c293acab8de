// SPDX-License-Identifier: MIT
// Closing surfaces, by CGAL (its mesh processing is GPL).
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
#include <set>
#include <unordered_map>

#include "anatomy/mesh_repair.h"

namespace swallowclip::anatomy {
namespace {
namespace pmp = CGAL::Polygon_mesh_processing;

/// Hole filling costs the cube of the edge count; beyond this it is no hole but an open surface.
constexpr int kMaxHoleEdges = 1500;
constexpr int kEdgesNamed = 4;  ///< in messages

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
