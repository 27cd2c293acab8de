// SPDX-License-Identifier: MIT
#include "overlay/overlay.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/digest.h"
#include "core/file.h"
#include "frame/history_file.h"
#include "overlay/composer.h"
#include "overlay/contact_sheet.h"
#include "overlay/demo.h"
#include "overlay/film.h"
#include "overlay/marks.h"
#include "overlay/report.h"
#include "overlay/resimulate.h"
#include "overlay/retime.h"
#include "pipeline/components.h"
#include "pipeline/confirm.h"
#include "pipeline/interrupt.h"
#include "pipeline/simulation.h"
#include "scene/preset_file.h"
#include "scoring/measure.h"

namespace swallowclip::overlay {
namespace {
namespace fs = std::filesystem;
using pipeline::Progress;
using pipeline::RunOptions;

// Corrections of moved tracks: the thresholds of the measures lie a little beside the tracks' own
// times. Two without the bolus cost little and leave less than a frame; what only a bolus shows
// (BPM) follows a change of what was asked by 0.5 to 1 of it, so two with it suffice mostly.
constexpr int kDryCorrections = 2, kWetCorrections = 2;
constexpr double kLost_s = 1;  // an event that doesn't happen at all; assumed, more than any is off

Result<std::unique_ptr<study::Study>> openStudy(const RunOptions& o, const fs::path& path,
                                                Progress& progress) {
  progress.stage("reading the study");
  auto study = study::Study::open({path, o.overlay.frameRate_hz});
  if (!study) return study;
  const study::StudyInfo& info = (*study)->info();
  progress.note(fmt::format("study: {}, {} frames of {} x {}, {:.4g} pulses/s from {}", info.kind,
                            info.frames(), info.width, info.height, info.rate_hz(), info.timing));
  for (const std::string& w : info.warnings) progress.note("study: " + w);
  return study;
}

Result<study::Protector> protect(const RunOptions& o, study::Study& study, Progress& progress) {
  study::ProtectDef def;
  for (const auto& m : o.overlay.masks) def.masks.push_back({m[0], m[1], m[2], m[3]});
  def.noBurnedInText = o.overlay.noBurnedInText || o.overlay.demo;
  def.keepBorder = o.overlay.keepBorder;
  auto protector = study::Protector::make(study, def);
  if (protector)
    for (const std::string& n : protector->notes()) progress.note("study: " + n);
  return protector;
}

/// The swallow of the options, else the one that a history was made from.
Result<kinematics::SwallowDef> swallowOf(const RunOptions& o, const frame::History* history,
                                         fs::path* file) {
  RunOptions at = o;
  if (at.component == 0 && at.swallow.empty() && history)
    at.swallow = o.scenesFolder() / "swallows" / (history->meta.swallow + ".json");
  return pipeline::loadSwallow(at, at.scores.empty() ? -1 : at.scores.front(), file);
}

Result<frame::History> modelHistory(const RunOptions& o, double fps, Progress& progress) {
  if (!o.history.empty()) return frame::loadHistory(o.history);
  progress.stage("simulating the model");
  fs::path file;
  auto swallow = swallowOf(o, nullptr, &file);
  if (!swallow) return std::unexpected(swallow.error());
  return pipeline::simulateSwallow(o, *swallow, file, fps, progress);
}

/// Another patient: a quicker oral phase, a late hyoid, a longer opening. All assumed, within the
/// ranges of clinical-reference section 2.
Result<frame::History> demoSwallow(const RunOptions& o, const scoring::Metrics& model, double fps,
                                   Progress& progress) {
  progress.stage("simulating another swallow for the study");
  fs::path file;
  auto swallow = swallowOf(o, nullptr, &file);
  if (!swallow) return std::unexpected(swallow.error());
  const std::pair<const char*, double> later[] = {{"tongue_onset", -0.15}, {"HYB", -0.20},
                                                  {"BPM", -0.20},          {"UESO", -0.12},
                                                  {"UESC", 0.06},          {"SwRest", 0.15}};
  std::vector<EventPair> pairs;
  for (const auto& [name, shift_s] : later)
    if (const auto* e = model.event(name); e && e->time_s)
      pairs.push_back({name, *e->time_s + shift_s, *e->time_s});
  auto moved = movedTo(*swallow, pairs, 1 / fps);
  if (!moved) return std::unexpected(moved.error());
  RunOptions other = o;
  other.commandLine.clear();
  return pipeline::simulateSwallow(other, moved->swallow, file, fps, progress);
}

std::vector<StudyEvent> eventsOf(const scoring::Metrics& m) {
  std::vector<StudyEvent> events;
  for (const std::string& name : eventNames())
    if (const auto* e = m.event(name); e && e->time_s && e->frame >= 0)
      events.push_back({name, e->frame});
  return events;
}

struct Timed {
  frame::History model;      ///< on the clip's clock
  scoring::Metrics metrics;  ///< of the model in its own time
  TimeWarp warp = TimeWarp::shift(0);
  frame::Meta meta;
};

Result<Timed> warped(const RunOptions& o, const frame::History& model, const Marks& marks,
                     const study::StudyInfo& info, const Clock& clock) {
  auto metrics = pipeline::measureHistory(o.scenesFolder(), model);
  if (!metrics) return std::unexpected(metrics.error());
  auto warp = TimeWarp::make(pairEvents(marks, info, *metrics), 1 / info.rate_hz());
  if (!warp) return std::unexpected(warp.error());
  return Timed{retimed(model, *warp, clock.time_s, clock.rate.hz()), *metrics, *warp, model.meta};
}

/// Asks each event that is more than half a frame off for as much later as it was measured too
/// early; returns the sum of that, s. Before the bolus is there, what it decides is left alone:
/// BPM, and the tongue's onset, which is read off the bolus too.
double correct(std::vector<EventPair>& pairs, const scoring::Metrics& measured, double cue_s,
               double frame_s, bool dry) {
  double sum_s = 0;
  for (EventPair& p : pairs) {
    if (dry && (p.name == "BPM" || p.name == "tongue_onset")) continue;
    const auto* e = measured.event(p.name);
    const bool happens = e && e->time_s;
    const double early_s = happens ? p.study_s - (*e->time_s + cue_s) : kLost_s;
    if (std::abs(early_s) <= frame_s / 2 + kSameTime_s) continue;
    if (happens) p.correction_s += early_s;
    sum_s += std::abs(early_s);
  }
  return sum_s;
}

struct Run {
  frame::History history;
  scoring::Metrics metrics;
  double cue_s = 0;
};

Result<Run> simulated(const RunOptions& o, const MovedSwallow& moved, const fs::path& file,
                      double fps, Progress& progress) {
  auto history = pipeline::simulateSwallow(o, moved.swallow, file, fps, progress);
  if (!history) return std::unexpected(history.error());
  auto metrics = pipeline::measureHistory(o.scenesFolder(), *history);
  if (!metrics) return std::unexpected(metrics.error());
  return Run{std::move(*history), std::move(*metrics), moved.cue_s};
}

/// Tracks moved, corrected by what is measured without a bolus, then simulated with it.
Result<Run> movedRun(const RunOptions& o, const kinematics::SwallowDef& swallow,
                     const fs::path& file, std::vector<EventPair>& pairs, double frame_s,
                     double fps, Progress& progress) {
  progress.stage("moving the motion");
  RunOptions dry = o;
  dry.bolus = "none";
  for (int k = 0; o.hasBolus() && k < kDryCorrections; ++k) {
    const auto moved = movedTo(swallow, pairs, frame_s);
    if (!moved) return std::unexpected(moved.error());
    const auto run = simulated(dry, *moved, file, fps, progress);
    if (!run) return run;
    if (correct(pairs, run->metrics, run->cue_s, frame_s, true) == 0) break;
  }
  const auto moved = movedTo(swallow, pairs, frame_s);
  if (!moved) return std::unexpected(moved.error());
  progress.stage("simulating the model again");
  return simulated(o, *moved, file, fps, progress);
}

/// Motion moved to the study's events and simulated anew; again while what only a bolus shows comes
/// out beside its time. The run that meets the events best is taken.
Result<Timed> resimulated(const RunOptions& o, const frame::History& model, const Marks& marks,
                          const study::StudyInfo& info, const Clock& clock, double fps,
                          Progress& progress) {
  auto metrics = pipeline::measureHistory(o.scenesFolder(), model);
  if (!metrics) return std::unexpected(metrics.error());
  fs::path file;
  auto swallow = swallowOf(o, &model, &file);
  if (!swallow) return std::unexpected(swallow.error());
  std::vector<EventPair> pairs = pairEvents(marks, info, *metrics);
  RunOptions wet = o;
  if (!o.history.empty()) wet.bolus = model.meta.bolus;
  const double frame_s = 1 / info.rate_hz();
  std::optional<Timed> best;
  double least_s = INFINITY;
  for (int k = 0; least_s > 0 && k <= kWetCorrections; ++k) {
    auto run = movedRun(wet, *swallow, file, pairs, frame_s, fps, progress);
    if (!run && best && !pipeline::interrupted()) {
      progress.note("a further correction can't be simulated; the best run before it is shown");
      break;
    }
    if (!run) return std::unexpected(run.error());
    std::string inputs = run->history.meta.inputsSha256;
    for (const EventPair& p : pairs)
      inputs += fmt::format("{} {:.9g}\n", p.name, p.study_s + p.correction_s);
    const double off_s = correct(pairs, run->metrics, run->cue_s, frame_s, false);
    if (off_s >= least_s) continue;
    least_s = off_s;
    run->history.meta.inputsSha256 = sha256Hex(inputs);
    const TimeWarp warp = TimeWarp::shift(run->cue_s);
    best = Timed{retimed(run->history, warp, clock.time_s, clock.rate.hz()), run->metrics, warp,
                 run->history.meta};
  }
  return std::move(*best);
}

ComposeDef composeDef(const pipeline::OverlayOptions& o) {
  ComposeDef d;
  d.layout = o.layout == "superimposed" ? Layout::superimposed
             : o.layout == "both"       ? Layout::both
                                        : Layout::sideBySide;
  d.style = o.style == "translucent" ? Style::translucent : Style::outlines;
  d.views = o.views;
  return d;
}

std::string subtitleOf(const frame::Meta& m) {
  const std::string bolus = m.bolus == "none" ? "no bolus" : "bolus " + m.bolus;
  if (const pipeline::Component* c = pipeline::findComponent(m.component); c && m.score >= 0)
    return fmt::format("model: component {}, score {}, {}", c->number, m.score, bolus);
  return fmt::format("model: {}, {}", m.swallow, bolus);
}
}  // namespace

Result<void> events(const RunOptions& o, Progress& progress) {
  auto study = openStudy(o, o.overlay.vf, progress);
  if (!study) return std::unexpected(study.error());
  auto protector = protect(o, **study, progress);
  if (!protector) return std::unexpected(protector.error());
  if (auto ready = prepareFolder(o.out); !ready) return ready;
  progress.stage("drawing contact sheets");
  auto sheets = writeContactSheets(**study, *protector, o.out, progress);
  if (!sheets) return std::unexpected(sheets.error());
  progress.note(fmt::format("{}: {} sheets; fill in study.events.json", o.out.string(), *sheets));
  return {};
}

Result<void> overlay(const RunOptions& given, Progress& progress) {
  RunOptions o = given;
  if (o.overlay.demo && o.component == 0 && o.swallow.empty()) {
    o.component = 4;
    o.scores = {0};
  }
  FilmDef def;
  def.path = o.overlay.out.empty() ? fs::path("output/overlay/demo.mp4") : o.overlay.out;
  def.dicom = o.overlay.dicom;
  auto preset = scene::loadPreset(o.presetsFolder(), o.preset);
  if (!preset) return std::unexpected(preset.error());
  const fs::path folder = def.path.has_parent_path() ? def.path.parent_path() : fs::path(".");
  if (auto ready = prepareFolder(folder); !ready) return ready;
  // a study's own mistakes come before minutes of simulation
  fs::path vf = o.overlay.vf, eventsFile = o.overlay.events;
  std::optional<DemoTruth> truth;
  Result<frame::History> history = failure("overlay", "no model", "Report it.");
  if (o.overlay.demo) {
    history = modelHistory(o, preset->fps, progress);
    if (!history) return std::unexpected(history.error());
    auto metrics = pipeline::measureHistory(o.scenesFolder(), *history);
    if (!metrics) return std::unexpected(metrics.error());
    auto other = demoSwallow(o, *metrics, preset->fps, progress);
    if (!other) return std::unexpected(other.error());
    auto otherMetrics = pipeline::measureHistory(o.scenesFolder(), *other);
    if (!otherMetrics) return std::unexpected(otherMetrics.error());
    progress.stage("filming the study");
    auto made =
        makeDemoStudy({}, *other, eventsOf(*otherMetrics), *preset, o.data / "shaders", folder);
    if (!made) return std::unexpected(made.error());
    vf = made->video;
    eventsFile = made->events;
    truth = made->truth;
  }
  auto study = openStudy(o, vf, progress);
  if (!study) return std::unexpected(study.error());
  const study::StudyInfo& info = (*study)->info();
  auto protector = protect(o, **study, progress);
  if (!protector) return std::unexpected(protector.error());
  auto marks = loadMarks(eventsFile, info);
  if (!marks) return std::unexpected(marks.error());
  if (!o.overlay.demo) history = modelHistory(o, preset->fps, progress);
  if (!history) return std::unexpected(history.error());
  const Clock clock = makeClock(info);
  auto timed = o.overlay.resimulate
                   ? resimulated(o, *history, *marks, info, clock, preset->fps, progress)
                   : warped(o, *history, *marks, info, clock);
  if (!timed) return std::unexpected(timed.error());
  auto registration = Registration::make(*marks, timed->model, clock.clipFrameOf);
  if (!registration) return std::unexpected(registration.error());
  auto composer =
      Composer::make(composeDef(o.overlay), *preset, o.data / "shaders", protector->opening());
  if (!composer) return std::unexpected(composer.error());
  def.title = o.overlay.layout == "superimposed" ? "Simulated swallow on videofluoroscopy"
                                                 : "Videofluoroscopy and simulated swallow";
  def.subtitle = subtitleOf(timed->meta);
  // the side file says that its clip is whole: it goes first and comes back last
  fs::path side = def.path;
  side.replace_extension(".json");
  std::error_code ec;
  fs::remove(side, ec);
  progress.stage("composing");
  auto times = film(def, **study, *protector, *marks, clock, timed->model, *registration, *composer,
                    progress);
  if (!times) return std::unexpected(times.error());
  const auto rows = eventRows(*marks, info, timed->metrics, timed->warp);
  std::optional<TruthReport> against;
  if (truth) against = compare(*registration, *truth, timed->model, clock);
  if (auto written = writeFile(side, sideText(info, clock, rows, *registration, timed->meta,
                                              o.overlay.resimulate, against));
      !written)
    return written;
  for (const std::string& line : noteLines(rows, *registration, 1 / info.rate_hz(), against))
    progress.note(line);
  progress.note(fmt::format("{}: {} frames; drawing {:.1f} s, encoding beside it {:.1f} s",
                            def.path.string(), clock.time_s.size(), times->drawing_s,
                            times->encoding_s));
  return {};
}
}  // namespace swallowclip::overlay
