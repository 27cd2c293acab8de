// SPDX-License-Identifier: MIT
// Simulated videofluoroscopy: Beer-Lambert's law along each ray through whole meshes, then what a
// detector makes of it (scatter, blades, quanta, light spread) and what a screen shows. In front of
// the body is air; the body is soft tissue wherever nothing else is modelled; the lumen is air
// until the bolus fills it. Overlapping bodies add.
#pragma once
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "render/float_image.h"
#include "render/gpu_mesh.h"

namespace swallowclip::render {

class FluoroPass {
 public:
  Result<void> create(const std::filesystem::path& shaderDir, const RenderPreset& preset);
  /// `frame` keys the quantum noise.
  Result<Image> draw(const GpuMesh& mesh, const DrawList& list, const Camera& camera,
                     const RenderPreset& preset, int frame);
  /// The detector's signal relative to the open field, before the screen, for measuring.
  Result<FloatImage> signal(const GpuMesh& mesh, const DrawList& list, const Camera& camera,
                            const RenderPreset& preset, int frame);

  /// Pixels in which each of `names` adds contrast, by itself and within the blades.
  Result<std::map<std::string, int>> visiblePixels(const GpuMesh& mesh, const DrawList& list,
                                                   const Camera& camera, const RenderPreset& preset,
                                                   const std::set<std::string>& names);

 private:
  /// All of the scene, or (when `only` is not empty) one structure.
  Result<void> drawDepth(const DrawList& list, const Camera& camera, const RenderPreset& preset,
                         const std::string& only = "");
  std::vector<float> read(const Target& from) const;
  Result<const Target*> drawSignal(const DrawList& list, const Camera& camera,
                                   const RenderPreset& preset, int frame);
  void blur(const Target& from, const Target& by, const Target& to, float sigma_px);
  void cover(const Target& to);

  Program length_, scatter_, blur_, detector_, display_;
  Target depth_, scatterA_, scatterB_, signalA_, signalB_, picture_;
  const GpuMesh* mesh_ = nullptr;  ///< what is being drawn
};
}  // namespace swallowclip::render
