// SPDX-License-Identifier: MIT
// Skin of a plain adult head and neck as one closed surface. Fluoroscopy needs the soft tissue
// around what the scene models: how long a ray runs through it, and where the air outside begins.
#pragma once
#include <vector>

#include "core/tri_mesh.h"

namespace swallowclip::render {

struct ClosedSurface {
  std::vector<Vec3f> positions;  ///< metres, scene frame
  std::vector<Triangle> triangles;
};

ClosedSurface bodyOutline();
}  // namespace swallowclip::render
