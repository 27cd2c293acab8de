// SPDX-License-Identifier: MIT
// What one view shows of a frame: which parts are drawn, how they are cut, in which order. No GL
// here.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "render/frame_geometry.h"

namespace swallowclip::render {

struct CutPlane {
  Vec3f normal;      ///< unit; points where normal . p > offset are gone
  float offset = 0;  ///< metres
  bool cap = true;
};

/// A part of DrawList::indices (relative to firstVertex of the frame's vertices).
struct Range {
  int firstIndex = 0, count = 0, firstVertex = 0;
};
/// A part of DrawList::extra, 3 vertices per triangle.
struct Soup {
  int first = 0, count = 0;
};

/// Where a cut goes through a part.
struct Section {
  Soup fan;      ///< winds once round every point of it; empty = nothing to fill
  Soup cover;    ///< holds it
  Soup outline;  ///< its border
};

struct DrawItem {
  std::string name;
  std::string substance;               ///< material name as in the scene
  const Material* material = nullptr;  ///< lives in the preset
  float opacity = 1;
  bool closed = false;  ///< its back faces never show, but for uncapped cuts
  Range mesh;
  Soup skin;                      ///< instead of `mesh`: what only fluoroscopy sees
  std::vector<CutPlane> cuts;     ///< at most 3, those that touch the mesh
  std::vector<Section> sections;  ///< [cut]
  Bounds bounds;
};

struct DrawList {
  std::vector<std::uint32_t> indices;
  std::vector<Vertex> extra;    ///< sections, and skins for fluoroscopy
  std::vector<DrawItem> solid;  ///< in order of section priority, the bolus last
  std::vector<DrawItem> ghost;
  std::vector<DrawItem> air, body;  ///< fluoroscopy: the lumen, and the skin of head and neck
  double barium_kgm3 = 0;           ///< barium sulfate in the bolus
  float referenceDepth = 2.5f;      ///< optical depth that the exposure is set for
  Bounds bounds;                    ///< everything in view at this frame
  Bounds restBounds;  ///< the same at the first frame, with room to move: fixes shadows
};

/// Indices of the items by the depth of their nearest corner; `back` points to the viewer.
std::vector<int> nearestFirst(const std::vector<DrawItem>& items, const Vec3f& back);

DrawList buildDrawList(const frame::History& history, int frame, const FrameGeometry& geometry,
                       const RenderPreset& preset, const ViewDef& view);
}  // namespace swallowclip::render
