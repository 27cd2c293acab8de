// SPDX-License-Identifier: MIT
// The turning frame of a soft triangle at the point a skin vertex hangs on: third axis along the
// interpolated vertex normal (continuous from triangle to triangle), first axis along one edge.
#pragma once
#include <span>

#include "airway/skinning.h"

namespace swallowclip::airway {

inline Vec3 normalAt(const SoftMaster& m, std::span<const Vec3> normals) {
  Vec3 n = Vec3::Zero();
  for (int k = 0; k < 3; ++k) n += m.barycentric[k] * normals[m.nodes[k]];
  return n.normalized();
}

inline Vec3 tangentAlong(int edge, const SoftMaster& m, std::span<const Vec3> p, const Vec3& n) {
  const Vec3 e = p[m.nodes[(edge + 1) % 3]] - p[m.nodes[edge]];
  return e - e.dot(n) * n;
}

/// The edge that leaves most after the normal is taken out of it.
inline int longestTangent(const SoftMaster& m, std::span<const Vec3> p,
                          std::span<const Vec3> normals) {
  const Vec3 n = normalAt(m, normals);
  int best = 0;
  for (int k = 1; k < 3; ++k)
    if (tangentAlong(k, m, p, n).norm() > tangentAlong(best, m, p, n).norm()) best = k;
  return best;
}

/// False where the triangle has collapsed and gives no frame.
inline bool triangleFrame(const SoftMaster& m, std::span<const Vec3> p,
                          std::span<const Vec3> normals, Mat3& frame) {
  const Vec3 n = normalAt(m, normals), t = tangentAlong(m.edge, m, p, n);
  const double length = t.norm();
  if (!(length > 1e-12) || !(n.squaredNorm() > 0.5)) return false;
  frame.col(0) = t / length;
  frame.col(2) = n;
  frame.col(1) = n.cross(frame.col(0));
  return true;
}
}  // namespace swallowclip::airway
