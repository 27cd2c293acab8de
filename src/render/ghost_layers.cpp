// SPDX-License-Identifier: MIT
#include "render/ghost_layers.h"

namespace swallowclip::render {

Result<void> GhostLayers::create(const std::filesystem::path& dir, int width, int height) {
  width_ = width;
  height_ = height;
  layers_.reserve(kMost);
  auto loaded = Program::load(dir, "screen.vert", "ghosts.frag");
  if (!loaded) return std::unexpected(loaded.error());
  program_ = std::move(*loaded);
  return {};
}

Result<void> GhostLayers::begin(std::size_t k, const Target& solids) {
  while (layers_.size() <= k) {
    layers_.emplace_back();
    if (auto ok = layers_.back().create("ghosts", width_, height_, GL_RGBA8, GL_DEPTH24_STENCIL8);
        !ok)
      return ok;
  }
  layers_[k].bind();
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
  layers_[k].copyDepth(solids);
  return {};
}

void GhostLayers::resolve(std::size_t count, const Target& solids, const GpuMesh& mesh) {
  solids.bind();
  program_.use();
  program_.set("uCount", static_cast<int>(count));
  for (std::size_t k = 0; k < count; ++k) {
    layers_[k].colour().bind(static_cast<int>(k));
    layers_[k].depth().bind(static_cast<int>(kMost + k));
  }
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
  mesh.drawScreen();
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
}
}  // namespace swallowclip::render
