// SPDX-License-Identifier: MIT
// One frame of a history as vertices, for every view of it: made and uploaded once. No GL here.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "frame/history.h"
#include "render/camera.h"
#include "render/draw_mesh.h"
#include "render/fluid_surface.h"
#include "render/render_preset.h"

namespace swallowclip::render {

/// Draw meshes of a history, made once.
struct Prepared {
  std::uint64_t digest = 0;      ///< of topology and first frame
  std::vector<DrawMesh> meshes;  ///< [structure]
};
std::uint64_t topologyDigest(const frame::History& history);
/// Nothing farther than `error_m` from the meshes of the history; 0: themselves.
Prepared prepare(const frame::History& history, double creaseAngle_rad, float error_m);
/// Smaller than what a picture of this height shows.
float unseenDetail_m(int height_px);

/// A structure, or the bolus, at the frame.
struct Part {
  std::string name;
  std::string substance;                   ///< material name as in the scene
  const Material* material = nullptr;      ///< lives in the preset
  bool closed = false;                     ///< closed 2-manifold facing outward
  int firstVertex = 0;                     ///< in FrameGeometry::vertices
  std::span<const std::uint32_t> indices;  ///< 3 per triangle, from firstVertex on
  std::span<const Triangle> triangles;     ///< of `positions`
  std::vector<Vec3f> positions;
  Bounds bounds, restBounds;  ///< at this frame; at the first
};

struct FrameGeometry {
  std::vector<Vertex> vertices;
  std::vector<Part> parts;  ///< as in the history; the bolus last, where there is any

  FrameGeometry() = default;
  FrameGeometry(FrameGeometry&&) = default;  // parts point into what it owns
  FrameGeometry& operator=(FrameGeometry&&) = default;

 private:
  FluidSurface bolus_;
  std::vector<std::uint32_t> bolusIndices_;
  friend void addBolus(FrameGeometry&, const frame::History&, int, const RenderPreset&);
};

/// `prepared` must outlive what is returned.
FrameGeometry frameGeometry(const frame::History& history, int frame, const Prepared& prepared,
                            const RenderPreset& preset);
/// Of all that a frame's geometry is made from, beyond the topology.
std::uint64_t frameDigest(const frame::History& history, int frame);

/// Vertex positions of a structure at a frame.
std::vector<Vec3f> positionsAt(const frame::StructureTrack& track, int frame);
}  // namespace swallowclip::render
