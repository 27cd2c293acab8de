// SPDX-License-Identifier: MIT
#include "scoring/bolus_head.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scoring/clearance.h"
#include "scoring/events.h"
#include "scoring/residue.h"

namespace swallowclip::scoring {
namespace {
using frame::History;
using frame::ParticleState;
constexpr const char* kNoBolus = "the history has no bolus";
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
}  // namespace

std::optional<int> scoreComponent2(const Component2Measures& m, const ScoringRules& r) {
  if (m.past > r.heldMostPast) return 3;
  if (m.past > r.heldPast) return 2;
  return m.beside > r.heldBeside ? 1 : 0;
}

ComponentReport measureComponent2(const History& h, const MeasuredEvent& onset,
                                  const ScoringRules& rules) {
  ComponentReport out;
  Quantity beside{"held_beside",
                  {},
                  "share",
                  -1,
                  "a: share of V0 in the lateral sulci and on the floor of the mouth just before "
                  "the tongue's onset",
                  kNoBolus};
  Quantity past{"held_past_ramus", {}, "share", -1, "p: share of V0 past the ramus at that frame",
                kNoBolus};
  out.decision.reason = std::string("tongue control: ") + kNoBolus;
  if (hasBolus(h)) {
    const int at = onset.time_s ? std::max(0, onset.frame - 1) : h.frames() - 1;
    const double offered = static_cast<double>(h.bolus.s_m[at].size()) * h.bolus.particleVolume_m3;
    Component2Measures m;
    m.past = shareBeyond(h.bolus, rules.ramus_m)[at];
    for (const Deposit& d : depositsAt(h, at, rules))
      if (d.location == Location::floorOfMouth || d.location == Location::sulcusLeft ||
          d.location == Location::sulcusRight)
        m.beside += offered > 0 ? d.volume_m3 / offered : 0;
    set(beside, m.beside, at), set(past, m.past, at);
    out.decision =
        decide([&](const ScoringRules& r) { return scoreComponent2(m, r); }, rules,
               fmt::format("{:.1f} % beside the tongue, {:.1f} % past the ramus{}", 100 * m.beside,
                           100 * m.past, onset.time_s ? "" : " when the history ends (no onset)"));
    out.frame = at;
  }
  out.quantities = {beside, past};
  out.liveSeries = "past_ramus";
  return out;
}

std::vector<double> bolusHead_m(const frame::BolusTrack& bolus, const ScoringRules& rules) {
  std::vector<double> out;
  for (const auto& s : bolus.s_m) {
    if (s.empty()) return {};
    std::vector<float> order(s);
    // The share itself lies at or beyond the head, so that it passes a station as BPM is judged.
    const auto k = static_cast<std::size_t>(std::ceil(rules.headShare * order.size() - 1e-9));
    const auto at = order.begin() + (std::max<std::size_t>(k, 1) - 1);
    std::nth_element(order.begin(), at, order.end(), std::greater<>());
    out.push_back(*at);
  }
  return out;
}

std::vector<double> bolusCentroid_m(const frame::BolusTrack& bolus, const ScoringRules& rules) {
  std::vector<double> out;
  for (std::size_t f = 0; f < bolus.s_m.size(); ++f) {
    double sum = 0;
    int n = 0;
    for (std::size_t k = 0; k < bolus.s_m[f].size(); ++k)
      if (isThere(bolus.state[f][k])) sum += bolus.s_m[f][k], ++n;
    const auto least = rules.headShare * static_cast<double>(bolus.s_m[f].size());
    out.push_back(n > 0 && n >= least ? sum / n : kNaN);
  }
  return out;
}

std::optional<int> scoreComponent6(std::optional<double> head_m, const ScoringRules& r) {
  if (!head_m) return 4;
  if (*head_m <= r.headOral_m) return 0;
  if (*head_m <= r.headVallecula_m) return 1;
  return *head_m <= r.headRim_m ? 2 : 3;
}

ComponentReport measureComponent6(const History& h, const MeasuredEvent& hyb,
                                  const ScoringRules& rules) {
  ComponentReport out;
  Quantity head{"bolus_head_at_hyb",
                {},
                "mm",
                -1,
                fmt::format("s beyond which {:g} % of V0 lies at HYB", 100 * rules.headShare),
                kNoBolus};
  out.decision.reason = std::string("initiation: ") + kNoBolus;
  const double waited_s = h.time_s.back() - h.meta.cue_s;
  if (hasBolus(h)) {
    head.reason = "no hyoid burst";
    std::optional<double> at_m;
    if (hyb.time_s) at_m = bolusHead_m(h.bolus, rules)[hyb.frame];
    if (at_m) set(head, *at_m * 1e3, hyb.frame);
    if (at_m || waited_s >= rules.initiationWait_s - 1e-6) {
      out.decision = decide(
          [&](const ScoringRules& r) { return scoreComponent6(at_m, r); }, rules,
          at_m ? fmt::format("bolus head at s = {:.0f} mm at HYB", *at_m * 1e3) : "no hyoid burst");
      out.frame = hyb.frame;
    } else {
      out.decision.reason = fmt::format(
          "initiation: no hyoid burst, but the history ends {:.1f} s "
          "after the cue; score 4 needs {:g} s",
          waited_s, rules.initiationWait_s);
    }
  }
  out.quantities = {head};
  out.liveSeries = "bolus_head";
  return out;
}
}  // namespace swallowclip::scoring
