// SPDX-License-Identifier: MIT
#include <chrono>
#include <map>

#include "core/file.h"
#include "frame/exporter.h"
#include "frame/history_file.h"
#include "pipeline/clips.h"
#include "pipeline/compare.h"
#include "pipeline/components.h"
#include "pipeline/confirm.h"
#include "pipeline/draw_bench.h"
#include "pipeline/interrupt.h"
#include "pipeline/pipeline.h"
#include "pipeline/simulation.h"
#include "pipeline/swallow_sheet.h"
#include "render/renderer.h"
#include "scene/bolus_file.h"
#include "scene/file_kind.h"
#include "scene/mapping_file.h"
#include "scene/preset_file.h"
#include "scene/side_file.h"
#include "scene/swallow_file.h"

namespace swallowclip::pipeline {
namespace {
double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::filesystem::path clipFolder(const RunOptions& o, const frame::Meta& m) {
  return m.component > 0 ? o.out / fmt::format("c{:02}", m.component) : o.out / m.swallow;
}

Result<void> publish(const RunOptions& o, const render::RenderPreset& preset,
                     const frame::History& h, double simulation_s, Progress& progress) {
  auto metrics = measureHistory(o.scenesFolder(), h);
  if (!metrics) return std::unexpected(metrics.error());
  const Confirmation confirmation = confirm(h.meta, *metrics);
  const std::filesystem::path folder = placeFor(confirmation, clipFolder(o, h.meta));
  if (auto ready = prepareFolder(folder); !ready) return ready;
  const std::string stem = clipStem(h.meta);
  // The side file says that its clips are whole: it goes first and comes back last.
  const auto side = folder / (stem + ".json");
  std::error_code ec;
  std::filesystem::remove(side, ec);
  auto times = drawClips(o, preset, h, *metrics, folder, stem, progress);
  if (!times) return std::unexpected(times.error());
  if (auto written = writeFile(side, scene::sideFileText(h, *metrics)); !written) return written;
  progress.note(fmt::format(
      "{}: {}; simulation {:.1f} s, drawing {:.1f} s, encoding beside it {:.1f} s", side.string(),
      confirmation.reason, simulation_s, times->drawing_s, times->encoding_s));
  return {};
}

std::vector<int> wantedScores(const RunOptions& o) {
  return o.scores.empty() ? std::vector<int>{-1} : o.scores;
}
}  // namespace

Result<void> render(const RunOptions& o, Progress& progress) {
  auto preset = scene::loadPreset(o.presetsFolder(), o.preset);
  if (!preset) return std::unexpected(preset.error());
  if (auto ready = prepareFolder(o.out); !ready) return ready;
  for (int score : wantedScores(o)) {
    progress.stage(score >= 0
                       ? fmt::format("component {}, score {}: simulating", o.component, score)
                       : "simulating");
    const double start = now_s();
    auto history = simulateSwallow(o, score, preset->fps, progress);
    if (!history) return std::unexpected(history.error());
    if (auto told = reportChanges(o, *history, progress); !told) return told;
    if (auto done = publish(o, *preset, *history, now_s() - start, progress); !done) return done;
  }
  return {};
}

Result<void> simulate(const RunOptions& o, Progress& progress) {
  auto preset = scene::loadPreset(o.presetsFolder(), o.preset);
  if (!preset) return std::unexpected(preset.error());
  const std::vector<int> scores = wantedScores(o);
  if (scores.size() != 1)
    return usageError("--score", "simulate writes one history, so it takes one score",
                      "Run it once per score.");
  progress.stage("simulating");
  SolverCost cost;
  auto history = simulateSwallow(o, scores.front(), preset->fps, progress, &cost);
  if (!history) return std::unexpected(history.error());
  if (cost.steps > 0)
    progress.note(fmt::format("{} particles, {} steps in {:.1f} s: {:.2f} us of a particle's step",
                              cost.particles, cost.steps, cost.wall_s, cost.eachStep_us()));
  if (auto saved = frame::saveHistory(*history, o.history); !saved) return saved;
  return reportChanges(o, *history, progress);
}

Result<void> measure(const RunOptions& o, Progress& progress) {
  auto history = frame::loadHistory(o.history);
  if (!history) return std::unexpected(history.error());
  auto metrics = measureHistory(o.scenesFolder(), *history);
  if (!metrics) return std::unexpected(metrics.error());
  if (!o.plot.empty())
    if (auto drawn = plot::writeFigure(swallowSheet(*history, *metrics), o.plot); !drawn)
      return drawn;
  progress.print(o.json ? scene::sideFileText(*history, *metrics) : scoring::formatTable(*metrics));
  return {};
}

Result<void> draw(const RunOptions& o, Progress& progress) {
  auto preset = scene::loadPreset(o.presetsFolder(), o.preset);
  if (!preset) return std::unexpected(preset.error());
  auto history = frame::loadHistory(o.history);
  if (!history) return std::unexpected(history.error());
  if (o.bench) return benchDrawing(o, *preset, *history, progress);
  return publish(o, *preset, *history, 0, progress);
}

Result<void> exportHistory(const RunOptions& o, Progress& progress) {
  auto format = frame::exportFormat(o.format);
  if (!format) return std::unexpected(format.error());
  auto history = frame::loadHistory(o.history);
  if (!history) return std::unexpected(history.error());
  auto written = frame::exportHistory(*history, *format, o.out);
  if (!written) return std::unexpected(written.error());
  progress.note(fmt::format("{}: {} files written", o.out.string(), *written));
  return {};
}

Result<void> importMeshes(const RunOptions& o, Progress& progress) {
  auto scene = scene::importScene(o.input, o.map, o.out);
  if (!scene) return std::unexpected(scene.error());
  for (const std::string& line : scene->report) progress.note(line);
  progress.note(fmt::format("{}: {} structures; use it with --scene {}", o.out.string(),
                            scene->anatomy.structures.size(), o.out.string()));
  return {};
}

Result<void> list(const RunOptions& o, Progress& progress) {
  std::string text;
  if (o.topic == "components" || o.topic == "scores") {
    for (const Component& c : components()) {
      text += fmt::format("{:2}  {} (0-{})\n", c.number, c.title, c.highestScore());
      if (o.topic == "scores")
        for (int s = 0; s <= c.highestScore(); ++s)
          text += fmt::format("      {}  {}\n", s, c.scores[s]);
    }
  } else if (o.topic == "views") {
    auto preset = scene::loadPreset(o.presetsFolder(), o.preset);
    if (!preset) return std::unexpected(preset.error());
    for (const auto& [name, view] : preset->views)
      text += fmt::format("{:10} {}\n", name, view.captionTitle);
  } else if (o.topic == "presets") {
    for (const std::string& name : scene::presetNames(o.presetsFolder())) text += name + "\n";
  } else if (o.topic == "boluses") {
    auto boluses = scene::loadBoluses(o.scenesFolder());
    if (!boluses) return std::unexpected(boluses.error());
    for (const auto& b : *boluses) text += fmt::format("{:14} {}\n", b.name, b.description);
  } else {
    std::vector<std::string> names;
    std::error_code ec;
    for (const auto& e : std::filesystem::directory_iterator(o.scenesFolder(), ec))
      if (std::filesystem::exists(e.path() / "anatomy.json", ec) ||
          std::filesystem::exists(e.path() / "scene.json", ec))
        names.push_back(e.path().filename().string());
    std::sort(names.begin(), names.end());
    for (const std::string& n : names) text += n + "\n";
  }
  progress.print(text);
  return {};
}

namespace {
// Presets and boluses are told by their keys, scene files by their name; the rest are swallows.
Result<void> checkOne(const RunOptions& o, const std::filesystem::path& f) {
  auto kind = scene::fileKind(f);
  if (!kind) return std::unexpected(kind.error());
  if (*kind != scene::FileKind::other) return scene::checkFile(f, *kind, o.presetsFolder());
  const auto verdict = [](const auto& result) {
    return result ? Result<void>{} : std::unexpected(result.error());
  };
  for (const char* name : {"lumen.json", "soft.json", "anatomy.json", "scene.json"})
    if (f.filename() == name) {
      RunOptions at = o;
      at.scene = std::filesystem::absolute(f).parent_path().string();
      return verdict(loadScene(at));
    }
  return verdict(scene::loadSwallow(f));
}
}  // namespace

namespace {
// Every view of the preset over every frame: does it show what it promises?
Result<void> checkViews(const RunOptions& o, const std::filesystem::path& run, Progress& progress) {
  auto preset = scene::loadPreset(o.presetsFolder(), o.preset);
  if (!preset) return std::unexpected(preset.error());
  auto history = frame::loadHistory(run);
  if (!history) return std::unexpected(history.error());
  auto renderer = render::Renderer::create(o.data / "shaders", *preset);
  if (!renderer) return std::unexpected(renderer.error());
  progress.stage(run.string());
  using Worst =
      std::map<std::string, std::pair<render::Loss, int>>;  // by structure, with its frame
  std::map<std::string, Worst> worst;                       // by view
  for (int k = 0; k < history->frames(); ++k) {
    for (const auto& [view, def] : preset->views) {
      if (interrupted()) return std::unexpected(interruptedError());
      if (def.shows.empty()) continue;
      auto lost = renderer->lost(*history, k, view);
      if (!lost) return std::unexpected(lost.error());
      for (const render::Loss& loss : *lost) {
        const auto [it, first] = worst[view].try_emplace(loss.structure, loss, k);
        if (!first && loss.pixels < it->second.first.pixels) it->second = {loss, k};
      }
    }
    progress.update(static_cast<double>(k + 1) / history->frames());
  }
  std::vector<std::string> losses;
  for (const auto& [view, structures] : worst)
    for (const auto& [structure, found] : structures)
      losses.push_back(fmt::format("view '{}' loses '{}': {} pixels at frame {}, {} expected", view,
                                   structure, found.first.pixels, found.second,
                                   found.first.expected));
  if (losses.empty()) return {};
  return failure(run.string(), fmt::format("{}", fmt::join(losses, "\n  ")),
                 "Move the camera or the cuts of the preset, or lower what the view \"shows\".");
}
}  // namespace

Result<void> check(const RunOptions& o, Progress& progress) {
  std::error_code ec;
  for (const std::filesystem::path& given : o.files) {
    std::vector<std::filesystem::path> files{given};
    if (std::filesystem::is_directory(given, ec)) {
      files.clear();
      for (const auto& e : std::filesystem::recursive_directory_iterator(given, ec))
        if (e.path().extension() == ".json") files.push_back(e.path());
      std::sort(files.begin(), files.end());
      if (files.empty())
        return usageError(given.string(), "no .json file in this folder",
                          "Name a scene folder or a file.");
    }
    for (const auto& f : files) {
      auto ok = f.extension() == ".h5" ? checkViews(o, f, progress) : checkOne(o, f);
      if (!ok) return ok;
      progress.print(f.string() + ": good\n");
    }
  }
  return {};
}
}  // namespace swallowclip::pipeline
