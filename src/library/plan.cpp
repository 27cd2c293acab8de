// SPDX-License-Identifier: MIT
#include "library/plan.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

#include "scene/preset_file.h"

namespace swallowclip::library {
namespace {
class Builder {
 public:
  Builder(const SpecDef& spec, const pipeline::RunOptions& options) : options_(options) {
    plan_.spec = spec;
  }

  Result<Plan> build() {
    for (const SwallowEntry& entry : plan_.spec.swallows)
      for (const std::string& preset : entry.presets)
        for (const std::string& bolus : entry.boluses)
          for (const std::string& view : entry.views)
            if (auto done = clip(entry, preset, bolus, view); !done)
              return std::unexpected(done.error());
    return std::move(plan_);
  }

 private:
  Result<void> clip(const SwallowEntry& entry, const std::string& preset, const std::string& bolus,
                    const std::string& view) {
    auto fps = framesPerSecond(preset);
    if (!fps) return std::unexpected(fps.error());
    Choice c;
    c.data = std::filesystem::absolute(options_.data);
    c.scene = plan_.spec.scene;
    c.solver = plan_.spec.solver;
    c.spacing_mm = plan_.spec.spacing_mm;
    c.fps = *fps;
    c.component = entry.component;
    c.score = entry.score;
    c.swallow = std::filesystem::absolute(entry.file);
    // A history is shared by all presets of one frame rate.
    const std::string rate = *fps == 30 ? "" : fmt::format(" at {} frames/s", *fps);
    const std::string swallow = fmt::format("c{:02}-s{}", entry.component, entry.score);
    auto bake = job(Stage::bake, swallow + rate, c, {});
    if (!bake) return std::unexpected(bake.error());
    c.bolus = bolus;
    const std::string name =
        fmt::format("{}/c{:02}/{}-{}", preset, entry.component, c.stem(), view);
    auto simulate = job(Stage::simulate, c.stem() + rate, c, {*bake});
    if (!simulate) return std::unexpected(simulate.error());
    auto measure = job(Stage::measure, c.stem() + rate, c, {*simulate});
    if (!measure) return std::unexpected(measure.error());
    c.preset = preset;
    c.view = view;
    auto draw = job(Stage::draw, name, c, {*simulate, *measure});
    if (!draw) return std::unexpected(draw.error());
    c.sheet = plan_.spec.sheet;
    auto verify = job(Stage::verify, name, c, {*measure, *draw});
    if (!verify) return std::unexpected(verify.error());
    plan_.clips.push_back({name, {*bake, *simulate, *measure, *draw, *verify}});
    return {};
  }

  /// Index of the job, made when it is asked for the first time.
  Result<int> job(Stage stage, const std::string& of, const Choice& choice,
                  std::vector<int> needs) {
    PlannedJob planned;
    planned.job.stage = stage;
    planned.job.name = fmt::format("{} {}", name(stage), of);
    if (const auto at = byName_.find(planned.job.name); at != byName_.end()) return at->second;
    planned.job.choice = choice;
    for (const int k : needs) planned.job.needs.push_back(plan_.jobs[k].job.key);
    planned.needs = std::move(needs);
    if (auto cooked = cook(planned.job, inputs_); !cooked) return std::unexpected(cooked.error());
    const int index = static_cast<int>(plan_.jobs.size());
    byName_[planned.job.name] = index;
    plan_.jobs.push_back(std::move(planned));
    return index;
  }

  Result<double> framesPerSecond(const std::string& preset) {
    if (const auto at = fps_.find(preset); at != fps_.end()) return at->second;
    auto loaded = scene::loadPreset(options_.presetsFolder(), preset);
    if (!loaded) return std::unexpected(loaded.error());
    return fps_[preset] = loaded->fps;
  }

  const pipeline::RunOptions& options_;
  Plan plan_;
  Inputs inputs_;
  std::map<std::string, int> byName_;
  std::map<std::string, double> fps_;
};
}  // namespace

Result<Plan> makePlan(const SpecDef& spec, const pipeline::RunOptions& options) {
  return Builder(spec, options).build();
}

int Plan::staleCount() const {
  return static_cast<int>(std::ranges::count_if(jobs, &PlannedJob::stale));
}

std::vector<int> Plan::order() const {
  std::vector<int> indices(jobs.size());
  std::iota(indices.begin(), indices.end(), 0);
  std::erase_if(indices, [&](int k) { return !jobs[k].stale(); });
  std::ranges::stable_sort(indices, [&](int a, int b) { return jobs[a].path_s > jobs[b].path_s; });
  return indices;
}

void lookUp(Plan& plan, Store& store, const Memory& memory, bool repair) {
  for (PlannedJob& p : plan.jobs) {
    Store::State state = store.check(p.job.key, repair);
    p.marker = std::move(state.marker);
    const std::string changes = p.stale() ? memory.changes(p.job) : "";
    p.why = changes.empty() ? state.why : changes;
    p.cost_s = memory.cost_s(p.job);
    p.path_s = p.cost_s;
  }
  for (auto p = plan.jobs.rbegin(); p != plan.jobs.rend(); ++p)
    for (const int k : p->needs)
      plan.jobs[k].path_s = std::max(plan.jobs[k].path_s, plan.jobs[k].cost_s + p->path_s);
}

std::string planText(const Plan& plan) {
  std::string text;
  double cost_s = 0;
  std::map<Stage, std::pair<int, int>> counts;  // stage -> stale, all
  for (const PlannedJob& p : plan.jobs) {
    std::vector<std::string> needs;
    for (const int k : p.needs) needs.push_back(plan.jobs[k].job.name);
    text += fmt::format(
        "{}  {}{}\n    {}\n", p.job.key, p.job.name,
        needs.empty() ? "" : fmt::format("  <- {}", fmt::join(needs, ", ")),
        p.stale() ? fmt::format("stale: {} (about {:.3g} s)", p.why, p.cost_s) : "done");
    counts[p.job.stage].second++;
    if (!p.stale()) continue;
    counts[p.job.stage].first++;
    cost_s += p.cost_s;
  }
  for (const auto& [stage, n] : counts)
    text += fmt::format("{:9} {} of {} to do\n", name(stage), n.first, n.second);
  return text + fmt::format(
                    "{} clips; {} of {} jobs to do, about {:.0f} s of processor time; then "
                    "publish\n",
                    plan.clips.size(), plan.staleCount(), plan.jobs.size(), cost_s);
}
}  // namespace swallowclip::library
