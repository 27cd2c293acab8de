// SPDX-License-Identifier: MIT
#include "scoring/component14.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scoring/clearance.h"
#include "scoring/events.h"

namespace swallowclip::scoring {
using frame::History;

std::optional<int> scoreComponent14(const Component14Measures& m, const ScoringRules& r) {
  const double held = m.obstructed.value_or(0);
  const bool nothingPasses = !m.obstructed || held > r.heldUpAll;
  if (m.diameter < r.uesNone && nothingPasses) return 3;
  if (m.diameter < r.uesNarrow || m.openTime < r.uesBrief || held >= r.heldUpMuch) return 2;
  if (m.diameter < r.uesFull || m.openTime < r.uesLong || held >= r.heldUpSome) return 1;
  return 0;
}

ComponentReport measureComponent14(const History& h, const std::vector<double>& ues_m,
                                   const std::vector<MeasuredEvent>& events,
                                   const ScoringRules& rules) {
  ComponentReport out;
  // A larger bolus opens it wider; without one, as for the volume that the rules name.
  const double offered_m3 =
      hasBolus(h) ? h.bolus.s_m.front().size() * h.bolus.particleVolume_m3 : 0;
  const double normal_m =
      rules.normalUes_m *
      (offered_m3 > 0 ? std::pow(offered_m3 / rules.uesVolume_m3, rules.uesGrowth) : 1.0);
  const std::string lack = "the skin has no midline at the UES";
  Quantity width{
      "ues_diameter_ratio",
      {},
      "ratio",
      -1,
      fmt::format("d: largest AP width at the narrowest UES level over {:.3g} mm", normal_m * 1e3),
      lack};
  Quantity open{
      "ues_open_ratio",
      {},
      "ratio",
      -1,
      fmt::format("T: time from UESO to UESC (or to the end) over {:g} s", rules.normalUesOpen_s),
      lack};
  Quantity held{"ues_held_up",
                {},
                "share",
                -1,
                "O: 1 - what has passed the UES over what has entered the hypopharynx, by UESC",
                "the history has no bolus"};
  out.decision.reason = "UES opening: " + lack;
  if (!ues_m.empty()) {
    const int rest = cueFrame(h);
    const MeasuredEvent *ueso = nullptr, *uesc = nullptr;
    for (const auto& e : events) {
      if (e.name == "UESO" && e.time_s) ueso = &e;
      if (e.name == "UESC" && e.time_s) uesc = &e;
    }
    const int widest =
        static_cast<int>(std::max_element(ues_m.begin() + rest, ues_m.end()) - ues_m.begin());
    const int end = uesc ? uesc->frame : h.frames() - 1;
    Component14Measures m;
    m.diameter = ues_m[widest] / normal_m;
    if (ueso) m.openTime = (h.time_s[end] - *ueso->time_s) / rules.normalUesOpen_s;
    set(width, m.diameter, widest), set(open, m.openTime, end);
    if (hasBolus(h)) {
      const double entered = shareBeyond(h.bolus, rules.headRim_m)[end];
      held.reason = "nothing has entered the hypopharynx";
      if (entered >= rules.headShare) {
        m.obstructed = 1 - shareBeyond(h.bolus, rules.uesEnd_m)[end] / entered;
        set(held, *m.obstructed, end);
      }
    }
    out.decision = decide([&](const ScoringRules& r) { return scoreComponent14(m, r); }, rules,
                          fmt::format("d {:.2f}, T {:.2f}, O {}", m.diameter, m.openTime,
                                      m.obstructed ? fmt::format("{:.2f}", *m.obstructed) : "-"));
    out.frame = widest;
  }
  out.quantities = {width, open, held};
  out.liveSeries = "ues_gap";
  return out;
}
}  // namespace swallowclip::scoring
