// SPDX-License-Identifier: MIT
// Flat drawing on pictures: a picture laid into a pane, lines and areas with smooth edges. Pixel
// coordinates: x right, y down, (0, 0) the upper left corner of the upper left pixel.
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "core/image.h"
#include "core/vec.h"
#include "study/protect.h"

namespace swallowclip::overlay {

using study::Rectangle;

/// Share of every pixel of a pane that something covers, 0 to 1.
class Coverage {
 public:
  explicit Coverage(const Rectangle& pane)
      : pane_(pane), share_(static_cast<std::size_t>(pane.width) * pane.height, 0.0f) {}

  /// Line segments (pairs of points), `width_px` wide with round ends.
  void stroke(std::span<const Vec2> segments, double width_px);
  void disc(const Vec2& centre, double radius_px);
  /// The inside of closed curves given as segments in any order (even-odd).
  void fill(std::span<const Vec2> segments);
  void blendOnto(Image& image, const Vec3f& colour_srgb, float opacity) const;

 private:
  float& at(int x, int y) {
    return share_[static_cast<std::size_t>(y - pane_.y) * pane_.width + (x - pane_.x)];
  }
  Rectangle pane_;
  std::vector<float> share_;
};

/// Every pixel of the pane takes the mean of `from` over its area; `source` turns a pixel of the
/// picture (its centre) into a point of `from`, `step` is the size of a pixel there. Points outside
/// `from` are black.
void lay(Image& onto, const Rectangle& pane, const Image& from,
         const std::function<Vec2(const Vec2&)>& source, double step);

void paste(Image& onto, const Image& from, int x, int y);
}  // namespace swallowclip::overlay
