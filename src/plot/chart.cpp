// SPDX-License-Identifier: MIT
#include "plot/chart.h"

#include <cairo-svg.h>
#include <pango/pangocairo.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "core/file.h"
#include "plot/axis.h"

namespace swallowclip::plot {
namespace {
struct Deleter {
  void operator()(cairo_surface_t* p) const { cairo_surface_destroy(p); }
  void operator()(cairo_t* p) const { cairo_destroy(p); }
  void operator()(PangoLayout* p) const { g_object_unref(p); }
  void operator()(PangoFontDescription* p) const { pango_font_description_free(p); }
};
template <class T>
using Owned = std::unique_ptr<T, Deleter>;

constexpr const char* kFont = "DejaVu Sans";
// Sizes in pixels of the picture.
constexpr double kTitle_px = 18, kLabel_px = 14, kTick_px = 12, kMarker_px = 4, kLine_px = 1.8;
constexpr double kLeft_px = 92, kRight_px = 22, kTop_px = 46, kBottom_px = 62;
constexpr std::array<std::array<double, 3>, 7> kPalette{{{0.0, 0.447, 0.698},
                                                         {0.835, 0.369, 0.0},
                                                         {0.0, 0.620, 0.451},
                                                         {0.8, 0.475, 0.655},
                                                         {0.902, 0.624, 0.0},
                                                         {0.337, 0.706, 0.914},
                                                         {0.2, 0.2, 0.2}}};

struct Pen {
  cairo_t* cairo;

  void colour(int index) const {
    const auto& c = kPalette[static_cast<std::size_t>(index) % kPalette.size()];
    cairo_set_source_rgb(cairo, c[0], c[1], c[2]);
  }
  void grey(double value) const { cairo_set_source_rgb(cairo, value, value, value); }

  /// Text with its anchor (0 to 1 across and down its own box) at x, y; returns its width.
  double text(const std::string& raw, double x, double y, double size, double across, double down,
              bool upright = true) const {
    const std::unique_ptr<char, decltype(&g_free)> valid(
        g_utf8_make_valid(raw.c_str(), static_cast<gssize>(raw.size())), &g_free);
    Owned<PangoLayout> layout(pango_cairo_create_layout(cairo));
    Owned<PangoFontDescription> font(pango_font_description_new());
    pango_font_description_set_family(font.get(), kFont);
    pango_font_description_set_absolute_size(font.get(), size * PANGO_SCALE);
    pango_layout_set_font_description(layout.get(), font.get());
    pango_layout_set_text(layout.get(), valid.get(), -1);
    int w = 0, h = 0;
    pango_layout_get_pixel_size(layout.get(), &w, &h);
    cairo_save(cairo);
    cairo_translate(cairo, x, y);
    if (!upright) cairo_rotate(cairo, -std::acos(-1.0) / 2);
    cairo_move_to(cairo, -across * w, -down * h);
    pango_cairo_show_layout(cairo, layout.get());
    cairo_restore(cairo);
    return w;
  }
  void line(double x0, double y0, double x1, double y1, double width) const {
    cairo_set_line_width(cairo, width);
    cairo_move_to(cairo, x0, y0);
    cairo_line_to(cairo, x1, y1);
    cairo_stroke(cairo);
  }
};

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

void drawMarker(const Pen& pen, double x, double y, int shape) {
  cairo_new_path(pen.cairo);
  if (shape % 2 == 0)
    cairo_arc(pen.cairo, x, y, kMarker_px, 0, 2 * std::acos(-1.0));
  else
    cairo_rectangle(pen.cairo, x - kMarker_px, y - kMarker_px, 2 * kMarker_px, 2 * kMarker_px);
  cairo_set_line_width(pen.cairo, 1.5);
  cairo_stroke(pen.cairo);
}

void drawSeries(const Pen& pen, const Frame& f, const Series& s, int colour) {
  pen.colour(colour);
  if (s.markers) {
    for (const auto& p : s.points)
      if (finite(p)) drawMarker(pen, f.px(p.first), f.py(p.second), colour);
    return;
  }
  bool open = false;
  cairo_set_line_width(pen.cairo, kLine_px);
  for (const auto& p : s.points) {
    if (finite(p) && open) cairo_line_to(pen.cairo, f.px(p.first), f.py(p.second));
    if (finite(p) && !open) cairo_move_to(pen.cairo, f.px(p.first), f.py(p.second));
    open = finite(p);
  }
  cairo_stroke(pen.cairo);
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
  cairo_set_source_rgba(pen.cairo, 1, 1, 1, 0.85);
  cairo_rectangle(pen.cairo, x, y, w, h);
  cairo_fill(pen.cairo);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Series& s = chart.series[rows[k]];
    const int colour = s.colour < 0 ? rows[k] : s.colour;
    const double row = y + kPad_px / 2 + kRow_px * (static_cast<double>(k) + 0.5);
    pen.colour(colour);
    if (s.markers)
      drawMarker(pen, x + kPad_px + kSample_px / 2, row, colour);
    else
      pen.line(x + kPad_px, row, x + kPad_px + kSample_px, row, kLine_px);
    pen.grey(0.1);
    pen.text(s.label, x + kSample_px + 1.6 * kPad_px, row, kTick_px, 0, 0.5);
  }
}

void draw(cairo_t* cairo, const Chart& chart) {
  const Pen pen{cairo};
  cairo_set_source_rgb(cairo, 1, 1, 1);
  cairo_paint(cairo);
  const Frame frame = frameOf(chart);
  drawAxes(pen, frame, chart);
  for (std::size_t k = 0; k < chart.series.size(); ++k) {
    const Series& s = chart.series[k];
    drawSeries(pen, frame, s, s.colour < 0 ? static_cast<int>(k) : s.colour);
  }
  drawLegend(pen, frame, chart);
}

cairo_status_t append(void* to, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

/// cairo numbers surfaces over the life of the process; the same drawing gets the same bytes.
void dropSurfaceNumber(std::string& svg) {
  const std::string_view key = "id=\"surface";
  const std::size_t at = svg.find(key);
  if (at == std::string::npos) return;
  const std::size_t from = at + key.size(), to = svg.find('"', from);
  svg.erase(from, to - from);
}

Result<void> publish(cairo_status_t status, const std::string& bytes,
                     const std::filesystem::path& file) {
  if (status != CAIRO_STATUS_SUCCESS)
    return failure(file.string(), fmt::format("cairo: {}", cairo_status_to_string(status)),
                   "Check memory and the size of the picture.");
  return writeFile(file, bytes);
}
}  // namespace

Result<void> writeSvg(const Chart& chart, const std::filesystem::path& file) {
  std::string bytes;
  cairo_status_t status;
  {
    const Owned<cairo_surface_t> surface(
        cairo_svg_surface_create_for_stream(append, &bytes, chart.width_px, chart.height_px));
    const Owned<cairo_t> cairo(cairo_create(surface.get()));
    draw(cairo.get(), chart);
    cairo_surface_finish(surface.get());
    status = cairo_surface_status(surface.get());
  }
  dropSurfaceNumber(bytes);
  return publish(status, bytes, file);
}

Result<void> writePng(const Chart& chart, const std::filesystem::path& file) {
  std::string bytes;
  const Owned<cairo_surface_t> surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, chart.width_px, chart.height_px));
  const Owned<cairo_t> cairo(cairo_create(surface.get()));
  draw(cairo.get(), chart);
  cairo_surface_flush(surface.get());
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface.get(), append, &bytes);
  return publish(status, bytes, file);
}
}  // namespace swallowclip::plot
