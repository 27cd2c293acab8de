// SPDX-License-Identifier: MIT
// One frame of a history turned into triangles for one view: which structures are drawn, how they
// are cut, with which material, in which order. No GL here.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "frame/history.h"
#include "render/camera.h"
#include "render/draw_mesh.h"
#include "render/render_preset.h"

namespace swallowclip::render {

struct CutPlane {
  Vec3f normal;      ///< unit; points where normal . p > offset are gone
  float offset = 0;  ///< metres
  bool cap = true;
};

/// A part of DrawList::indices (relative to firstVertex).
struct Range {
  int firstIndex = 0, count = 0, firstVertex = 0;
};

struct DrawItem {
  std::string name;
  std::string substance;               ///< material name as in the scene
  const Material* material = nullptr;  ///< lives in the preset
  float opacity = 1;
  bool closed = false;  ///< its back faces never show, but for uncapped cuts
  Range mesh;
  std::vector<CutPlane> cuts;         ///< at most 3, those that touch the mesh
  std::vector<Range> fans, outlines;  ///< [cut] section to fill and its border; may be empty
  std::vector<Bounds> fanBounds;      ///< [cut]
  Bounds bounds;
};

struct DrawList {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<DrawItem> solid;  ///< in order of section priority, the bolus last
  std::vector<DrawItem> ghost;  ///< back to front as on the first frame, so that order never flips
  std::vector<DrawItem> air, body;  ///< fluoroscopy: the lumen, and the skin of head and neck
  double barium_kgm3 = 0;           ///< barium sulfate in the bolus
  float referenceDepth = 2.5f;      ///< optical depth that the exposure is set for
  Bounds bounds;                    ///< everything in view at this frame
  Bounds restBounds;  ///< the same at the first frame, with room to move: fixes shadows
};

/// Draw meshes of a history, made once.
struct Prepared {
  std::uint64_t digest = 0;      ///< of topology and first frame
  std::vector<DrawMesh> meshes;  ///< [structure]
};
std::uint64_t topologyDigest(const frame::History& history);
Prepared prepare(const frame::History& history, double creaseAngle_rad);

/// Vertex positions of a structure at a frame.
std::vector<Vec3f> positionsAt(const frame::StructureTrack& track, int frame);

/// Indices of the items by the depth of their nearest corner; `back` points to the viewer.
std::vector<int> nearestFirst(const std::vector<DrawItem>& items, const Vec3f& back);

DrawList buildDrawList(const frame::History& history, int frame, const Prepared& prepared,
                       const RenderPreset& preset, const ViewDef& view);
}  // namespace swallowclip::render
