// SPDX-License-Identifier: MIT
#include "overlay/composer.h"

#include <algorithm>
#include <cmath>

#include "render/draw_list.h"
#include "render/draw_mesh.h"

namespace swallowclip::overlay {
namespace {
constexpr double kTopBand = 2.9, kBottomBand = 2.6;  // of the caption size: title, time bar
// The presets' views frame their subjects for 16:9; the subject itself needs this much width.
constexpr double kSubjectAspect = 1.25;  // assumed, range 1.1 to 1.4
constexpr double kOutline_px = 1.9;      // at 720 lines; assumed, range 1.2 to 3
constexpr float kOutlineOpacity = 0.9f, kFillOpacity = 0.30f, kBolusOpacity = 0.45f;
const Vec3f kBolusColour(0.0f, 0.45f, 0.70f);  // blue of Okabe & Ito
constexpr double kParticleShare = 0.62;        // disc radius / spacing: neighbours just merge

/// Midsagittal section in plane coordinates, pairs of points.
std::vector<Vec2> sectionOf(const frame::StructureTrack& s, int k) {
  const std::vector<Vec3f> positions = render::positionsAt(s, k);
  std::vector<Vec2> out;
  for (const Vec3f& p : render::sectionSegments(s.triangles, positions, Vec3f(1, 0, 0), 0.0f))
    out.push_back({p.y(), -p.z()});
  return out;
}

int even(double x) {
  return std::max(2, 2 * static_cast<int>(std::lround(x / 2)));
}
}  // namespace

std::span<const Ink> inks() {
  static const Ink all[] = {{"tongue", "orange tongue", {0.90f, 0.62f, 0.0f}},
                            {"soft_palate", "light blue velum", {0.34f, 0.71f, 0.91f}},
                            {"pharyngeal_wall", "green pharynx", {0.0f, 0.75f, 0.52f}},
                            {"epiglottis", "yellow epiglottis", {0.94f, 0.89f, 0.26f}},
                            {"hyoid", "pink bone", {0.90f, 0.55f, 0.75f}},
                            {"mandible", "", {0.90f, 0.55f, 0.75f}},
                            {"thyroid", "red larynx", {0.95f, 0.45f, 0.15f}},
                            {"cricoid", "", {0.95f, 0.45f, 0.15f}}};
  return all;
}

std::vector<Rectangle> panesOf(const ComposeDef& def, int width, int height, double size_px) {
  const int top = even(kTopBand * size_px), rows = even(height - top - kBottomBand * size_px);
  if (def.layout == Layout::superimposed) return {{0, top, width, rows}};
  const int half = even(width / 2.0), high = even(rows / 2.0 - 1), wide = even(half / 2.0 - 1);
  std::vector<Rectangle> panes{{0, top, half, rows}};
  switch (def.views.size()) {
    case 1:
      panes.push_back({half, top, width - half, rows});
      break;
    case 2:
      for (int i = 0; i < 2; ++i) panes.push_back({half, top + i * high, width - half, high});
      break;
    case 3:  // four quarters, the X-ray first
      panes[0] = {0, top, half, high};
      for (int i = 1; i < 4; ++i) panes.push_back({i % 2 * half, top + i / 2 * high, half, high});
      break;
    default:
      for (int i = 0; i < 4; ++i)
        panes.push_back({half + i % 2 * wide, top + i / 2 * high, wide, high});
  }
  return panes;
}

Result<Composer> Composer::make(const ComposeDef& def, const render::RenderPreset& preset,
                                const std::filesystem::path& shaders, const Rectangle& opening) {
  Composer c;
  c.def_ = def;
  c.preset_ = preset;
  c.opening_ = opening;
  c.panes_ = panesOf(def, preset.width, preset.height, preset.caption.size_px);
  const Rectangle& x = c.panes_[0];
  c.zoom_ = std::min(x.width / static_cast<double>(opening.width),
                     x.height / static_cast<double>(opening.height));
  if (c.panes_.size() < 2) return c;
  render::RenderPreset pane = preset;
  pane.width = c.panes_[1].width;
  pane.height = c.panes_[1].height;
  pane.caption.on = false;
  const double aspect = static_cast<double>(pane.width) / pane.height;
  if (aspect < kSubjectAspect)
    for (auto& [name, view] : pane.views) {
      view.fovY_rad = 2 * std::atan(std::tan(view.fovY_rad / 2) * kSubjectAspect / aspect);
      view.orthoHeight_m *= kSubjectAspect / aspect;
    }
  auto renderer = render::Renderer::create(shaders, pane);
  if (!renderer) return std::unexpected(renderer.error());
  c.renderer_ = std::make_unique<render::Renderer>(std::move(*renderer));
  return c;
}

Vec2 Composer::paneFromStudy(const Vec2& p) const {
  const Rectangle& x = panes_[0];
  return Vec2(x.x + 0.5 * (x.width - zoom_ * opening_.width),
              x.y + 0.5 * (x.height - zoom_ * opening_.height)) +
         zoom_ * (p - Vec2(opening_.x, opening_.y));
}

std::string Composer::legend() const {
  if (def_.layout == Layout::sideBySide) return "";
  std::string words;
  for (const Ink& ink : inks())
    if (*ink.word) words += std::string(ink.word) + ", ";
  return words + "blue bolus";
}

void Composer::drawModel(Image& onto, const frame::History& model, int k,
                         const Similarity& place) const {
  const auto toPane = [&](std::vector<Vec2> points) {
    for (Vec2& p : points) p = paneFromStudy(place.apply(p));
    return points;
  };
  if (!model.bolus.positions.empty()) {
    Coverage bolus(panes_[0]);
    const double spacing_m = std::cbrt(model.bolus.particleVolume_m3);
    const auto& particles = model.bolus.positions[static_cast<std::size_t>(k)];
    for (std::size_t i = 0; i < particles.size(); ++i)
      if (frame::isThere(model.bolus.state[static_cast<std::size_t>(k)][i]))
        bolus.disc(toPane({{particles[i].y(), -particles[i].z()}})[0],
                   kParticleShare * spacing_m * place.scale * zoom_);
    bolus.blendOnto(onto, kBolusColour, kBolusOpacity);
  }
  const double width_px = kOutline_px * preset_.height / 720.0;
  for (const Ink& ink : inks()) {
    const frame::StructureTrack* s = model.find(ink.structure);
    if (!s) continue;
    const std::vector<Vec2> section = toPane(sectionOf(*s, k));
    if (def_.style == Style::translucent) {
      Coverage area(panes_[0]);
      area.fill(section);
      area.blendOnto(onto, ink.colour_srgb, kFillOpacity);
    }
    Coverage line(panes_[0]);
    line.stroke(section, width_px);
    line.blendOnto(onto, ink.colour_srgb, kOutlineOpacity);
  }
}

void Composer::drawStudy(Image& onto, const Image& study, const frame::History& model, int k,
                         const Similarity& place) const {
  const Vec2 origin = paneFromStudy(Vec2(0, 0));
  const Rectangle& x = panes_[0];
  // only the opening, so that nothing of what was blacked out takes room
  const Vec2 low = paneFromStudy(Vec2(opening_.x, opening_.y));
  const Rectangle shown{std::max(x.x, static_cast<int>(std::floor(low.x()))),
                        std::max(x.y, static_cast<int>(std::floor(low.y()))),
                        std::min(x.width, static_cast<int>(std::ceil(zoom_ * opening_.width))),
                        std::min(x.height, static_cast<int>(std::ceil(zoom_ * opening_.height)))};
  lay(
      onto, shown, study, [&](const Vec2& p) { return Vec2((p - origin) / zoom_); }, 1 / zoom_);
  if (def_.layout != Layout::sideBySide) drawModel(onto, model, k, place);
}

Result<Image> Composer::draw(const Image& study, const frame::History& model, int k,
                             const Similarity& place, const render::CaptionText& words) {
  Image image(preset_.width, preset_.height);
  for (std::size_t i = 0; i < image.rgba.size(); ++i)
    if (i % 4 != 3) image.rgba[i] = 0;
  drawStudy(image, study, model, k, place);
  for (std::size_t i = 1; i < panes_.size(); ++i) {
    auto pane = renderer_->draw(model, k, def_.views[i - 1], {});
    if (!pane) return pane;
    paste(image, *pane, panes_[i].x, panes_[i].y);
  }
  if (auto drawn = render::drawCaptions(image, preset_.caption, words); !drawn)
    return std::unexpected(drawn.error());
  return image;
}
}  // namespace swallowclip::overlay
