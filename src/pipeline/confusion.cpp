// SPDX-License-Identifier: MIT
#include "pipeline/confusion.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "pipeline/components.h"
#include "pipeline/confirm.h"
#include "pipeline/interrupt.h"
#include "pipeline/pipeline.h"
#include "pipeline/simulation.h"

namespace swallowclip::pipeline {
namespace {
constexpr int kHighestScore = 4;

std::string cell(int count) {
  return count == 0 ? "." : fmt::format("{}", count);
}

std::string matrixText(int component, const std::vector<Judged>& swallows) {
  int highest = 0;
  for (const Judged& j : swallows)
    if (j.component == component) highest = std::max({highest, j.intended, j.measured.value_or(0)});
  const Component* known = findComponent(component);
  std::string text =
      fmt::format("Component {}, {}\n\n| intended |", component, known ? known->title : "unknown");
  for (int s = 0; s <= highest; ++s) text += fmt::format(" {} |", s);
  text += " none |\n| --- |";
  for (int s = 0; s <= highest + 1; ++s) text += " --- |";
  text += "\n";
  for (int intended = 0; intended <= highest; ++intended) {
    std::vector<int> count(highest + 2, 0);
    for (const Judged& j : swallows)
      if (j.component == component && j.intended == intended)
        ++count[j.measured.value_or(highest + 1)];
    text += fmt::format("| {} |", intended);
    for (int n : count) text += fmt::format(" {} |", cell(n));
    text += "\n";
  }
  return text + "\n";
}

/// Boluses by which a component is judged: 13 with nectar and pudding as in the clinic
/// (clinical-reference section 3), the others with a thin and a thick one.
std::vector<std::string> bolusesOf(int component) {
  if (component == 13) return {"nectar", "pudding"};
  return {"thin", "honey"};
}

Judged judge(RunOptions o, int score, Progress& progress) {
  Judged j{o.component, score, o.bolus, {}, {}, false, ""};
  constexpr double kFramesPerSecond = 30;
  auto history = simulateSwallow(o, score, kFramesPerSecond, progress);
  if (!history) {
    j.reason = history.error().problem;
    return j;
  }
  auto metrics = measureHistory(o.scenesFolder(), *history);
  if (!metrics) {
    j.reason = metrics.error().problem;
    return j;
  }
  const auto measured = metrics->scores.find(o.component);
  if (measured != metrics->scores.end()) j.measured = measured->second;
  const auto margin = metrics->margins.find(o.component);
  if (margin != metrics->margins.end()) j.margin = margin->second;
  const auto reason = metrics->reasons.find(o.component);
  if (reason != metrics->reasons.end()) j.reason = reason->second;
  j.confirmed = confirm(history->meta, *metrics).publish;
  return j;
}
}  // namespace

std::vector<int> builtInScores(const std::filesystem::path& scenesFolder, int component) {
  std::vector<int> scores;
  std::error_code ec;
  for (int score = 0; score <= kHighestScore; ++score)
    if (std::filesystem::exists(
            scenesFolder / "swallows" / fmt::format("c{:02}-s{}.json", component, score), ec))
      scores.push_back(score);
  return scores;
}

std::string confusionText(const std::vector<Judged>& swallows) {
  std::set<int> components;
  for (const Judged& j : swallows) components.insert(j.component);
  std::string text;
  for (int c : components) text += matrixText(c, swallows);
  text +=
      "| component | intended | bolus | measured | nearest cut | confirmed | decided by |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n";
  for (const Judged& j : swallows)
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", j.component, j.intended, j.bolus,
                        j.measured ? fmt::format("{}", *j.measured) : "none",
                        j.margin ? fmt::format("{:.0f} %", *j.margin * 100) : "-",
                        j.confirmed ? "yes" : "no", j.reason);
  return text;
}

Result<void> confusion(const RunOptions& options, Progress& progress) {
  std::vector<Judged> swallows;
  for (const Component& c : components()) {
    if (options.component != 0 && options.component != c.number) continue;
    RunOptions o = options;
    o.component = c.number;
    const std::vector<int> scores = builtInScores(o.scenesFolder(), c.number);
    if (scores.empty() && options.component != 0)
      return usageError("--component", fmt::format("component {} has no swallow files", c.number),
                        "Components 4, 5, 8, 13 and 15 have.");
    for (int score : scores)
      for (const std::string& bolus : bolusesOf(c.number)) {
        if (interrupted()) return std::unexpected(interruptedError());
        o.bolus = bolus;
        progress.stage(fmt::format("component {}, score {}, {}", c.number, score, bolus));
        swallows.push_back(judge(o, score, progress));
      }
  }
  progress.print(confusionText(swallows));
  const auto lost =
      std::count_if(swallows.begin(), swallows.end(), [](const Judged& j) { return !j.confirmed; });
  if (lost == 0) return {};
  return failure("confusion",
                 fmt::format("{} of {} swallows are not confirmed", lost, swallows.size()),
                 "The table says why.");
}
}  // namespace swallowclip::pipeline
