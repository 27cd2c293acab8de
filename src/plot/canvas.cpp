// SPDX-License-Identifier: MIT
#include "plot/canvas.h"

#include <cairo-svg.h>
#include <pango/pangocairo.h>

#include <array>
#include <cmath>
#include <memory>

#include "core/file.h"

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
constexpr std::array<std::array<double, 3>, 7> kPalette{{{0.0, 0.447, 0.698},
                                                         {0.835, 0.369, 0.0},
                                                         {0.0, 0.620, 0.451},
                                                         {0.8, 0.475, 0.655},
                                                         {0.902, 0.624, 0.0},
                                                         {0.337, 0.706, 0.914},
                                                         {0.2, 0.2, 0.2}}};

Owned<PangoLayout> layoutOf(cairo_t* cairo, const std::string& raw, double size, bool bold) {
  const std::unique_ptr<char, decltype(&g_free)> valid(
      g_utf8_make_valid(raw.c_str(), static_cast<gssize>(raw.size())), &g_free);
  Owned<PangoLayout> layout(pango_cairo_create_layout(cairo));
  Owned<PangoFontDescription> font(pango_font_description_new());
  pango_font_description_set_family(font.get(), kFont);
  pango_font_description_set_absolute_size(font.get(), size * PANGO_SCALE);
  if (bold) pango_font_description_set_weight(font.get(), PANGO_WEIGHT_BOLD);
  pango_layout_set_font_description(layout.get(), font.get());
  pango_layout_set_text(layout.get(), valid.get(), -1);
  return layout;
}

void paper(cairo_t* cairo) {
  cairo_set_source_rgb(cairo, 1, 1, 1);
  cairo_paint(cairo);
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

void Pen::colour(int index, double alpha) const {
  const auto& c = kPalette[static_cast<std::size_t>(index) % kPalette.size()];
  cairo_set_source_rgba(cairo_, c[0], c[1], c[2], alpha);
}
void Pen::grey(double value, double alpha) const {
  cairo_set_source_rgba(cairo_, value, value, value, alpha);
}

double Pen::text(const std::string& words, double x, double y, double size, double across,
                 double down, bool upright, bool bold) const {
  const auto layout = layoutOf(cairo_, words, size, bold);
  int w = 0, h = 0;
  pango_layout_get_pixel_size(layout.get(), &w, &h);
  cairo_save(cairo_);
  cairo_translate(cairo_, x, y);
  if (!upright) cairo_rotate(cairo_, -std::acos(-1.0) / 2);
  cairo_move_to(cairo_, -across * w, -down * h);
  pango_cairo_show_layout(cairo_, layout.get());
  cairo_restore(cairo_);
  return w;
}

double Pen::textWidth(const std::string& words, double size, bool bold) const {
  int w = 0;
  pango_layout_get_pixel_size(layoutOf(cairo_, words, size, bold).get(), &w, nullptr);
  return w;
}

void Pen::line(double x0, double y0, double x1, double y1, double width) const {
  moveTo(x0, y0);
  lineTo(x1, y1);
  stroke(width);
}

void Pen::box(double x, double y, double width, double height, double round) const {
  const double r = std::min({round, width / 2, height / 2}), quarter = std::acos(-1.0) / 2;
  cairo_new_path(cairo_);
  cairo_arc(cairo_, x + width - r, y + r, r, -quarter, 0);
  cairo_arc(cairo_, x + width - r, y + height - r, r, 0, quarter);
  cairo_arc(cairo_, x + r, y + height - r, r, quarter, 2 * quarter);
  cairo_arc(cairo_, x + r, y + r, r, 2 * quarter, 3 * quarter);
  cairo_close_path(cairo_);
  cairo_fill(cairo_);
}

void Pen::marker(double x, double y, double radius, int shape) const {
  cairo_new_path(cairo_);
  if (shape % 2 == 0)
    cairo_arc(cairo_, x, y, radius, 0, 2 * std::acos(-1.0));
  else
    cairo_rectangle(cairo_, x - radius, y - radius, 2 * radius, 2 * radius);
  cairo_set_line_width(cairo_, 1.5);
  cairo_stroke(cairo_);
}

void Pen::moveTo(double x, double y) const {
  cairo_move_to(cairo_, x, y);
}
void Pen::lineTo(double x, double y) const {
  cairo_line_to(cairo_, x, y);
}
void Pen::stroke(double width) const {
  cairo_set_line_width(cairo_, width);
  cairo_stroke(cairo_);
}
void Pen::clip(double x, double y, double width, double height) const {
  cairo_save(cairo_);
  cairo_rectangle(cairo_, x, y, width, height);
  cairo_clip(cairo_);
}
void Pen::unclip() const {
  cairo_restore(cairo_);
}

Result<void> writeSvg(const Drawing& drawing, int width_px, int height_px,
                      const std::filesystem::path& file) {
  std::string bytes;
  cairo_status_t status;
  {
    const Owned<cairo_surface_t> surface(
        cairo_svg_surface_create_for_stream(append, &bytes, width_px, height_px));
    const Owned<cairo_t> cairo(cairo_create(surface.get()));
    paper(cairo.get());
    drawing(Pen(cairo.get()));
    cairo_surface_finish(surface.get());
    status = cairo_surface_status(surface.get());
  }
  dropSurfaceNumber(bytes);
  return publish(status, bytes, file);
}

Result<void> writePng(const Drawing& drawing, int width_px, int height_px,
                      const std::filesystem::path& file) {
  std::string bytes;
  const Owned<cairo_surface_t> surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px));
  const Owned<cairo_t> cairo(cairo_create(surface.get()));
  paper(cairo.get());
  drawing(Pen(cairo.get()));
  cairo_surface_flush(surface.get());
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface.get(), append, &bytes);
  return publish(status, bytes, file);
}
}  // namespace swallowclip::plot
