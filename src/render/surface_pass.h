// SPDX-License-Identifier: MIT
// GL passes of the illustrated views: shadow map, solids with capped sections, ghosts, ambient
// occlusion, composite. See the header comments in shaders/ for every uniform.
#pragma once
#include <filesystem>
#include <map>

#include "render/draw_list.h"
#include "render/gpu_mesh.h"

namespace swallowclip::render {

class SurfacePass {
 public:
  Result<void> create(const std::filesystem::path& shaderDir, const RenderPreset& preset);
  Result<Image> draw(DrawList& list, const Camera& camera, const RenderPreset& preset);
  /// Pixels in which each item of the list is the nearest, by name; ghosts cover nothing but
  /// themselves. Without smoothing of edges.
  Result<std::map<std::string, int>> visiblePixels(DrawList& list, const Camera& camera,
                                                   const RenderPreset& preset);

 private:
  void drawShadowMap(const DrawList& list, const Camera& camera, const RenderPreset& preset);
  void setLights(const Camera& camera, const RenderPreset& preset);
  void setMaterial(const Material& m, bool section, float opacity);
  void drawSolids(const Target& to, const DrawList& list, const Camera& camera,
                  const RenderPreset& preset);
  void begin(DrawList& list);
  void end();
  void countIds(const std::vector<DrawItem>& items, int firstId, const RenderPreset& preset,
                std::map<std::string, int>& counts);
  void drawCaps(const DrawItem& item, const Camera& camera);
  void drawOutlines(const DrawItem& item, const Camera& camera, const RenderPreset& preset);
  void drawGhosts(const DrawList& list, const Camera& camera, const RenderPreset& preset);
  void drawOcclusion(const Camera& camera, const RenderPreset& preset);
  void composite(const Camera& camera, const RenderPreset& preset);
  void setSpiral(int taps);
  Range quadFor(const CutPlane& plane) const;
  void addQuads(DrawList& list);

  Program solid_, depthOnly_, ao_, blur_, composite_;
  Target scene_, resolved_, shadow_, aoRaw_, aoSmooth_, picture_;
  GpuMesh mesh_;
  Mat4f shadowFromWorld_ = Mat4f::Identity();
  float shadowRadius_m_ = 1;
  std::vector<std::pair<CutPlane, Range>> quads_;
  int id_ = 0;  ///< above 0 items are drawn in it, flat, instead of in their material
  GLuint emptyArray_ = 0;

 public:
  SurfacePass() = default;
  ~SurfacePass();
  SurfacePass(const SurfacePass&) = delete;
  SurfacePass& operator=(const SurfacePass&) = delete;
};
}  // namespace swallowclip::render
