// SPDX-License-Identifier: MIT
#include "overlay/film.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "pipeline/interrupt.h"
#include "study/dicom_writer.h"
#include "video/frame_sink.h"
#include "video/png.h"
#include "video/vtt.h"

namespace swallowclip::overlay {
namespace {
constexpr double kEven = 2e-3;      // frame lengths this alike make an even rate; assumed 1e-3-1e-2
constexpr double kWhole = 2e-3;     // 29.97 counts as 30: half a frame's drift in 16 s
constexpr int kUnevenRate_hz = 60;  // shows any moment within 8 ms
constexpr double kLeastRate_hz = 30;  // Bonilha 2013

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool isEven(const study::StudyInfo& s) {
  const double step = s.rate_hz() > 0 ? 1 / s.rate_hz() : 0;
  for (std::size_t i = 1; i < s.time_s.size(); ++i)
    if (std::abs(s.time_s[i] - s.time_s[i - 1] - step) > std::max(kEven * step, 1.1e-3))
      return false;
  return step > 0;
}
}  // namespace

Rate outputRate(const study::StudyInfo& study) {
  if (!isEven(study)) return {kUnevenRate_hz, 1};
  // the mean, since containers round single frames to milliseconds
  const double rate = (study.frames() - 1) / (study.time_s.back() - study.time_s.front());
  const int times = std::max(1, static_cast<int>(std::ceil(kLeastRate_hz / rate - kWhole)));
  for (int denominator = 1; denominator <= 4; ++denominator) {
    const double numerator = rate * times * denominator;
    const auto whole = static_cast<int>(std::lround(numerator));
    if (std::abs(numerator - whole) <= kWhole * numerator && whole >= kLeastRate_hz * denominator)
      return {whole, denominator};
  }
  return {kUnevenRate_hz, 1};
}

Clock makeClock(const study::StudyInfo& study) {
  Clock c;
  c.rate = outputRate(study);
  const double step_s = 1 / c.rate.hz();
  const int frames = std::max(1, static_cast<int>(std::lround(study.end_s() * c.rate.hz())));
  c.clipFrameOf.assign(static_cast<std::size_t>(study.frames()), frames - 1);
  for (int k = 0; k < frames; ++k) {
    c.time_s.push_back(k * step_s);
    // half a frame on: a study frame that begins with this one is already shown
    c.studyFrame.push_back(study.frameAt((k + 0.5) * step_s));
    int& first = c.clipFrameOf[static_cast<std::size_t>(c.studyFrame.back())];
    first = std::min(first, k);
  }
  return c;
}

namespace {
render::CaptionText caption(const FilmDef& def, const study::StudyInfo& info, const Marks& marks,
                            const std::string& legend) {
  render::CaptionText c;
  c.title = def.title;
  for (const StudyEvent& e : marks.events)
    c.events.push_back({e.name, info.time_s[static_cast<std::size_t>(e.frame)]});
  c.duration_s = info.end_s();
  c.subtitle = legend.empty() ? def.subtitle : def.subtitle + "; " + legend;
  return c;
}

/// The scored moment where there is one, else the middle.
int posterFrame(const Marks& marks, const Clock& clock) {
  for (const StudyEvent& e : marks.events)
    if (e.name == "BPM" || e.name == "HYB" || e.name == "UESO")
      return clock.clipFrameOf[static_cast<std::size_t>(e.frame)];
  return static_cast<int>(clock.time_s.size()) / 2;
}
}  // namespace

Result<FilmTimes> film(const FilmDef& def, study::Study& study, const study::Protector& protector,
                       const Marks& marks, const Clock& clock, const frame::History& model,
                       const Registration& registration, Composer& composer,
                       pipeline::Progress& progress) {
  const auto beside = [&](const char* extension) {
    std::filesystem::path p = def.path;
    return p.replace_extension(extension);
  };
  FilmTimes times;
  const study::StudyInfo& info = study.info();
  render::CaptionText words = caption(def, info, marks, composer.legend());
  std::vector<std::unique_ptr<video::FrameSink>> sinks;
  Image seen, image, poster;
  int seenFrame = -1;
  const int posterAt = posterFrame(marks, clock);
  for (int k = 0; k < static_cast<int>(clock.time_s.size()); ++k) {
    if (pipeline::interrupted()) return std::unexpected(pipeline::interruptedError());
    const double t0 = now_s();
    const int f = clock.studyFrame[static_cast<std::size_t>(k)];
    if (f != seenFrame) {
      auto next = study.frame(f);
      if (!next) return std::unexpected(next.error());
      seen = std::move(*next);
      protector.apply(seen);
      seenFrame = f;
    }
    words.time_s = clock.time_s[static_cast<std::size_t>(k)];
    words.viewLabel =
        fmt::format("X-ray frame {} of {}, {:.3g} pulses/s", f, info.frames() - 1, info.rate_hz());
    auto drawn = composer.draw(seen, model, k, registration.at(f), words);
    if (!drawn) return std::unexpected(drawn.error());
    const double t1 = now_s();
    if (sinks.empty()) {
      video::Mp4Def mp4;
      mp4.path = def.path;
      mp4.width = drawn->width;
      mp4.height = drawn->height;
      mp4.rateNumerator = clock.rate.numerator;
      mp4.rateDenominator = clock.rate.denominator;
      auto made = video::makeMp4Sink(mp4);
      if (!made) return std::unexpected(made.error());
      sinks.push_back(std::move(*made));
      if (def.dicom) {
        study::DicomDef dicom;
        dicom.path = beside(".dcm");
        dicom.width = drawn->width;
        dicom.height = drawn->height;
        dicom.frameTime_ms = 1e3 / clock.rate.hz();
        dicom.series = "Synthetic swallow beside videofluoroscopy";
        auto second = study::makeDicomSink(dicom);
        if (!second) return std::unexpected(second.error());
        sinks.push_back(std::move(*second));
      }
    }
    for (auto& sink : sinks)
      if (auto pushed = sink->push(*drawn); !pushed) return std::unexpected(pushed.error());
    if (k == posterAt) poster = std::move(*drawn);
    times.drawing_s += t1 - t0;
    times.encoding_s += now_s() - t1;
    progress.update(static_cast<double>(k + 1) / static_cast<double>(clock.time_s.size()));
  }
  const double t2 = now_s();
  for (auto& sink : sinks)
    if (auto done = sink->finish(); !done) return std::unexpected(done.error());
  times.encoding_s += now_s() - t2;
  if (auto written = video::writePng(poster, beside(".png")); !written)
    return std::unexpected(written.error());
  std::vector<video::Chapter> chapters;
  for (const render::CaptionEvent& e : words.events) chapters.push_back({e.name, e.time_s});
  if (auto written = video::writeVtt(
          chapters, static_cast<double>(clock.time_s.size()) / clock.rate.hz(), beside(".vtt"));
      !written)
    return std::unexpected(written.error());
  return times;
}
}  // namespace swallowclip::overlay
