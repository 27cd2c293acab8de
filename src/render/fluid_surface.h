// SPDX-License-Identifier: MIT
// The bolus as one smooth closed surface: a particle's blob is an ellipsoid stretched along its
// neighbours (after the idea of Yu & Turk 2013), film particles are flat discs on their wall; the
// level set of the summed blobs is meshed by surface nets on a grid fixed in space.
#pragma once
#include <span>
#include <vector>

#include "core/tri_mesh.h"

namespace swallowclip::render {

struct FluidParticle {
  Vec3f position;
  Vec3f wallNormal = Vec3f::Zero();  ///< unit for a film particle, zero for a free one
};

struct FluidSurface {
  std::vector<Vec3f> positions, normals;  ///< metres; unit, outward
  std::vector<Triangle> triangles;        ///< closed: an even number of triangles at every edge
};

struct FluidSurfaceDef {
  double spacing_m = 2e-3;  ///< particle spacing dx
  double cell = 0.5;        ///< grid cell in dx; assumed 0.4..0.6
  double smoothing =
      0.4;              ///< pull of a centre to its neighbours' mean; Yu & Turk 0.9, which shrinks
  double level = 0.42;  ///< of the summed field; a 5 mL ball keeps its volume (tested)
  double filmThickness = 0.25;  ///< half thickness of a film disc in dx; assumed 0.2..0.5
};

/// Empty surface for no particles. Deterministic: particles are summed in their order.
FluidSurface fluidSurface(std::span<const FluidParticle> particles, const FluidSurfaceDef& def);

/// Skin of the lumen at one moment: vertices and unit normals out of the lumen.
struct LumenWall {
  std::vector<Vec3f> positions, normals;
};

/// Brings vertices that a blob's breadth has carried through a wall back to it: the particles are
/// inside, so must be what is drawn. `reach_m`: how far outside a vertex may be.
void keepWithin(FluidSurface& surface, const LumenWall& wall, double reach_m);
}  // namespace swallowclip::render
