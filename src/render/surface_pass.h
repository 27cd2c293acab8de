// SPDX-License-Identifier: MIT
// The illustrated views: shadow map, solids with capped sections, ghosts, ambient occlusion, smooth
// edges. What is drawn is kept apart by structure in the picture's alpha until the end. See the
// header comments in shaders/ for every uniform.
#pragma once
#include <array>
#include <filesystem>
#include <map>

#include "render/draw_list.h"
#include "render/ghost_layers.h"
#include "render/gpu_mesh.h"

namespace swallowclip::render {

class SurfacePass {
 public:
  Result<void> create(const std::filesystem::path& shaderDir, const RenderPreset& preset);
  /// `mesh` holds the list.
  Result<Image> draw(const GpuMesh& mesh, const DrawList& list, const Camera& camera,
                     const RenderPreset& preset);
  /// Pixels in which each item of the list is the nearest, by name; ghosts cover nothing, nor does
  /// the bolus: what it passes before is still in the view. Without smoothing of edges.
  Result<std::map<std::string, int>> visiblePixels(const GpuMesh& mesh, DrawList list,
                                                   const Camera& camera,
                                                   const RenderPreset& preset);

 private:
  Result<void> begin(const GpuMesh& mesh, const DrawList& list, bool onlyIds);
  void drawShadowMap(const DrawList& list, const Camera& camera, const RenderPreset& preset);
  void setView(const Camera& camera, const RenderPreset& preset);
  Program& surfaceOf(const DrawItem& item, float id, float opacity);
  void drawSolids(const DrawList& list, const Camera& camera, const RenderPreset& preset);
  void drawCaps(const DrawItem& item, const Camera& camera, float id);
  void drawOutlines(const DrawItem& item, const Camera& camera, const RenderPreset& preset,
                    float alpha);
  void drawGhost(const DrawItem& item, const Camera& camera, const RenderPreset& preset);
  Result<void> drawGhosts(const DrawList& list, const Camera& camera, const RenderPreset& preset);
  void drawOcclusion(const Camera& camera, const RenderPreset& preset);
  void setSpiral(int taps);
  void composite(const Camera& camera, const RenderPreset& preset);
  void finish(Image& image, bool smooth) const;
  void countIds(const std::vector<DrawItem>& items, std::size_t first, const RenderPreset& preset,
                std::map<std::string, int>& counts);

  Program smooth_, detailed_, section_, flat_, depthOnly_, ao_, blur_, composite_;
  Target scene_, shadow_, aoRaw_, aoSmooth_, picture_;
  GhostLayers ghosts_;
  Image background_;
  std::array<std::uint8_t, 256> encoding_{};
  const GpuMesh* mesh_ = nullptr;  ///< what is being drawn
  bool onlyIds_ = false;           ///< structures told apart by alpha, without light
  Mat4f shadowFromWorld_ = Mat4f::Identity();
  float shadowRadius_m_ = 1;
};
}  // namespace swallowclip::render
