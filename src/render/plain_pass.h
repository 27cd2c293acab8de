// SPDX-License-Identifier: MIT
// One light on all triangles of a list, no cuts, no smoothing: the yardstick for what a frame
// costs.
#pragma once
#include <filesystem>

#include "render/gpu_mesh.h"

namespace swallowclip::render {

class PlainPass {
 public:
  Result<void> create(const std::filesystem::path& shaderDir, const RenderPreset& preset);
  Result<Image> draw(const GpuMesh& mesh, const DrawList& list, const Camera& camera);

 private:
  Program program_;
  Target picture_;
};
}  // namespace swallowclip::render
