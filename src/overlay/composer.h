// SPDX-License-Identifier: MIT
// One picture of the clip: the patient's X-ray, the model beside it or on it, and words.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/error.h"
#include "frame/history.h"
#include "overlay/canvas.h"
#include "overlay/registration.h"
#include "render/captions.h"
#include "render/renderer.h"

namespace swallowclip::overlay {

enum class Layout { sideBySide, superimposed, both };
enum class Style { outlines, translucent };

struct ComposeDef {
  Layout layout = Layout::sideBySide;
  Style style = Style::outlines;
  std::vector<std::string> views{"oblique"};  ///< 1 to 4 panes beside the X-ray
};

/// How a structure's midsagittal section is drawn on the X-ray. Colours: Okabe & Ito 2008, told
/// apart by colour-blind eyes.
struct Ink {
  const char* structure;
  const char* word;  ///< of the legend; empty: under the one before
  Vec3f colour_srgb;
};
std::span<const Ink> inks();

/// Even sizes; panes[0] holds the X-ray.
std::vector<Rectangle> panesOf(const ComposeDef& def, int width, int height, double captionSize_px);

class Composer {
 public:
  /// `opening`: the part of the study that is shown. The preset's size is the whole picture's.
  static Result<Composer> make(const ComposeDef& def, const render::RenderPreset& preset,
                               const std::filesystem::path& shaders, const Rectangle& opening);

  /// `study`: protected. Frame `k` of `model` belongs to it.
  Result<Image> draw(const Image& study, const frame::History& model, int k,
                     const Similarity& place, const render::CaptionText& words);
  /// The X-ray's pane alone, with the model on it when the layout says so.
  void drawStudy(Image& onto, const Image& study, const frame::History& model, int k,
                 const Similarity& place) const;
  /// Which colour is what; empty when nothing is drawn on the X-ray.
  std::string legend() const;

 private:
  Vec2 paneFromStudy(const Vec2& at_px) const;
  void drawModel(Image& onto, const frame::History& model, int k, const Similarity& place) const;

  ComposeDef def_;
  render::RenderPreset preset_;  ///< of the whole picture
  std::unique_ptr<render::Renderer> renderer_;
  std::vector<Rectangle> panes_;
  Rectangle opening_;
  double zoom_ = 1;  ///< picture pixels per study pixel
};
}  // namespace swallowclip::overlay
