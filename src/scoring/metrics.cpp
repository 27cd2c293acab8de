// SPDX-License-Identifier: MIT
#include "scoring/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace swallowclip::scoring {
namespace {

template <class T>
const T* named(const std::vector<T>& list, std::string_view name) {
  const auto it =
      std::find_if(list.begin(), list.end(), [&](const T& x) { return x.name == name; });
  return it == list.end() ? nullptr : &*it;
}

std::string cell(const std::optional<double>& value) {
  return value ? fmt::format("{:.3f}", *value) : "-";
}

std::string cell(int frame) {
  return frame < 0 ? "" : fmt::format("{}", frame);
}

const std::string& note(const std::string& rule, const std::string& reason) {
  return reason.empty() ? rule : reason;
}

void addScores(const Metrics& m, std::string& out) {
  auto to = std::back_inserter(out);
  if (m.score >= 0) fmt::format_to(to, "Intended: component {}, score {}\n", m.component, m.score);
  const char* label = !m.labelConfirmed   ? "not judged"
                      : *m.labelConfirmed ? "confirmed"
                                          : "NOT confirmed";
  fmt::format_to(to, "Label: {} ({})\n\nComponent  Score\n", label, m.labelReason);
  for (const auto& [component, score] : m.scores) {
    const auto unsure = m.ambiguous.find(component);
    const auto why = m.reasons.find(component);
    fmt::format_to(to, "{:>9}  {:<5}  {}{}\n", component, score ? fmt::format("{}", *score) : "-",
                   why == m.reasons.end() ? "" : why->second,
                   unsure != m.ambiguous.end() && unsure->second ? " [ambiguous]" : "");
  }
}

void addConservation(const Conservation& c, std::string& out) {
  auto to = std::back_inserter(out);
  fmt::format_to(to, "\nParticles: {} at start, {} left, {} swallowed ({:.1f} %), {} escaped{}\n",
                 c.particlesStart, c.particlesEnd, c.swallowed, 100 * c.swallowedFraction,
                 c.escaped, c.balanced() ? "" : " - the counts do not add up");
  fmt::format_to(
      to, "Left in: mouth {}, pharynx {}, airway {}, nasopharynx {}, esophagus {}; film {:.1f} %\n",
      c.leftInOral, c.leftInPharynx, c.inAirway, c.inNasopharynx, c.inEsophagus,
      100 * c.filmFraction);
  fmt::format_to(to, "Density error: mean {:.2f} %, largest {:.2f} %\n", 100 * c.meanDensityError,
                 100 * c.maxDensityError);
}
}  // namespace

const Quantity* Metrics::quantity(std::string_view name) const {
  return named(quantities, name);
}
const MeasuredEvent* Metrics::event(std::string_view name) const {
  return named(events, name);
}
const Series* Metrics::find(std::string_view seriesName) const {
  return named(series, seriesName);
}

std::string formatTable(const Metrics& m) {
  std::string out;
  auto to = std::back_inserter(out);
  addScores(m, out);
  fmt::format_to(to, "\n{:<14} {:>9} {:>6}  {}\n", "Event", "time s", "frame", "rule");
  for (const auto& e : m.events)
    fmt::format_to(to, "{:<14} {:>9} {:>6}  {}\n", e.name, cell(e.time_s), cell(e.frame),
                   note(e.rule, e.reason));
  fmt::format_to(to, "\n{:<22} {:>9} {:<6} {:>6}  {}\n", "Quantity", "value", "unit", "frame",
                 "rule");
  for (const auto& q : m.quantities)
    fmt::format_to(to, "{:<22} {:>9} {:<6} {:>6}  {}\n", q.name, cell(q.value), q.unit,
                   cell(q.frame), note(q.rule, q.reason));
  if (m.conservation) addConservation(*m.conservation, out);
  return out;
}
}  // namespace swallowclip::scoring
