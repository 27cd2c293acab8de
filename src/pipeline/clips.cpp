// SPDX-License-Identifier: MIT
#include "pipeline/clips.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>

#include "bolus/solver.h"
#include "core/file.h"
#include "pipeline/components.h"
#include "pipeline/interrupt.h"
#include "render/renderer.h"
#include "scoring/clearance.h"
#include "video/frame_sink.h"
#include "video/png.h"
#include "video/vtt.h"

namespace swallowclip::pipeline {
namespace {
double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct EventMark {
  std::string name;
  double time_s;
};

// Measured events where there are any, else what the swallow file plans; cues come from the plan.
std::vector<EventMark> eventMarks(const frame::History& h, const scoring::Metrics& m) {
  std::vector<EventMark> marks;
  for (const auto& e : h.plannedEvents)
    if (e.name == "cue" || e.name == "second cue") marks.push_back({e.name, e.time_s});
  for (const auto& e : m.events)
    if (e.time_s) marks.push_back({e.name, *e.time_s});
  std::stable_sort(marks.begin(), marks.end(),
                   [](const auto& a, const auto& b) { return a.time_s < b.time_s; });
  return marks;
}

render::CaptionText captionFor(const frame::History& h, const std::vector<EventMark>& marks) {
  render::CaptionText c;
  if (const Component* k = findComponent(h.meta.component);
      k && h.meta.score >= 0 && h.meta.score <= k->highestScore())
    c.title = fmt::format("MBSImP component {}, score {}: {}", k->number, h.meta.score,
                          k->scores[h.meta.score]);
  else
    c.title = h.meta.swallow;
  c.subtitle = "no bolus";
  if (scoring::hasBolus(h)) {
    const double offered_m3 = static_cast<double>(h.bolus.s_m.front().size()) *
                              h.bolus.particleVolume_m3 / bolus::kFilledShare;
    c.subtitle = fmt::format("bolus: {}, {:.2g} mL", h.meta.bolus, offered_m3 * 1e6);
  }
  for (const EventMark& m : marks) {
    std::string words = m.name;
    std::replace(words.begin(), words.end(), '_', ' ');
    c.events.push_back({words, m.time_s});
  }
  c.start_s = h.time_s.front();
  c.duration_s = h.time_s.back() - h.time_s.front();
  return c;
}

// The scored moment, else the bolus passing the mandible, else mid-clip.
int posterFrame(const frame::History& h, const scoring::Metrics& m) {
  if (const auto at = m.scoredFrames.find(h.meta.component); at != m.scoredFrames.end())
    return std::min(at->second, h.frames() - 1);
  if (const auto* e = m.event("BPM"); e && e->time_s) return std::min(e->frame, h.frames() - 1);
  return h.frames() / 2;
}

// "tongue base gap 3.2 mm": what decides the score, as it is at a frame; "" where nothing does.
std::string liveValue(const frame::History& h, const scoring::Metrics& m, int frame) {
  const auto name = m.liveSeries.find(h.meta.component);
  const auto* series = name == m.liveSeries.end() ? nullptr : m.find(name->second);
  if (!series || !std::isfinite(series->values[frame])) return "";
  std::string words = series->name;
  std::replace(words.begin(), words.end(), '_', ' ');
  const bool share = series->unit == "share";
  return fmt::format("{} {:.1f} {}", words, (share ? 100 : 1) * series->values[frame],
                     share ? "%" : series->unit);
}
}  // namespace

std::string clipStem(const frame::Meta& m) {
  // What --set has changed never takes the name of the swallow as it was published.
  const auto plus = m.swallow.find('+');
  const std::string settings = plus == std::string::npos ? "" : m.swallow.substr(plus);
  if (m.component > 0 && m.score >= 0)
    return fmt::format("c{:02}-s{}-{}{}", m.component, m.score, m.bolus, settings);
  return fmt::format("{}-{}", m.swallow, m.bolus);
}

namespace {
// What all clips of a history have in common.
struct Film {
  const render::RenderPreset& preset;
  const frame::History& history;
  const scoring::Metrics& metrics;
  std::filesystem::path folder;
  std::string stem;
  std::vector<EventMark> marks;
};

// All views of a frame one after the other: they share its geometry.
Result<void> drawTogether(const Film& film, std::span<const std::string> views,
                          render::Renderer& renderer, Progress& progress, ClipTimes& times) {
  const frame::History& h = film.history;
  struct Clip {
    std::string view;
    std::filesystem::path path;
    std::unique_ptr<video::FrameSink> sink;
    Image poster;
  };
  std::vector<Clip> clips;
  for (const std::string& view : views) {
    video::Mp4Def def;
    def.path = film.folder / fmt::format("{}-{}.mp4", film.stem, view);
    def.width = film.preset.width;
    def.height = film.preset.height;
    def.rateNumerator = static_cast<int>(std::lround(h.meta.fps));
    auto sink = video::makeMp4Sink(def);
    if (!sink) return std::unexpected(sink.error());
    clips.push_back({view, def.path, std::move(*sink), {}});
  }
  render::CaptionText caption = captionFor(h, film.marks);
  const std::string bolus = caption.subtitle;
  const int poster = posterFrame(h, film.metrics);
  progress.stage(fmt::format("{}: drawing {}", film.stem, fmt::join(views, ", ")));
  for (int k = 0; k < h.frames(); ++k) {
    caption.time_s = h.time_s[k];
    const std::string live = liveValue(h, film.metrics, k);
    caption.subtitle = live.empty() ? bolus : bolus + "  ·  " + live;
    for (Clip& clip : clips) {
      if (interrupted()) return std::unexpected(interruptedError());
      const double t0 = now_s();
      auto image = renderer.draw(h, k, clip.view, caption);
      if (!image) return std::unexpected(image.error());
      const double t1 = now_s();
      if (auto pushed = clip.sink->push(*image); !pushed) return pushed;
      if (k == poster) clip.poster = std::move(*image);
      times.drawing_s += t1 - t0;
      times.encoding_s += now_s() - t1;
    }
    progress.update(static_cast<double>(k + 1) / h.frames());
  }
  std::vector<video::Chapter> chapters;
  for (const EventMark& e : film.marks) chapters.push_back({e.name, e.time_s});
  for (Clip& clip : clips) {
    const double t2 = now_s();
    if (auto done = clip.sink->finish(); !done) return done;
    times.encoding_s += now_s() - t2;
    if (auto written = video::writePng(clip.poster, clip.path.replace_extension(".png")); !written)
      return written;
    if (auto written =
            video::writeVtt(chapters, h.frames() / h.meta.fps, clip.path.replace_extension(".vtt"));
        !written)
      return written;
  }
  return {};
}
}  // namespace

Result<ClipTimes> drawClips(const RunOptions& o, const render::RenderPreset& preset,
                            const frame::History& h, const scoring::Metrics& m,
                            const std::filesystem::path& folder, const std::string& stem,
                            Progress& progress) {
  // an encoder of 1080p holds back some 200 MB of pictures
  constexpr std::size_t kClipsAtOnce = 4;
  auto renderer = render::Renderer::create(o.data / "shaders", preset);
  if (!renderer) return std::unexpected(renderer.error());
  const Film film{preset, h, m, folder, stem, eventMarks(h, m)};
  ClipTimes times;
  const std::span<const std::string> views(o.views);
  for (std::size_t v = 0; v < views.size(); v += kClipsAtOnce) {
    const auto some = views.subspan(v, std::min(kClipsAtOnce, views.size() - v));
    if (auto drawn = drawTogether(film, some, *renderer, progress, times); !drawn)
      return std::unexpected(drawn.error());
  }
  return times;
}
}  // namespace swallowclip::pipeline
