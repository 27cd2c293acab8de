// SPDX-License-Identifier: MIT
// Closed surfaces of boxes, cylinders and tubes, triangles facing out.
#pragma once
#include "core/tri_mesh.h"

namespace swallowclip::verify {

TriMesh boxMesh(const Vec3& low, const Vec3& high, double edge_m);
/// Round prism around `axis` (0 to 2) from `from` to `to` along it; its polygon has the area of the
/// circle, so that volumes are exact.
TriMesh roundMesh(int axis, double radius_m, double from_m, double to_m, double edge_m);
}  // namespace swallowclip::verify
