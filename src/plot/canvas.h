// SPDX-License-Identifier: MIT
// A page to draw on, written as SVG or PNG. Same drawing, same bytes. Colours are told apart by
// colour-blind eyes (Okabe & Ito 2008). Pixels, y downwards.
#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "core/error.h"

struct _cairo;

namespace swallowclip::plot {

class Pen {
 public:
  explicit Pen(_cairo* cairo) : cairo_(cairo) {}

  void colour(int index, double alpha = 1) const;
  void grey(double value, double alpha = 1) const;
  /// Text with its anchor (0 to 1 across and down its own box) at x, y; returns its width.
  double text(const std::string& words, double x, double y, double size, double across, double down,
              bool upright = true, bool bold = false) const;
  double textWidth(const std::string& words, double size, bool bold = false) const;
  void line(double x0, double y0, double x1, double y1, double width) const;
  /// Filled; round > 0 rounds its corners.
  void box(double x, double y, double width, double height, double round = 0) const;
  /// A hollow circle (even shapes) or square.
  void marker(double x, double y, double radius, int shape) const;
  /// A polyline point by point: the first call of a stretch begins it.
  void moveTo(double x, double y) const;
  void lineTo(double x, double y) const;
  void stroke(double width) const;
  void clip(double x, double y, double width, double height) const;
  void unclip() const;

 private:
  _cairo* cairo_;
};

using Drawing = std::function<void(const Pen&)>;
Result<void> writeSvg(const Drawing& drawing, int width_px, int height_px,
                      const std::filesystem::path& file);
Result<void> writePng(const Drawing& drawing, int width_px, int height_px,
                      const std::filesystem::path& file);
}  // namespace swallowclip::plot
