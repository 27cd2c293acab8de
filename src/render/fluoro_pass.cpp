// SPDX-License-Identifier: MIT
#include "render/fluoro_pass.h"

#include <cmath>

#include "render/xray.h"

namespace swallowclip::render {
namespace {
constexpr int kScatterShare = 8;  // scatter is as smooth as centimetres

// Pixels per metre in the plane through the view's target.
float scale(const Camera& camera, const Bounds& scene) {
  const Vec3f middle = 0.5f * (scene.low + scene.high);
  const float away = camera.eye.w() > 0.5f ? (camera.eye.head<3>() - middle).norm() : 1.0f;
  return camera.pixelsPerMetre.y() + camera.pixelsPerMetre.x() / away;
}
}  // namespace

Result<void> FluoroPass::create(const std::filesystem::path& dir, const RenderPreset& preset) {
  const struct {
    Program& program;
    const char *vertex, *fragment;
  } programs[] = {{length_, "solid.vert", "fluoro_length.frag"},
                  {scatter_, "screen.vert", "fluoro_scatter.frag"},
                  {blur_, "screen.vert", "fluoro_blur.frag"},
                  {detector_, "screen.vert", "fluoro_detector.frag"},
                  {display_, "screen.vert", "fluoro_display.frag"}};
  for (const auto& p : programs) {
    auto loaded = Program::load(dir, p.vertex, p.fragment);
    if (!loaded) return std::unexpected(loaded.error());
    p.program = std::move(*loaded);
  }
  const int w = preset.width, h = preset.height;
  const int sw = (w + kScatterShare - 1) / kScatterShare;
  const int sh = (h + kScatterShare - 1) / kScatterShare;
  const Result<void> made[] = {depth_.create("fluoroscopy", w, h, GL_RG32F, 0),
                               scatterA_.create("scatter", sw, sh, GL_RG32F, 0),
                               scatterB_.create("scatter", sw, sh, GL_RG32F, 0),
                               signalA_.create("detector", w, h, GL_R32F, 0),
                               signalB_.create("detector", w, h, GL_R32F, 0),
                               picture_.create("fluoroscopy picture", w, h, GL_RGBA8, 0)};
  for (const auto& m : made)
    if (!m) return m;
  return {};
}

// What a mesh adds counts against what it displaces: soft tissue within the body, else air. Air
// itself (mu/rho 0.1875 cm2/g, 1.2 kg/m3: 0.02 /m) is left out.
Result<void> FluoroPass::drawDepth(const DrawList& list, const Camera& camera,
                                   const RenderPreset& preset, const std::string& only) {
  const double around = preset.fluoro.body ? substance("soft-tissue")->attenuation_per_m() : 0;
  const double dense = substance("cortical-bone")->attenuation_per_m();
  depth_.bind();
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  length_.use();
  for (const char* clip : {"uClip[0]", "uClip[1]", "uClip[2]"})
    length_.set(clip, Eigen::Vector4f(0, 0, 0, 1));
  length_.set("uViewProj", camera.viewProjection);
  length_.set("uEye", camera.eye);
  const float origin = 0.5f * (camera.near_m + camera.far_m) * camera.eye.w();
  length_.set("uOrigin", origin);
  const auto add = [&](const DrawItem& item, double attenuation_per_m, double layer) {
    length_.set("uAttenuation", static_cast<float>(attenuation_per_m));
    length_.set("uLayer", static_cast<float>(layer));
    const Vec3f middle = 0.5f * (item.bounds.low + item.bounds.high);
    const float distance = camera.eye.w() > 0.5f ? (camera.eye.head<3>() - middle).norm() - origin
                                                 : -camera.eye.head<3>().dot(middle);
    const float half = 0.5f * (item.bounds.high - item.bounds.low).norm() + 1e-3f;
    length_.set("uReach", Eigen::Vector2f(distance - half, distance + half));
    mesh_->draw(item);
  };
  for (const auto* items : {&list.solid, &list.ghost})
    for (const DrawItem& item : *items) {
      if (!only.empty() && item.name != only) continue;
      if (item.name == "bolus") {  // displaces the lumen's air
        add(item, suspension_per_m(list.barium_kgm3), 0);
        continue;
      }
      const auto body = substance(item.substance);
      if (!body) {
        glDisable(GL_BLEND);
        return std::unexpected(body.error());
      }
      const double mu = body->attenuation_per_m();
      add(item, mu - around, (dense - mu) * corticalThickness_m(item.name, item.substance));
    }
  if (only.empty()) {
    for (const DrawItem& item : list.air) add(item, -around, 0);
    for (const DrawItem& item : list.body) add(item, around, 0);
  }
  glDisable(GL_BLEND);
  return {};
}

void FluoroPass::cover(const Target& to) {
  to.bind();
  mesh_->drawScreen();
}

void FluoroPass::blur(const Target& from, const Target& by, const Target& to, float sigma_px) {
  blur_.use();
  blur_.set("uSigma", sigma_px);
  blur_.set("uStep", Eigen::Vector2i(1, 0));
  from.colour().bind(0);
  cover(by);
  blur_.set("uStep", Eigen::Vector2i(0, 1));
  by.colour().bind(0);
  cover(to);
}

Result<const Target*> FluoroPass::drawSignal(const DrawList& list, const Camera& camera,
                                             const RenderPreset& preset, int frame) {
  const FluoroDef& def = preset.fluoro;
  if (auto ok = drawDepth(list, camera, preset); !ok) return std::unexpected(ok.error());
  const float px_m = scale(camera, list.bounds);
  depth_.colour().bind(0);
  scatter_.use();
  cover(scatterA_);
  blur(scatterA_, scatterB_, scatterA_, def.scatterRadius_m * px_m / kScatterShare);
  depth_.colour().bind(0);
  scatterA_.colour().bind(1);
  detector_.use();
  detector_.set("uScatterGain", def.scatterToPrimary / list.referenceDepth);
  // the exposure is set so that the quanta behind the reference depth are those of the preset
  const float openQuanta_m2 = def.quanta_per_m2 * std::exp(list.referenceDepth);
  detector_.set("uQuanta", openQuanta_m2 / (px_m * px_m));
  detector_.set(
      "uField",
      Eigen::Vector4f(px_m * Eigen::Vector4f(0.5f * def.fieldWidth_m, 0.5f * def.fieldHeight_m,
                                             def.fieldCorner_m, def.penumbra_m)));
  detector_.set("uCentre", Eigen::Vector2f(0.5f * static_cast<float>(preset.width),
                                           0.5f * static_cast<float>(preset.height)));
  detector_.set("uFrame", frame);
  cover(signalA_);
  if (const float sigma = def.blur_m * px_m; sigma > 0.1f)
    blur(signalA_, signalB_, signalA_, sigma);
  return &signalA_;
}

Result<Image> FluoroPass::draw(const GpuMesh& mesh, const DrawList& list, const Camera& camera,
                               const RenderPreset& preset, int frame) {
  mesh_ = &mesh;
  const auto signal = drawSignal(list, camera, preset, frame);
  if (!signal) return std::unexpected(signal.error());
  display_.use();
  display_.set("uWindow", Eigen::Vector2f(list.referenceDepth + preset.fluoro.white,
                                          list.referenceDepth + preset.fluoro.black));
  display_.set("uReference", list.referenceDepth);
  display_.set("uEqualisation", preset.fluoro.equalisation);
  display_.set("uGamma", preset.fluoro.gamma);
  display_.set("uDark", preset.fluoro.boneDark ? 1 : 0);
  (*signal)->colour().bind(0);
  scatterA_.colour().bind(1);
  cover(picture_);
  Image image = readPicture(preset.width, preset.height);
  if (auto ok = checkedGl("fluoroscopy"); !ok) return std::unexpected(ok.error());
  return image;
}

std::vector<float> FluoroPass::read(const Target& from) const {
  from.bind();
  const std::size_t row = static_cast<std::size_t>(from.width());
  std::vector<float> upward(row * static_cast<std::size_t>(from.height())), values;
  glReadPixels(0, 0, from.width(), from.height(), GL_RED, GL_FLOAT, upward.data());
  values.reserve(upward.size());
  for (std::size_t y = upward.size(); y > 0; y -= row)
    values.insert(values.end(), upward.begin() + static_cast<std::ptrdiff_t>(y - row),
                  upward.begin() + static_cast<std::ptrdiff_t>(y));
  return values;
}

Result<FloatImage> FluoroPass::signal(const GpuMesh& mesh, const DrawList& list,
                                      const Camera& camera, const RenderPreset& preset, int frame) {
  mesh_ = &mesh;
  const auto signal = drawSignal(list, camera, preset, frame);
  if (!signal) return std::unexpected(signal.error());
  FloatImage image{preset.width, preset.height, read(**signal)};
  if (auto ok = checkedGl("fluoroscopy"); !ok) return std::unexpected(ok.error());
  return image;
}

Result<std::map<std::string, int>> FluoroPass::visiblePixels(const GpuMesh& mesh,
                                                             const DrawList& list,
                                                             const Camera& camera,
                                                             const RenderPreset& preset,
                                                             const std::set<std::string>& names) {
  mesh_ = &mesh;
  constexpr float kContrast = 0.05f;  // optical depth that shows above the noise; assumed 0.03..0.1
  const float half_px = 0.5f * scale(camera, list.bounds);
  const float halfWidth = half_px * preset.fluoro.fieldWidth_m;
  const float halfHeight = half_px * preset.fluoro.fieldHeight_m;
  std::map<std::string, int> counts;
  for (const auto* items : {&list.solid, &list.ghost})
    for (const DrawItem& item : *items) {
      if (!names.contains(item.name)) continue;
      if (auto ok = drawDepth(list, camera, preset, item.name); !ok)
        return std::unexpected(ok.error());
      const FloatImage depth{preset.width, preset.height, read(depth_)};
      for (int y = 0; y < depth.height; ++y)
        for (int x = 0; x < depth.width; ++x)
          counts[item.name] +=
              std::abs(depth.at(x, y)) > kContrast &&
              (halfWidth <= 0 || (std::abs(static_cast<float>(x) + 0.5f -
                                           0.5f * static_cast<float>(depth.width)) < halfWidth &&
                                  std::abs(static_cast<float>(y) + 0.5f -
                                           0.5f * static_cast<float>(depth.height)) < halfHeight));
    }
  if (auto ok = checkedGl("fluoroscopy"); !ok) return std::unexpected(ok.error());
  return counts;
}
}  // namespace swallowclip::render
