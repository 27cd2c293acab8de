// SPDX-License-Identifier: MIT
// `sweep`: one swallow per value of one number, each single-threaded, as many at a time as --jobs.
#include <cmath>

#include "core/file.h"
#include "core/parallel.h"
#include "pipeline/compare.h"
#include "pipeline/confirm.h"
#include "pipeline/interrupt.h"
#include "pipeline/pipeline.h"
#include "pipeline/simulation.h"
#include "plot/figure.h"
#include "scene/preset_file.h"

namespace swallowclip::pipeline {
namespace {
/// One value: what was measured, or why not.
struct Point {
  double value = 0;
  std::optional<scoring::Metrics> metrics;
  std::string problem;
};

/// The single runs report to nobody: their shares would overwrite each other.
class Quiet : public Progress {
 public:
  explicit Quiet(Progress& outer) : outer_(outer) {}
  void stage(std::string_view) override {}
  void update(double) override {}
  void print(std::string_view) override {}
  void note(std::string_view text) override { outer_.note(text); }

 private:
  Progress& outer_;
};

Point runOne(const RunOptions& all, double value, double fps, Progress& progress) {
  RunOptions o = all;
  o.jobs = 1;
  o.sets.push_back({all.range->track, all.range->key, value});
  Point point{value, {}, ""};
  Quiet quiet(progress);
  auto history = simulateSwallow(o, o.scores.empty() ? -1 : o.scores.front(), fps, quiet);
  auto metrics = history ? measureHistory(o.scenesFolder(), *history)
                         : Result<scoring::Metrics>(std::unexpected(history.error()));
  if (metrics)
    point.metrics = std::move(*metrics);
  else
    point.problem = metrics.error().problem;
  return point;
}

std::string axisName(const TrackRange& r) {
  return fmt::format("{}.{}", r.track, r.key);
}

std::string csvText(const TrackRange& range, const std::vector<Point>& points) {
  std::string text = axisName(range);
  for (const Outcome& o : outcomes())
    text += fmt::format(",{}{}{}", o.quantity, *o.unit ? "_" : "",
                        std::string_view(o.unit) == "%" ? "percent" : o.unit);
  text += ",problem\n";
  for (const Point& p : points) {
    text += fmt::format("{:g}", p.value);
    for (const Outcome& o : outcomes()) {
      const double v = p.metrics ? outcome(*p.metrics, o) : std::nan("");
      text += std::isfinite(v) ? fmt::format(",{:g}", v) : ",";
    }
    std::string problem = p.problem;
    for (char& c : problem)
      if (c == '"' || c == '\n') c = ' ';
    text += problem.empty() ? ",\n" : fmt::format(",\"{}\"\n", problem);
  }
  return text;
}

std::string tableText(const TrackRange& range, const std::vector<Point>& points) {
  std::string text = fmt::format("{:>20}", axisName(range));
  for (const char* title : {"PAS", "airway mL", "mouth %", "pharynx %", "swallowed %", "to LVC s"})
    text += fmt::format(" {:>11}", title);
  text += "\n";
  for (const Point& p : points) {
    text += fmt::format("{:>20g}", p.value);
    for (const char* name :
         {"pas", "airway_most", "oral_residue", "pharyngeal_residue", "swallowed", "time_to_lvc"})
      for (const Outcome& o : outcomes()) {
        if (std::string_view(o.quantity) != name) continue;
        const double v = p.metrics ? outcome(*p.metrics, o) : std::nan("");
        text += fmt::format(" {:>11}", std::isfinite(v) ? fmt::format("{:.3g}", v) : "-");
      }
    text += p.problem.empty() ? "\n" : "  " + p.problem + "\n";
  }
  return text;
}

plot::Figure figureOf(const RunOptions& o, const std::vector<Point>& points) {
  const auto line = [&](const char* quantity, const char* label, int colour) {
    plot::Series s{label, {}, false, colour};
    for (const Outcome& which : outcomes())
      if (std::string_view(which.quantity) == quantity)
        for (const Point& p : points)
          s.points.push_back({p.value, p.metrics ? outcome(*p.metrics, which) : std::nan("")});
    return s;
  };
  plot::Figure f;
  f.title = fmt::format("What {} changes", axisName(*o.range));
  f.subtitle = fmt::format("{}  ·  bolus {}",
                           o.component > 0 ? fmt::format("component {}, score {}", o.component,
                                                         o.scores.empty() ? -1 : o.scores.front())
                                           : o.swallow.stem().string(),
                           o.bolus);
  f.xLabel = axisName(*o.range);
  f.width_px = 900;
  f.panels.push_back({.title = "Protection of the airway",
                      .yLabel = "PAS (1 to 8)",
                      .height_px = 170,
                      .series = {line("pas", "penetration-aspiration scale", 1)},
                      .markers = true});
  f.panels.push_back({.title = "In the airway",
                      .yLabel = "mL",
                      .height_px = 130,
                      .series = {line("airway_most", "most at any time", 4),
                                 line("airway_at_end", "left at the end", 6)},
                      .markers = true});
  f.panels.push_back(
      {.title = "Residue",
       .yLabel = "% of the bolus",
       .height_px = 170,
       .series = {line("oral_residue", "mouth", 2), line("pharyngeal_residue", "pharynx", 0)},
       .markers = true});
  return f;
}
}  // namespace

std::vector<double> TrackRange::values() const {
  const int steps = static_cast<int>(std::floor((to - from) / step + 1e-6));
  std::vector<double> out;
  // Decimal fractions stay as they were typed.
  for (int k = 0; k <= steps; ++k) out.push_back(std::round((from + k * step) * 1e9) / 1e9);
  return out;
}

Result<void> sweep(const RunOptions& o, Progress& progress) {
  auto preset = scene::loadPreset(o.presetsFolder(), o.preset);
  if (!preset) return std::unexpected(preset.error());
  const std::vector<double> values = o.range->values();
  // Every value is tried on the swallow before the first long run.
  for (double value : values) {
    RunOptions trial = o;
    trial.sets.push_back({o.range->track, o.range->key, value});
    auto loaded = loadSwallow(trial, o.scores.empty() ? -1 : o.scores.front());
    if (!loaded) return std::unexpected(loaded.error());
  }
  if (auto ready = prepareFolder(o.out); !ready) return ready;
  const int n = static_cast<int>(values.size());
  progress.stage(fmt::format("{} over {} values", axisName(*o.range), n));
  std::vector<Point> points(values.size());
  std::atomic<int> done{0};
  ThreadPool pool(std::min(o.jobs, n));
  pool.forChunks(n, 1, [&](int begin, int, int) {
    const auto at = static_cast<std::size_t>(begin);
    points[at] = runOne(o, values[at], preset->fps, progress);
    progress.update(static_cast<double>(++done) / n);
  });
  if (interrupted()) return std::unexpected(interruptedError());
  for (const Point& p : points)
    if (!p.metrics)
      progress.note(fmt::format("{}={:g}: {}", axisName(*o.range), p.value, p.problem));
  if (auto ok = writeFile(o.out / "sweep.csv", csvText(*o.range, points)); !ok) return ok;
  const plot::Figure figure = figureOf(o, points);
  for (const char* name : {"sweep.svg", "sweep.png"})
    if (auto ok = plot::writeFigure(figure, o.out / name); !ok) return ok;
  progress.print(tableText(*o.range, points));
  return {};
}
}  // namespace swallowclip::pipeline
