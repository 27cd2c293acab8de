// SPDX-License-Identifier: MIT
// How far walls pass through each other: zero is the promise of the motion, this is its measure.
#pragma once
#include <cstdint>
#include <span>

#include "core/parallel.h"
#include "core/tri_mesh.h"

namespace swallowclip::airway {

struct Interpenetration {
  double depth_m = 0;
  int vertex = -1;    ///< the deepest one, -1 when nothing crosses
  int triangle = -1;  ///< nearest triangle of the sheet that it has crossed
  int vertices = 0;   ///< how many are across
};

/// Deepest skin vertex that has left the lumen enclosed by the rest of the skin. A step inward
/// from a good vertex has winding number 1; from one that has crossed the opposite sheet it is 0
/// or -1, and 2 where two rooms of the lumen overlap. The depth is the distance to the nearest
/// triangle that faces it. Vertices only: crossings of edges alone, shallower than a triangle, are
/// not seen.
Interpenetration maxInterpenetration(std::span<const Vec3> positions,
                                     std::span<const Triangle> triangles, ThreadPool& pool);

/// Deepest vertex of `a` inside the closed surface `b` (call it both ways for a pair).
Interpenetration depthInside(const TriMesh& a, const TriMesh& b, ThreadPool& pool);
}  // namespace swallowclip::airway
