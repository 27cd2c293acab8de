// SPDX-License-Identifier: MIT
#include "pipeline/clips.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/file.h"
#include "pipeline/components.h"
#include "pipeline/interrupt.h"
#include "render/renderer.h"
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
  c.subtitle = h.meta.bolus == "none" ? "no bolus" : "bolus: " + h.meta.bolus;
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

Result<ClipTimes> drawClips(const RunOptions& o, const render::RenderPreset& preset,
                            const frame::History& h, const scoring::Metrics& m,
                            const std::filesystem::path& folder, const std::string& stem,
                            Progress& progress) {
  auto renderer = render::Renderer::create(o.data / "shaders", preset);
  if (!renderer) return std::unexpected(renderer.error());
  const std::vector<EventMark> marks = eventMarks(h, m);
  render::CaptionText caption = captionFor(h, marks);
  const std::string bolus = caption.subtitle;
  std::vector<video::Chapter> chapters;
  for (const EventMark& e : marks) chapters.push_back({e.name, e.time_s});
  const int poster = posterFrame(h, m);
  ClipTimes times;
  // all views of a frame one after the other: they share its geometry
  struct Clip {
    std::string view;
    std::filesystem::path path;
    std::unique_ptr<video::FrameSink> sink;
    Image poster;
  };
  std::vector<Clip> clips;
  for (const std::string& view : o.views) {
    video::Mp4Def def;
    def.path = folder / fmt::format("{}-{}.mp4", stem, view);
    def.width = preset.width;
    def.height = preset.height;
    def.rateNumerator = static_cast<int>(std::lround(h.meta.fps));
    auto sink = video::makeMp4Sink(def);
    if (!sink) return std::unexpected(sink.error());
    clips.push_back({view, def.path, std::move(*sink), {}});
  }
  progress.stage(fmt::format("{}: drawing {}", stem, fmt::join(o.views, ", ")));
  for (int k = 0; k < h.frames(); ++k) {
    caption.time_s = h.time_s[k];
    const std::string live = liveValue(h, m, k);
    caption.subtitle = live.empty() ? bolus : bolus + "  ·  " + live;
    for (Clip& clip : clips) {
      if (interrupted()) return std::unexpected(interruptedError());
      const double t0 = now_s();
      auto image = renderer->draw(h, k, clip.view, caption);
      if (!image) return std::unexpected(image.error());
      const double t1 = now_s();
      if (auto pushed = clip.sink->push(*image); !pushed) return std::unexpected(pushed.error());
      if (k == poster) clip.poster = std::move(*image);
      times.drawing_s += t1 - t0;
      times.encoding_s += now_s() - t1;
    }
    progress.update(static_cast<double>(k + 1) / h.frames());
  }
  for (Clip& clip : clips) {
    const double t2 = now_s();
    if (auto done = clip.sink->finish(); !done) return std::unexpected(done.error());
    times.encoding_s += now_s() - t2;
    if (auto written = video::writePng(clip.poster, clip.path.replace_extension(".png")); !written)
      return std::unexpected(written.error());
    if (auto written = video::writeVtt(chapters, h.frames() / h.meta.fps,
                                       clip.path.replace_extension(".vtt"));
        !written)
      return std::unexpected(written.error());
  }
  return times;
}
}  // namespace swallowclip::pipeline
