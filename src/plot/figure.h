// SPDX-License-Identifier: MIT
// A page of panels one below the other over one horizontal axis: lines, rows of bars in time (a
// Gantt chart), and below them, over an axis of their own, bars of amounts.
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "plot/chart.h"

namespace swallowclip::plot {

/// One row of a Gantt panel.
struct Band {
  std::string label;
  double from = 0, to = 0;
  int colour = 0;
  std::string text;  ///< on or after the bar
};

struct Amount {
  std::string label;
  double value = 0;
  std::string text;
  int colour = 0;
};

/// A horizontal line with a word, e.g. a cut.
struct Level {
  double value = 0;
  std::string label;
};

struct Panel {
  std::string title = "", yLabel = "";
  double height_px = 160;
  std::vector<Series> series = {};
  std::vector<Level> levels = {};
  std::vector<Band> bands = {};      ///< Gantt rows instead of lines
  std::vector<Amount> amounts = {};  ///< bars instead of both; not over the common axis
  bool markers = false;              ///< also mark the points of the lines
};

struct Figure {
  std::string title, subtitle, xLabel;
  std::vector<std::pair<double, std::string>> marks;  ///< upright lines through panels, named
  std::vector<Panel> panels;
  std::string footer;
  int width_px = 1100;

  int height_px() const;
};

/// By the ending of the file: .svg or .png; any other is an error.
Result<void> writeFigure(const Figure& figure, const std::filesystem::path& file);
}  // namespace swallowclip::plot
