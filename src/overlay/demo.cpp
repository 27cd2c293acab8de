// SPDX-License-Identifier: MIT
#include "overlay/demo.h"

#include <algorithm>
#include <cmath>

#include "core/file.h"
#include "overlay/canvas.h"
#include "pipeline/interrupt.h"
#include "render/renderer.h"
#include "video/frame_sink.h"

namespace swallowclip::overlay {
namespace {
constexpr double kDegree = kPi / 180;

/// Counter-based noise: the same number for the same key (splitmix64, Steele 2014).
double uniform(std::uint64_t key) {
  key += 0x9e3779b97f4a7c15ull;
  key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9ull;
  key = (key ^ (key >> 27)) * 0x94d049bb133111ebull;
  return (static_cast<double>((key ^ (key >> 31)) >> 11) + 0.5) * 0x1p-53;
}
/// Standard normal (Box & Muller 1958).
double normal(std::uint64_t key) {
  return std::sqrt(-2 * std::log(uniform(2 * key))) * std::cos(2 * kPi * uniform(2 * key + 1));
}

/// Noise, and black outside the round aperture.
void detect(Image& image, const DemoDef& def, int frame) {
  const Vec2 centre(0.5 * def.width, 0.5 * def.height);
  const double radius = def.aperture * def.height;
  for (int y = 0; y < def.height; ++y)
    for (int x = 0; x < def.width; ++x) {
      std::uint8_t* p = image.row(y) + 4 * x;
      const bool open = (Vec2(x + 0.5, y + 0.5) - centre).norm() < radius;
      const std::uint64_t key =
          (static_cast<std::uint64_t>(frame) * def.height + y) * def.width + x;
      const double grey = open ? p[0] + def.noise * normal(key) : 4;
      p[0] = p[1] = p[2] = static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
    }
}
}  // namespace

Similarity demoPlace(const DemoDef& def, const Vec2& target_m, int frame, int frames) {
  const double share = frames > 1 ? static_cast<double>(frame) / (frames - 1) : 0;
  Similarity s;
  s.scale = def.pixelsPerMm / kMetrePerMm;
  s.angle_rad = (def.startAngle_deg + share * def.turn_deg) * kDegree;
  s.offset_px = Vec2(0.5 * def.width, 0.5 * def.height) + share * def.drift_px - s.apply(target_m);
  return s;
}

Marks demoMarks(const DemoDef& def, const frame::History& swallow,
                const std::vector<StudyEvent>& events, const DemoTruth& truth) {
  Marks marks;
  marks.events = events;
  std::uint64_t key = 1;
  for (int k = 0; k < swallow.frames(); k += def.landmarkEvery)
    for (const LandmarkKind& kind : landmarkKinds()) {
      const frame::LandmarkTrack* track = swallow.landmark(kind.name);
      if (!kind.fixed || !track) continue;
      const Vec3f& p = track->positions[static_cast<std::size_t>(k)];
      const Vec2 at = truth.place[static_cast<std::size_t>(k)].apply({p.y(), -p.z()}) +
                      def.landmarkNoise_px * Vec2(normal(key), normal(key + 1));
      key += 2;
      if (at.x() > 0 && at.y() > 0 && at.x() < def.width && at.y() < def.height)
        marks.points.push_back({kind.name, k, at});
    }
  return marks;
}

std::string marksText(const Marks& marks) {
  std::string text = fmt::format("{{\n  \"version\": 1,\n  \"facing\": \"{}\",\n  \"events\": {{",
                                 marks.facesRight ? "right" : "left");
  for (const StudyEvent& e : marks.events)
    text += fmt::format("{}\"{}\": {}", &e == marks.events.data() ? "" : ", ", e.name, e.frame);
  text += "},\n  \"landmarks\": [";
  for (const MarkedPoint& p : marks.points)
    text += fmt::format("{}\n    {{\"name\": \"{}\", {}\"x_px\": {:.2f}, \"y_px\": {:.2f}}}",
                        &p == marks.points.data() ? "" : ",", p.name,
                        p.frame ? fmt::format("\"frame\": {}, ", *p.frame) : "", p.at_px.x(),
                        p.at_px.y());
  return text + "\n  ]\n}\n";
}

Result<DemoStudy> makeDemoStudy(const DemoDef& def, const frame::History& swallow,
                                const std::vector<StudyEvent>& events,
                                const render::RenderPreset& preset,
                                const std::filesystem::path& shaders,
                                const std::filesystem::path& folder) {
  const auto view = preset.views.find("fluoro");
  if (view == preset.views.end())
    return usageError("--preset", "has no view \"fluoro\"", "Use training.");
  render::RenderPreset small = preset;
  small.width = def.width;
  small.height = def.height;
  small.caption.on = false;
  auto renderer = render::Renderer::create(shaders, small);
  if (!renderer) return std::unexpected(renderer.error());
  const Vec2 target_m(view->second.target_m.y(), -view->second.target_m.z());
  Similarity camera;  // from the plane to the renderer's picture
  camera.scale = def.height / view->second.orthoHeight_m;
  camera.offset_px = Vec2(0.5 * def.width, 0.5 * def.height) - camera.apply(target_m);

  DemoStudy study{folder / "demo-study.mp4", folder / "demo-study.events.json", {}};
  video::Mp4Def mp4;
  mp4.path = study.video;
  mp4.width = def.width;
  mp4.height = def.height;
  mp4.rateNumerator = static_cast<int>(std::lround(swallow.meta.fps));
  auto sink = video::makeMp4Sink(mp4);
  if (!sink) return std::unexpected(sink.error());
  for (int k = 0; k < swallow.frames(); ++k) {
    if (pipeline::interrupted()) return std::unexpected(pipeline::interruptedError());
    auto film = renderer->draw(swallow, k, "fluoro", {});
    if (!film) return std::unexpected(film.error());
    const Similarity place = demoPlace(def, target_m, k, swallow.frames());
    study.truth.place.push_back(place);
    Image image(def.width, def.height);
    lay(
        image, {0, 0, def.width, def.height}, *film,
        [&](const Vec2& p) { return camera.apply(place.inverse(p)); }, camera.scale / place.scale);
    detect(image, def, k);
    if (auto pushed = (*sink)->push(image); !pushed) return std::unexpected(pushed.error());
  }
  if (auto done = (*sink)->finish(); !done) return std::unexpected(done.error());
  const Marks marks = demoMarks(def, swallow, events, study.truth);
  if (auto written = writeFile(study.events, marksText(marks)); !written)
    return std::unexpected(written.error());
  return study;
}
}  // namespace swallowclip::overlay
