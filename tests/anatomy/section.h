// SPDX-License-Identifier: MIT
// Sagittal sections of meshes, and how far a point is from one.
#pragma once
#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "core/tri_mesh.h"
#include "core/vec.h"

namespace swallowclip::test {
using Segment = std::pair<Vec2, Vec2>;  ///< (y, z) in mm
inline std::vector<Segment> section(const TriMesh& mesh, double x_m) {
  std::vector<Segment> out;
  for (const Triangle& t : mesh.triangles) {
    std::vector<Vec2> cut;
    for (int k = 0; k < 3; ++k) {
      const Vec3 &a = mesh.positions[t[k]], &b = mesh.positions[t[(k + 1) % 3]];
      const double da = a.x() - x_m, db = b.x() - x_m;
      if (da * db >= 0) continue;
      const Vec3 p = (a + da / (da - db) * (b - a)) * 1e3;
      cut.push_back({p.y(), p.z()});
    }
    if (cut.size() == 2) out.push_back({cut[0], cut[1]});
  }
  return out;
}

inline double distance_mm(const Vec2& p, const std::vector<Segment>& segments) {
  double best = std::numeric_limits<double>::max();
  for (const auto& [a, b] : segments) {
    const Vec2 d = b - a;
    const double f = std::clamp((p - a).dot(d) / std::max(d.squaredNorm(), 1e-12), 0.0, 1.0);
    best = std::min(best, (p - a - f * d).norm());
  }
  return best;
}
}  // namespace swallowclip::test
