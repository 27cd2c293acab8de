// SPDX-License-Identifier: MIT
#include "airway/interpenetration.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "airway/surface_search.h"

namespace swallowclip::airway {
namespace {

// Step off the surface before asking for the winding number: far above rounding, and far below
// the smallest gap that motions close to (0.02 mm).
constexpr double kStep_m = 1e-6;

struct Finding {
  double depth_m = -1;
  int triangle = -1;
};

// The deepest one; the first of equals, so that threads do not matter.
Interpenetration deepest(const std::vector<Finding>& findings) {
  Interpenetration out;
  for (size_t v = 0; v < findings.size(); ++v) {
    if (findings[v].depth_m < 0) continue;
    ++out.vertices;
    if (out.vertex >= 0 && findings[v].depth_m <= out.depth_m) continue;
    out.depth_m = findings[v].depth_m;
    out.vertex = static_cast<int>(v);
    out.triangle = findings[v].triangle;
  }
  return out;
}
}  // namespace

Interpenetration maxInterpenetration(std::span<const Vec3> p, std::span<const Triangle> triangles,
                                     ThreadPool& pool) {
  const SurfaceSearch skin(p, triangles);
  const std::vector<Vec3> normals = vertexNormals(p, triangles);
  std::vector<Finding> findings(p.size());
  pool.forChunks(static_cast<int>(p.size()), 256, [&](int begin, int end, int) {
    for (int v = begin; v < end; ++v) {
      if (std::abs(skin.winding(p[v] - kStep_m * normals[v]) - 1) < 0.5) continue;
      const SurfacePoint across = skin.nearestOpposed(p[v], normals[v]);
      // nearer than the step: touching, not crossing
      if (across.triangle >= 0 && across.distance_m > 2 * kStep_m)
        findings[v] = {across.distance_m, across.triangle};
    }
  });
  return deepest(findings);
}

Interpenetration depthInside(const TriMesh& a, const TriMesh& b, ThreadPool& pool) {
  const SurfaceSearch other(b.positions, b.triangles);
  std::vector<Finding> findings(a.positions.size());
  pool.forChunks(static_cast<int>(a.positions.size()), 256, [&](int begin, int end, int) {
    for (int v = begin; v < end; ++v) {
      if (other.winding(a.positions[v]) < 0.5) continue;
      const SurfacePoint at = other.nearest(a.positions[v]);
      findings[v] = {at.distance_m, at.triangle};
    }
  });
  return deepest(findings);
}
}  // namespace swallowclip::airway
