// SPDX-License-Identifier: MIT
// Simulated videofluoroscopy: every mesh whole and transparent, by Beer-Lambert's law along each
// ray. Overlapping bodies add; the soft tissue around is a uniform slab.
#pragma once
#include <filesystem>

#include "core/image.h"
#include "render/draw_list.h"
#include "render/surface_pass.h"

namespace swallowclip::render {

class FluoroPass {
 public:
  Result<void> create(const std::filesystem::path& shaderDir, const RenderPreset& preset);
  /// `frame` seeds the grain.
  Result<Image> draw(const DrawList& list, const Camera& camera, const RenderPreset& preset,
                     int frame);

  FluoroPass() = default;
  ~FluoroPass();
  FluoroPass(const FluoroPass&) = delete;
  FluoroPass& operator=(const FluoroPass&) = delete;

 private:
  Program length_, display_;
  Target depth_, picture_;
  GpuMesh mesh_;
  GLuint emptyArray_ = 0;
};
}  // namespace swallowclip::render
