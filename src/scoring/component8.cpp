// SPDX-License-Identifier: MIT
#include "scoring/component8.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scoring/events.h"
#include "scoring/spine.h"

namespace swallowclip::scoring {
using frame::History;

ElevationMoment elevationMoment(const History& h, const std::vector<double>& angle,
                                std::optional<int> hyb, const ScoringRules& rules) {
  const int rest = cueFrame(h);
  ElevationMoment level{-1, rules.normalRiseHorizontal_m, "epiglottis most nearly level"};
  ElevationMoment moved{-1, rules.normalRiseInverted_m, "epiglottis most moved (never level)"};
  if (!angle.empty()) {
    const auto off = [&](int f) { return std::abs(angle[f] - rules.horizontal_rad); };
    const auto by = [&](int f) { return std::abs(angle[f] - angle[rest]); };
    int mostMoved = rest, mostLevel = rest;
    for (int f = rest; f < h.frames(); ++f)
      if (by(f) > by(mostMoved)) mostMoved = f;
    // On the way over, not on the way back; where it stays, the first frame there counts.
    for (int f = rest; f <= mostMoved; ++f)
      if (off(f) < off(mostLevel)) mostLevel = f;
    level.frame = moved.frame = rest;
    while (off(level.frame) > off(mostLevel) + rules.epiglottisTie_rad) ++level.frame;
    while (by(moved.frame) < by(mostMoved) - rules.epiglottisTie_rad) ++moved.frame;
    if (off(mostLevel) <= rules.horizontalWithin_rad) return level;
    if (by(mostMoved) >= rules.epiglottisMoves_rad) return moved;
  }
  if (!hyb) return {};
  return {frameAt(h, h.time_s[*hyb] + rules.onsetAfter_s), rules.normalRiseOnset_m,
          "just after the first hyoid motion (the epiglottis does not move)"};
}

std::optional<int> scoreComponent8(const Component8Measures& m, const ScoringRules& r) {
  if (m.rise < r.riseNone) return 3;
  const double gap = m.vestibule.value_or(0);
  if (m.rise < r.riseHalf || gap > r.vestibuleHalf) return 2;
  if (m.rise < r.riseFull || gap > r.vestibuleShut) return 1;
  return 0;
}

ComponentReport measureComponent8(const History& h, const LumenProfile& lumen,
                                  const MeasuredEvent& hyb, const ScoringRules& rules) {
  ComponentReport out;
  const int rest = cueFrame(h);
  const Displacement thyroid = displacementOf(h, "thyroid_notch", "thyroid", rest);
  const std::vector<double> angle = epiglottisAngle_rad(h);
  const std::vector<double> gap = petioleGap_m(h, lumen);
  const ElevationMoment at =
      elevationMoment(h, angle, hyb.time_s ? std::optional(hyb.frame) : std::nullopt, rules);
  Quantity rise{"larynx_rise_ratio",
                {},
                "ratio",
                -1,
                "",
                "no frame to judge: no epiglottis landmarks, and no hyoid burst",
                {}};
  Quantity width{"vestibule_ratio_at_score", {}, "ratio", -1, "", rise.reason, {}};
  Component8Measures m;
  if (thyroid.superior_m.empty()) {
    rise.reason = "no landmark thyroid_notch and no rigid structure thyroid";
  } else if (at.frame >= 0) {
    m.rise = thyroid.superior_m[at.frame] / at.normalRise_m;
    set(rise, m.rise, at.frame);
  }
  rise.rule = fmt::format("L: rise of the thyroid since the cue over {:.1f} mm, at the frame: {}",
                          at.normalRise_m * 1e3, at.rule);
  width.rule = fmt::format("G: arytenoid-petiole gap over its gap at the cue, at the same frame");
  if (gap.empty()) width.reason = "neither a laryngeal branch nor its landmarks";
  if (at.frame >= 0 && !gap.empty() && gap[rest] > 0) {
    m.vestibule = gap[at.frame] / gap[rest];
    set(width, *m.vestibule, at.frame);
  }
  if (rise.value)
    out.decision =
        decide([&](const ScoringRules& r) { return scoreComponent8(m, r); }, rules,
               fmt::format("L {:.2f}, G {:.2f}; {}", m.rise, m.vestibule.value_or(NAN), at.rule));
  else
    out.decision.reason = "laryngeal elevation: " + rise.reason;
  out.quantities = {rise, width};
  out.frame = at.frame;
  out.liveSeries = "larynx_superior";
  Series turn{"epiglottis_angle", "deg", angle};
  for (double& a : turn.values) a *= 180 / kPi;
  if (!angle.empty()) out.series.push_back(turn);
  if (!gap.empty()) out.series.push_back(inMillimetres("petiole_gap", gap));
  return out;
}
}  // namespace swallowclip::scoring
