// SPDX-License-Identifier: MIT
#include "scoring/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

/// How far the deciding quantity is from the nearest cut, in percent of it.
std::string marginCell(const Metrics& m, int component) {
  const auto margin = m.margins.find(component);
  return margin == m.margins.end() ? "" : fmt::format("{:.0f} %", 100 * margin->second);
}

std::string cutsCell(const Quantity& q) {
  std::string out;
  for (double cut : q.cuts) out += fmt::format("{}{:g}", out.empty() ? "" : " ", cut);
  return out;
}

void addScores(const Metrics& m, std::string& out) {
  auto to = std::back_inserter(out);
  if (m.score >= 0) fmt::format_to(to, "Intended: component {}, score {}\n", m.component, m.score);
  const char* label = !m.labelConfirmed   ? "not judged"
                      : *m.labelConfirmed ? "confirmed"
                                          : "NOT confirmed";
  fmt::format_to(to, "Label: {} ({})\n\nComponent  Score  Margin\n", label, m.labelReason);
  for (const auto& [component, score] : m.scores) {
    const auto unsure = m.ambiguous.find(component);
    const auto why = m.reasons.find(component);
    fmt::format_to(to, "{:>9}  {:<5} {:>7}  {}{}\n", component,
                   score ? fmt::format("{}", *score) : "-", marginCell(m, component),
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
  if (c.coating_m3) fmt::format_to(to, "Coating on the walls: {:.3f} mL\n", *c.coating_m3 * 1e6);
  fmt::format_to(
      to, "Ledger (fluid, film, swallowed, coating): within {:.1e} of the start in every frame\n",
      std::abs(c.volumeError));
  fmt::format_to(
      to,
      "Density error: mean {:.3f} %, largest {:.2f} %, above 10 % in {:.4f} % of particle-steps; "
      "velocity clamps: {}\n",
      100 * c.meanDensityError, 100 * c.maxDensityError, 100 * c.shareAboveTenPercent,
      c.velocityClamps);
}
}  // namespace

void set(Quantity& q, double value, int frame) {
  if (!std::isfinite(value)) return;
  q.value = value, q.frame = frame, q.reason.clear();
}

Series inMillimetres(std::string name, const std::vector<double>& values_m) {
  Series s{std::move(name), "mm", values_m};
  for (double& v : s.values) v *= 1e3;
  return s;
}

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
  fmt::format_to(to, "\n{:<26} {:>9} {:<6} {:>6} {:<19} {}\n", "Quantity", "value", "unit", "frame",
                 "cuts", "rule");
  for (const auto& q : m.quantities)
    fmt::format_to(to, "{:<26} {:>9} {:<6} {:>6} {:<19} {}\n", q.name, cell(q.value), q.unit,
                   cell(q.frame), cutsCell(q), note(q.rule, q.reason));
  if (m.conservation) addConservation(*m.conservation, out);
  return out;
}
}  // namespace swallowclip::scoring
