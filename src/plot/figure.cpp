// SPDX-License-Identifier: MIT
#include "plot/figure.h"

#include <algorithm>
#include <cmath>

#include "plot/axis.h"
#include "plot/canvas.h"

namespace swallowclip::plot {
namespace {
// Pixels.
constexpr double kLeft = 176, kRight = 28, kHead = 74, kFoot = 34, kGap = 44, kAxis = 40;
constexpr double kTitle = 20, kSub = 13, kPanelTitle = 13, kLabel = 12, kTick = 11, kSmall = 10;
constexpr double kMarkNames = 14, kMarkRows = 3, kPlainHead = 24;

struct Scale {
  double low, high, from, to;
  double operator()(double v) const { return from + (v - low) / (high - low) * (to - from); }
};

bool isAmounts(const Panel& p) {
  return !p.amounts.empty();
}

std::pair<double, double> span(const Figure& f) {
  double low = INFINITY, high = -INFINITY;
  const auto take = [&](double v) {
    if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  };
  for (const Panel& p : f.panels) {
    for (const Series& s : p.series)
      for (const auto& q : s.points) take(q.first);
    for (const Band& b : p.bands) take(b.from), take(b.to);
  }
  if (!(low < high)) low = 0, high = 1;
  return {low, high};
}

/// Panel title left, the legend of its lines after it.
void drawHeading(const Pen& pen, const Panel& p, double top) {
  double width = pen.textWidth(p.title, kPanelTitle, true) + 8;
  for (const Series& s : p.series)
    if (!s.label.empty()) width += 46 + pen.textWidth(s.label, kLabel);
  pen.grey(1);  // over the marks
  pen.box(kLeft - 2, top - 24, width, 20);
  pen.grey(0.1);
  double x = kLeft + pen.text(p.title, kLeft, top - 7, kPanelTitle, 0, 1, true, true) + 22;
  for (std::size_t k = 0; k < p.series.size(); ++k) {
    if (p.series[k].label.empty()) continue;
    pen.colour(p.series[k].colour < 0 ? static_cast<int>(k) : p.series[k].colour);
    pen.line(x, top - 14, x + 22, top - 14, 2.2);
    pen.grey(0.2);
    x += 28 + pen.text(p.series[k].label, x + 28, top - 7, kLabel, 0, 1) + 18;
  }
}

void drawGrid(const Pen& pen, const Ticks& ticks, const Scale& x, double top, double bottom) {
  for (double v : ticks.values) {
    if (v < x.low - 1e-9 || v > x.high + 1e-9) continue;
    pen.grey(0.91);
    pen.line(x(v), top, x(v), bottom, 1);
  }
}

void drawLines(const Pen& pen, const Panel& p, const Scale& x, double top, double bottom) {
  double low = INFINITY, high = -INFINITY;
  for (const Series& s : p.series)
    for (const auto& q : s.points)
      if (std::isfinite(q.second)) low = std::min(low, q.second), high = std::max(high, q.second);
  for (const Level& l : p.levels) low = std::min(low, l.value), high = std::max(high, l.value);
  constexpr double kNothing = 0.02;                         // share of the range
  if (low > -kNothing * high && low < 0.4 * high) low = 0;  // amounts start at nothing
  const Ticks ticks = niceTicks(low, high, 4);
  const Scale y{ticks.low, ticks.high, bottom, top};
  for (double v : ticks.values) {
    pen.grey(0.91);
    pen.line(x.from, y(v), x.to, y(v), 1);
    pen.grey(0.25);
    pen.text(tickText(v, ticks.values[1] - ticks.values[0]), x.from - 7, y(v), kTick, 1, 0.5);
  }
  for (const Level& l : p.levels) {
    pen.grey(0.45);
    pen.line(x.from, y(l.value), x.to, y(l.value), 1);
    pen.text(l.label, x.to - 4, y(l.value) - 2, kSmall, 1, 1);
  }
  pen.clip(x.from - 6, top - 6, x.to - x.from + 12, bottom - top + 12);
  for (std::size_t k = 0; k < p.series.size(); ++k) {
    const Series& s = p.series[k];
    const int colour = s.colour < 0 ? static_cast<int>(k) : s.colour;
    pen.colour(colour);
    bool open = false;
    for (const auto& q : s.points) {
      const bool finite = std::isfinite(q.first) && std::isfinite(q.second);
      if (finite && open) pen.lineTo(x(q.first), y(q.second));
      if (finite && !open) pen.moveTo(x(q.first), y(q.second));
      open = finite;
    }
    pen.stroke(2);
    if (!p.markers) continue;
    for (const auto& q : s.points)
      if (std::isfinite(q.second)) pen.marker(x(q.first), y(q.second), 4, colour);
  }
  pen.unclip();
  pen.grey(0.25);
  pen.text(p.yLabel, 22, 0.5 * (top + bottom), kLabel, 0.5, 0.5, false);
}

void drawBands(const Pen& pen, const Panel& p, const Scale& x, double top, double bottom) {
  const double row = (bottom - top) / static_cast<double>(p.bands.size());
  for (std::size_t k = 0; k < p.bands.size(); ++k) {
    const Band& b = p.bands[k];
    const double y = top + row * static_cast<double>(k);
    if (k % 2 == 1) {
      pen.grey(0.5, 0.06);
      pen.box(x.from, y, x.to - x.from, row);
    }
    pen.grey(0.15);
    pen.text(b.label, x.from - 8, y + row / 2, kLabel, 1, 0.5);
    pen.colour(b.colour, 0.85);
    const double width = std::max(3.0, x(b.to) - x(b.from));
    pen.box(x(b.from), y + 0.2 * row, width, 0.6 * row, 4);
    const bool inside = pen.textWidth(b.text, kSmall) + 8 < width;
    const bool after = x(b.from) + width + 8 + pen.textWidth(b.text, kSmall) < x.to;
    pen.grey(inside ? 1.0 : 0.25);
    if (inside)
      pen.text(b.text, x(b.from) + width / 2, y + row / 2, kSmall, 0.5, 0.5);
    else
      pen.text(b.text, after ? x(b.from) + width + 5 : x(b.from) - 5, y + row / 2, kSmall,
               after ? 0 : 1, 0.5);
  }
}

void drawAmounts(const Pen& pen, const Panel& p, double left, double right, double top,
                 double bottom) {
  double most = 0;
  for (const Amount& a : p.amounts) most = std::max(most, a.value);
  for (const Level& l : p.levels) most = std::max(most, l.value);
  const Ticks ticks = niceTicks(0, most > 0 ? most : 1, 6);
  const Scale x{0, ticks.high, left, right};
  for (double v : ticks.values) {
    pen.grey(0.91);
    pen.line(x(v), top, x(v), bottom, 1);
    pen.grey(0.25);
    pen.text(tickText(v, ticks.values[1] - ticks.values[0]), x(v), bottom + 4, kTick, 0.5, 0);
  }
  const double row = (bottom - top) / static_cast<double>(p.amounts.size());
  for (std::size_t k = 0; k < p.amounts.size(); ++k) {
    const Amount& a = p.amounts[k];
    const double y = top + row * static_cast<double>(k);
    pen.grey(0.15);
    pen.text(a.label, left - 8, y + row / 2, kLabel, 1, 0.5);
    pen.colour(a.colour, 0.85);
    if (a.value > 0) pen.box(left, y + 0.18 * row, x(a.value) - left, 0.64 * row, 2);
    pen.grey(0.25);
    pen.text(a.text, x(a.value) + 6, y + row / 2, kSmall, 0, 0.5);
  }
  for (const Level& l : p.levels) {
    pen.colour(1);
    pen.line(x(l.value), top - 2, x(l.value), bottom, 1.4);
    pen.grey(0.3);
    pen.text(l.label, x(l.value) + 3, top - 3, kSmall, 0, 1);
  }
  pen.grey(0.25);
  pen.text(p.yLabel, 0.5 * (left + right), bottom + 19, kLabel, 0.5, 0);
}

/// Names of the marks in a few rows, so that neighbours do not cover each other.
void drawMarks(const Pen& pen, const Figure& f, const Scale& x, double top, double bottom) {
  std::vector<double> busyUntil(static_cast<std::size_t>(kMarkRows), -INFINITY);
  for (const auto& [at, name] : f.marks) {
    pen.grey(0.35, 0.55);
    pen.line(x(at), top, x(at), bottom, 0.8);
    const double half = 0.5 * pen.textWidth(name, kSmall) + 3;
    std::size_t row = 0;
    for (std::size_t k = 0; k < busyUntil.size(); ++k)
      if (busyUntil[k] <= x(at) - half) {
        row = k;
        break;
      } else if (busyUntil[k] < busyUntil[row]) {
        row = k;
      }
    busyUntil[row] = x(at) + half;
    pen.grey(0.2);
    pen.text(name, x(at), top - 4 - 13 * static_cast<double>(row), kSmall, 0.5, 1);
  }
}

void draw(const Pen& pen, const Figure& f) {
  const double right = f.width_px - kRight;
  pen.grey(0.05);
  pen.text(f.title, 24, 14, kTitle, 0, 0, true, true);
  pen.grey(0.3);
  pen.text(f.subtitle, 24, 42, kSub, 0, 0);
  const auto [low, high] = span(f);
  const Ticks ticks = niceTicks(low, high, 9);
  const Scale x{low, high, kLeft, right};
  double top = kHead + (f.marks.empty() ? kPlainHead : kMarkNames * kMarkRows);
  double bottom = top - kGap;
  for (const Panel& p : f.panels)
    if (!isAmounts(p)) bottom += p.height_px + kGap;
  drawMarks(pen, f, x, top, bottom);  // under everything else
  for (std::size_t k = 0; k < f.panels.size(); ++k) {
    const Panel& p = f.panels[k];
    if (k > 0) top += kGap;
    const double end = top + p.height_px;
    if (isAmounts(p)) {
      top += kAxis, drawHeading(pen, p, top);
      drawAmounts(pen, p, kLeft, right - 60, top, end + kAxis);
      top = end + kAxis;
      continue;
    }
    if (k > 0 || f.marks.empty()) drawHeading(pen, p, top);
    drawGrid(pen, ticks, x, top, end);
    if (p.bands.empty())
      drawLines(pen, p, x, top, end);
    else
      drawBands(pen, p, x, top, end);
    pen.grey(0.3);
    pen.line(kLeft, end, right, end, 1);
    pen.line(kLeft, top, kLeft, end, 1);
    for (double v : ticks.values)
      if (v >= low - 1e-9 && v <= high + 1e-9)
        pen.text(tickText(v, ticks.values[1] - ticks.values[0]), x(v), end + 3, kTick, 0.5, 0);
    const bool lastOfThese = k + 1 == f.panels.size() || isAmounts(f.panels[k + 1]);
    if (lastOfThese) pen.text(f.xLabel, 0.5 * (kLeft + right), end + 17, kLabel, 0.5, 0);
    top = end;
  }
  pen.grey(0.45);
  pen.text(f.footer, 24, f.height_px() - 10, kSmall, 0, 1);
}
}  // namespace

int Figure::height_px() const {
  double all = kHead + (marks.empty() ? kPlainHead : kMarkNames * kMarkRows) + kFoot + kAxis;
  for (std::size_t k = 0; k < panels.size(); ++k)
    all += panels[k].height_px + (k > 0 ? kGap : 0) + (isAmounts(panels[k]) ? kAxis : 0);
  return static_cast<int>(std::lround(all));
}

Result<void> writeFigure(const Figure& figure, const std::filesystem::path& file) {
  const Drawing drawing = [&figure](const Pen& pen) { draw(pen, figure); };
  if (file.extension() == ".svg")
    return writeSvg(drawing, figure.width_px, figure.height_px(), file);
  if (file.extension() == ".png")
    return writePng(drawing, figure.width_px, figure.height_px(), file);
  return usageError(file.string(), "a picture's name ends in .svg or .png", "Rename it.");
}
}  // namespace swallowclip::plot
