// SPDX-License-Identifier: MIT
#include "pipeline/compare.h"

#include <cmath>
#include <iterator>
#include <limits>

#include "frame/history_file.h"
#include "pipeline/confirm.h"

namespace swallowclip::pipeline {
namespace {
constexpr Outcome kOutcomes[] = {
    {"swallowed", "swallowed", "%", 100},
    {"t50_past_ramus", "half past the ramus", "s", 1},
    {"pharyngeal_transit", "pharyngeal transit", "s", 1},
    {"oral_residue", "oral residue", "%", 100},
    {"pharyngeal_residue", "pharyngeal residue", "%", 100},
    {"pas", "PAS", "", 1},
    {"airway_most", "most in the airway", "mL", 1},
    {"airway_at_end", "left in the airway", "mL", 1},
    {"time_to_lvc", "hyoid burst to vestibule closed", "s", 1},
};

std::string cell(double value) {
  return std::isfinite(value) ? fmt::format("{:.3f}", value) : "-";
}
}  // namespace

std::span<const Outcome> outcomes() {
  return kOutcomes;
}

double outcome(const scoring::Metrics& m, const Outcome& which) {
  const auto* q = m.quantity(which.quantity);
  return q && q->value ? *q->value * which.scale : std::numeric_limits<double>::quiet_NaN();
}

std::string changesTable(const scoring::Metrics& before, const scoring::Metrics& after) {
  std::string out;
  auto to = std::back_inserter(out);
  fmt::format_to(to, "{:<34} {:>10} {:>10} {:>10}\n", "What changes", "unchanged", "changed",
                 "difference");
  for (const Outcome& o : kOutcomes) {
    const double a = outcome(before, o), b = outcome(after, o);
    const std::string title = *o.unit ? fmt::format("{} ({})", o.title, o.unit) : o.title;
    fmt::format_to(to, "{:<34} {:>10} {:>10} {:>10}\n", title, cell(a), cell(b), cell(b - a));
  }
  for (const auto& [component, score] : after.scores) {
    const auto was = before.scores.find(component);
    if (was == before.scores.end() || was->second == score) continue;
    const auto word = [](const std::optional<int>& s) {
      return s ? fmt::format("{}", *s) : std::string("-");
    };
    fmt::format_to(to, "{:<34} {:>10} {:>10}\n", fmt::format("component {}, score", component),
                   word(was->second), word(score));
  }
  return out;
}

Result<void> reportChanges(const RunOptions& o, const frame::History& changed, Progress& progress) {
  if (o.compare.empty()) return {};
  auto unchanged = frame::loadHistory(o.compare);
  if (!unchanged) return std::unexpected(unchanged.error());
  if (unchanged->meta.bolus != changed.meta.bolus)
    progress.note(fmt::format("{} holds another bolus ({} instead of {})", o.compare.string(),
                              unchanged->meta.bolus, changed.meta.bolus));
  auto before = measureHistory(o.scenesFolder(), *unchanged);
  if (!before) return std::unexpected(before.error());
  auto after = measureHistory(o.scenesFolder(), changed);
  if (!after) return std::unexpected(after.error());
  progress.print(changesTable(*before, *after));
  return {};
}
}  // namespace swallowclip::pipeline
