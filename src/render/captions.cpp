// SPDX-License-Identifier: MIT
#include "render/captions.h"

#include <fmt/format.h>
#include <pango/pangocairo.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace swallowclip::render {
namespace {

struct Deleter {
  void operator()(cairo_surface_t* p) const { cairo_surface_destroy(p); }
  void operator()(cairo_t* p) const { cairo_destroy(p); }
  void operator()(PangoLayout* p) const { g_object_unref(p); }
  void operator()(PangoFontDescription* p) const { pango_font_description_free(p); }
};
template <class T>
using Owned = std::unique_ptr<T, Deleter>;

// A strip of the picture as a cairo surface; blended back by `pasteOn`.
class Strip {
 public:
  Strip(int width, int height)
      : surface_(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height)),
        cairo_(cairo_create(surface_.get())) {}

  bool ok() const { return cairo_status(cairo_.get()) == CAIRO_STATUS_SUCCESS; }
  cairo_t* cairo() const { return cairo_.get(); }

  void pasteOn(Image& image, int top) const {
    cairo_surface_flush(surface_.get());
    const unsigned char* data = cairo_image_surface_get_data(surface_.get());
    const int stride = cairo_image_surface_get_stride(surface_.get());
    const int height = cairo_image_surface_get_height(surface_.get());
    for (int y = 0; y < height && top + y < image.height; ++y) {
      const unsigned char* from = data + static_cast<std::size_t>(y) * stride;
      std::uint8_t* to = image.row(top + y);
      for (int x = 0; x < image.width; ++x, from += 4, to += 4) {
        std::uint32_t argb;  // cairo: native-endian word, premultiplied
        std::copy_n(from, 4, reinterpret_cast<unsigned char*>(&argb));
        const unsigned a = argb >> 24;
        if (a == 0) continue;
        for (int k = 0; k < 3; ++k) {
          const unsigned c = argb >> (16 - 8 * k) & 255;
          to[k] = static_cast<std::uint8_t>(std::min(255u, c + (to[k] * (255 - a) + 127) / 255));
        }
      }
    }
  }

 private:
  Owned<cairo_surface_t> surface_;
  Owned<cairo_t> cairo_;
};

constexpr double kSmallest = 0.6;  // of its size, that a long text may shrink to
// Letters are read before white air and pink skin alike: an edge of this width, in letter sizes.
constexpr double kEdge = 0.2;
constexpr float kEdgeAlpha = 0.75f;

enum class Align { left, centre, right };

struct Pen {
  cairo_t* cairo;
  const CaptionDef* def;

  void colour(float alpha) const {
    const Colour& c = def->colour_srgb;
    cairo_set_source_rgba(cairo, c.x(), c.y(), c.z(), alpha);
  }
  /// Text with its top at y, set smaller where it is wider than maxWidth and at last cut with an
  /// ellipsis; returns the width used.
  double text(const std::string& raw, double x, double y, double size, double maxWidth, bool bold,
              float alpha, Align align) const {
    if (raw.empty()) return 0;
    const std::unique_ptr<char, decltype(&g_free)> valid(
        g_utf8_make_valid(raw.c_str(), static_cast<gssize>(raw.size())), &g_free);
    const std::string words = valid.get();
    Owned<PangoLayout> layout(pango_cairo_create_layout(cairo));
    Owned<PangoFontDescription> font(pango_font_description_new());
    pango_font_description_set_family(font.get(), def->font.c_str());
    pango_font_description_set_weight(font.get(), bold ? PANGO_WEIGHT_BOLD : PANGO_WEIGHT_NORMAL);
    pango_layout_set_text(layout.get(), words.c_str(), static_cast<int>(words.size()));
    pango_layout_set_single_paragraph_mode(layout.get(), TRUE);
    pango_layout_set_width(layout.get(), static_cast<int>(maxWidth * PANGO_SCALE));
    pango_layout_set_ellipsize(layout.get(), PANGO_ELLIPSIZE_END);
    for (double px = std::round(size);; --px) {
      pango_font_description_set_absolute_size(font.get(), px * PANGO_SCALE);
      pango_layout_set_font_description(layout.get(), font.get());
      if (!pango_layout_is_ellipsized(layout.get()) || px - 1 < kSmallest * size) break;
    }
    int w = 0, h = 0;
    pango_layout_get_pixel_size(layout.get(), &w, &h);
    const double shift = align == Align::left ? 0 : align == Align::right ? -w : -0.5 * w;
    cairo_move_to(cairo, std::max(0.0, x + shift), y);
    pango_cairo_layout_path(cairo, layout.get());
    const float contrast = def->colour_srgb.mean() > 0.5f ? 0.0f : 1.0f;
    cairo_set_source_rgba(cairo, contrast, contrast, contrast, kEdgeAlpha);
    cairo_set_line_width(cairo, kEdge * size);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    cairo_stroke_preserve(cairo);
    colour(alpha);
    cairo_fill(cairo);
    return w;
  }
};

void shade(cairo_t* cairo, double height, bool fromTop) {
  cairo_pattern_t* fade = cairo_pattern_create_linear(0, 0, 0, height);
  cairo_pattern_add_color_stop_rgba(fade, fromTop ? 0 : 1, 0, 0, 0, 0.55);
  cairo_pattern_add_color_stop_rgba(fade, fromTop ? 1 : 0, 0, 0, 0, 0);
  cairo_set_source(cairo, fade);
  cairo_paint(cairo);
  cairo_pattern_destroy(fade);
}

std::string currentEvent(const CaptionText& text) {
  std::string name;
  for (const CaptionEvent& e : text.events)
    if (e.time_s <= text.time_s + 1e-9) name = e.name;
  return name;
}

void drawTimeBar(const Pen& pen, const CaptionText& text, double x0, double x1, double y,
                 double size) {
  if (text.duration_s <= 0) return;
  const auto at = [&](double t) {
    return x0 + (x1 - x0) * std::clamp((t - text.start_s) / text.duration_s, 0.0, 1.0);
  };
  const double thick = std::max(2.0, size * 0.16);
  cairo_t* c = pen.cairo;
  pen.colour(0.28f);
  cairo_rectangle(c, x0, y, x1 - x0, thick);
  cairo_fill(c);
  pen.colour(0.85f);
  cairo_rectangle(c, x0, y, at(text.time_s) - x0, thick);
  cairo_fill(c);
  for (const CaptionEvent& e : text.events) {  // ticks stand above the bar, reached ones bright
    pen.colour(e.time_s <= text.time_s + 1e-9 ? 0.95f : 0.45f);
    cairo_rectangle(c, std::round(at(e.time_s)) - 1, y - 2.5 * thick, 2, 2.5 * thick);
    cairo_fill(c);
  }
  pen.colour(1.0f);
  cairo_arc(c, at(text.time_s), y + 0.5 * thick, 1.6 * thick, 0, 2 * kPi);
  cairo_fill(c);
}
}  // namespace

Result<void> drawCaptions(Image& image, const CaptionDef& def, const CaptionText& text) {
  if (!def.on || image.width <= 0) return {};
  const double size = def.size_px, small = 0.72 * size, margin = size;
  const double width = image.width;
  const int topHeight = std::min(image.height, static_cast<int>(std::ceil(size * 3.6)));
  const int bottomHeight = std::min(image.height, static_cast<int>(std::ceil(size * 3.4)));
  const Strip top(image.width, topHeight), bottom(image.width, bottomHeight);
  if (!top.ok() || !bottom.ok())
    return failure("captions", "cairo cannot make a surface", "Check memory and picture size.");
  const Pen up{top.cairo(), &def}, low{bottom.cairo(), &def};

  shade(up.cairo, topHeight, true);
  const double viewWidth = up.text(text.viewLabel, width - margin, 0.55 * size, small, 0.3 * width,
                                   false, 0.9f, Align::right);
  up.text(text.title, margin, 0.4 * size, size, width - 3 * margin - viewWidth, true, 1.0f,
          Align::left);
  up.text(text.subtitle, margin, 1.75 * size, small, width - 2 * margin, false, 0.85f, Align::left);

  shade(low.cairo, bottomHeight, false);
  const double line = bottomHeight - 1.65 * size, barY = bottomHeight - 0.45 * size;
  low.text(fmt::format("{:+.2f} s", text.time_s), margin, line, small, 0.1 * width, true, 1.0f,
           Align::left);
  low.text(currentEvent(text), margin + 5.0 * small, line, small, 0.5 * width, false, 0.95f,
           Align::left);
  low.text(text.credit.empty() ? def.credit : text.credit, width - margin, line + 0.12 * size,
           0.6 * size, 0.4 * width, false, 0.65f, Align::right);
  if (def.timeBar) drawTimeBar(low, text, margin, width - margin, barY, size);
  top.pasteOn(image, 0);
  bottom.pasteOn(image, image.height - bottomHeight);
  return {};
}
}  // namespace swallowclip::render
