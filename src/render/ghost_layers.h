// SPDX-License-Identifier: MIT
// Transparency that does not depend on the order of drawing: each ghosted structure is drawn alone,
// its nearest surface, and the layers of a pixel are sorted by depth.
#pragma once
#include <vector>

#include "render/gl.h"
#include "render/gpu_mesh.h"

namespace swallowclip::render {

class GhostLayers {
 public:
  static constexpr std::size_t kMost = 8;  ///< two texture units each; GL promises 16 (sec. 11.1)

  Result<void> create(const std::filesystem::path& shaderDir, int width, int height);
  /// Makes layer k the target: empty, and behind what `solids` holds nothing will be seen.
  Result<void> begin(std::size_t k, const Target& solids);
  /// Blends the first `count` layers over `solids`; its alpha and depth stay.
  void resolve(std::size_t count, const Target& solids, const GpuMesh& mesh);

 private:
  Program program_;
  int width_ = 0, height_ = 0;
  std::vector<Target> layers_;  ///< made when first needed
};
}  // namespace swallowclip::render
