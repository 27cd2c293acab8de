// SPDX-License-Identifier: MIT
// Small charts of lines and markers. One drawing, written as SVG and as PNG; same input, same
// bytes. Colours are told apart by colour-blind eyes (Okabe & Ito 2008).
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"

namespace swallowclip::plot {

struct Series {
  std::string label;                              ///< in the legend; "" stays out of it
  std::vector<std::pair<double, double>> points;  ///< points that are not finite break a line
  bool markers = false;                           ///< markers instead of a line
  int colour = -1;                                ///< index of the palette; -1: by position
};

struct Chart {
  std::string title;
  std::string xLabel, yLabel;  ///< with units, e.g. "height (mm)"
  std::vector<Series> series;
  int width_px = 800, height_px = 560;
};

Result<void> writeSvg(const Chart& chart, const std::filesystem::path& file);
Result<void> writePng(const Chart& chart, const std::filesystem::path& file);
}  // namespace swallowclip::plot
