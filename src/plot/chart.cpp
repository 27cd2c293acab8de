// SPDX-License-Identifier: MIT
#include "plot/chart.h"

#include <algorithm>
#include <cmath>

#include "plot/axis.h"
#include "plot/canvas.h"

namespace swallowclip::plot {
namespace {
// Sizes in pixels of the picture.
constexpr double kTitle_px = 18, kLabel_px = 14, kTick_px = 12, kMarker_px = 4, kLine_px = 1.8;
constexpr double kLeft_px = 92, kRight_px = 22, kTop_px = 46, kBottom_px = 62;

bool finite(const std::pair<double, double>& p) {
  return std::isfinite(p.first) && std::isfinite(p.second);
}

/// Data to pixels.
struct Frame {
  Ticks x, y;
  double width, height;
  double px(double v) const {
    return kLeft_px + (v - x.low) / (x.high - x.low) * (width - kLeft_px - kRight_px);
  }
  double py(double v) const {
    return height - kBottom_px - (v - y.low) / (y.high - y.low) * (height - kTop_px - kBottom_px);
  }
};

Frame frameOf(const Chart& chart) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (const Series& s : chart.series)
    for (const auto& p : s.points) {
      if (!finite(p)) continue;
      low[0] = std::min(low[0], p.first), high[0] = std::max(high[0], p.first);
      low[1] = std::min(low[1], p.second), high[1] = std::max(high[1], p.second);
    }
  return {niceTicks(low[0], high[0], 7), niceTicks(low[1], high[1], 6),
          static_cast<double>(chart.width_px), static_cast<double>(chart.height_px)};
}

void drawAxes(const Pen& pen, const Frame& f, const Chart& chart) {
  const double left = f.px(f.x.low), right = f.px(f.x.high);
  const double bottom = f.py(f.y.low), top = f.py(f.y.high);
  for (double v : f.x.values) {
    pen.grey(0.88);
    pen.line(f.px(v), bottom, f.px(v), top, 1);
    pen.grey(0.2);
    pen.text(tickText(v, f.x.values[1] - f.x.values[0]), f.px(v), bottom + 5, kTick_px, 0.5, 0);
  }
  for (double v : f.y.values) {
    pen.grey(0.88);
    pen.line(left, f.py(v), right, f.py(v), 1);
    pen.grey(0.2);
    pen.text(tickText(v, f.y.values[1] - f.y.values[0]), left - 6, f.py(v), kTick_px, 1, 0.5);
  }
  pen.grey(0.2);
  pen.line(left, bottom, right, bottom, 1.2);
  pen.line(left, bottom, left, top, 1.2);
  pen.text(chart.title, f.width / 2, 12, kTitle_px, 0.5, 0);
  pen.text(chart.xLabel, (left + right) / 2, f.height - 10, kLabel_px, 0.5, 1);
  pen.text(chart.yLabel, 14, (top + bottom) / 2, kLabel_px, 0.5, 0, false);
}

void drawSeries(const Pen& pen, const Frame& f, const Series& s, int colour) {
  pen.colour(colour);
  if (s.markers) {
    for (const auto& p : s.points)
      if (finite(p)) pen.marker(f.px(p.first), f.py(p.second), kMarker_px, colour);
    return;
  }
  bool open = false;
  for (const auto& p : s.points) {
    if (finite(p) && open) pen.lineTo(f.px(p.first), f.py(p.second));
    if (finite(p) && !open) pen.moveTo(f.px(p.first), f.py(p.second));
    open = finite(p);
  }
  pen.stroke(kLine_px);
}

/// In the corner with the fewest points.
void drawLegend(const Pen& pen, const Frame& f, const Chart& chart) {
  constexpr double kRow_px = 20, kSample_px = 30, kPad_px = 10;
  std::vector<int> rows;
  std::size_t longest = 0;
  for (std::size_t k = 0; k < chart.series.size(); ++k)
    if (!chart.series[k].label.empty()) {
      rows.push_back(static_cast<int>(k));
      longest = std::max(longest, chart.series[k].label.size());
    }
  if (rows.empty()) return;
  const double w = kSample_px + 2 * kPad_px + 0.62 * kTick_px * static_cast<double>(longest);
  const double h = kRow_px * static_cast<double>(rows.size()) + kPad_px;
  double x = 0, y = 0;
  int fewest = -1;
  for (int corner = 0; corner < 4; ++corner) {
    const double cx = corner & 1 ? f.px(f.x.low) + 6 : f.px(f.x.high) - w - 6;
    const double cy = corner & 2 ? f.py(f.y.low) - h - 6 : f.py(f.y.high) + 6;
    int inside = 0;
    for (const Series& s : chart.series)
      for (const auto& p : s.points)
        inside += finite(p) && f.px(p.first) > cx && f.px(p.first) < cx + w &&
                  f.py(p.second) > cy && f.py(p.second) < cy + h;
    if (fewest < 0 || inside < fewest) fewest = inside, x = cx, y = cy;
  }
  pen.grey(1, 0.85);
  pen.box(x, y, w, h);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Series& s = chart.series[rows[k]];
    const int colour = s.colour < 0 ? rows[k] : s.colour;
    const double row = y + kPad_px / 2 + kRow_px * (static_cast<double>(k) + 0.5);
    pen.colour(colour);
    if (s.markers)
      pen.marker(x + kPad_px + kSample_px / 2, row, kMarker_px, colour);
    else
      pen.line(x + kPad_px, row, x + kPad_px + kSample_px, row, kLine_px);
    pen.grey(0.1);
    pen.text(s.label, x + kSample_px + 1.6 * kPad_px, row, kTick_px, 0, 0.5);
  }
}

Drawing drawingOf(const Chart& chart) {
  return [&chart](const Pen& pen) {
    const Frame frame = frameOf(chart);
    drawAxes(pen, frame, chart);
    for (std::size_t k = 0; k < chart.series.size(); ++k) {
      const Series& s = chart.series[k];
      drawSeries(pen, frame, s, s.colour < 0 ? static_cast<int>(k) : s.colour);
    }
    drawLegend(pen, frame, chart);
  };
}
}  // namespace

Result<void> writeSvg(const Chart& chart, const std::filesystem::path& file) {
  return writeSvg(drawingOf(chart), chart.width_px, chart.height_px, file);
}

Result<void> writePng(const Chart& chart, const std::filesystem::path& file) {
  return writePng(drawingOf(chart), chart.width_px, chart.height_px, file);
}
}  // namespace swallowclip::plot
