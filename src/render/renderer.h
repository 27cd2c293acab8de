// SPDX-License-Identifier: MIT
// Pictures of a finished swallow: history + frame + view -> 8-bit sRGB image with captions.
// The same inputs give the same bytes on the same machine and packages. A Renderer owns one GL
// context and belongs to one thread; several may exist.
#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/image.h"
#include "frame/history.h"
#include "render/captions.h"
#include "render/float_image.h"
#include "render/render_preset.h"

namespace swallowclip::render {

/// A structure of which a view shows less than it promises.
struct Loss {
  std::string structure;
  int pixels = 0, expected = 0;
};

class Renderer {
 public:
  /// `shaderDir` is the repository's shaders/ folder.
  static Result<Renderer> create(const std::filesystem::path& shaderDir, RenderPreset preset);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// `view` is a key of preset.views; an unknown one is a usage error with the nearest name.
  Result<Image> draw(const frame::History& history, int frame, const std::string& view,
                     const CaptionText& caption);

  /// The same triangles in one light, without cuts, shadows and words: what a frame costs at least.
  Result<Image> drawPlain(const frame::History& history, int frame, const std::string& view);
  /// What the detector of a fluoroscopy view receives, relative to the open field, for measuring.
  Result<FloatImage> signal(const frame::History& history, int frame, const std::string& view);

  /// Pixels in which each structure of a view is seen at a frame (without captions); in
  /// fluoroscopy only of those that the view promises.
  Result<std::map<std::string, int>> visiblePixels(const frame::History& history, int frame,
                                                   const std::string& view);
  /// What a view promises (ViewDef::shows) and does not keep at a frame.
  Result<std::vector<Loss>> lost(const frame::History& history, int frame, const std::string& view);

  int trianglesDrawn() const;  ///< of meshes and sections, when last asked for a picture
  const RenderPreset& preset() const;
  std::string description() const;  ///< driver and version

 private:
  struct Impl;
  struct Scene;
  Result<Scene> prepareScene(const frame::History& history, int frame, const std::string& view);
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};
}  // namespace swallowclip::render
