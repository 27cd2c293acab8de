// SPDX-License-Identifier: MIT
// MBSImP component 4, bolus transport / lingual motion: measures and decision of
// clinical-reference.md section 3. Works with and without bolus.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "frame/history.h"
#include "scoring/decision.h"
#include "scoring/lumen.h"
#include "scoring/metrics.h"
#include "scoring/rules.h"

namespace swallowclip::scoring {

/// [frame] s_f: rear end of the continuous tongue contact (midline gap < contactGap) that starts
/// at the ridge, interpolated between stations; the first tongue station's s when there is none.
/// The rear seal of the holding pose (frame `rest`) is no part of it before it has opened once:
/// the wave that reaches a seal still shut has not swept what lies behind it.
/// Empty when the skin has no tongue midline.
std::vector<double> contactFront_m(const LumenProfile& lumen, int rest, const ScoringRules& rules);

/// [frame] dorsal high point: the s at which the tongue's midline has risen most towards the roof
/// since frame `rest` (its gap has become smaller by most; against the roof and not in z, since the
/// velum takes the tongue along), the mean s of the stations next to the highest that share its
/// rise within dorsalTie. Where no station has risen by dorsalMinRise the tongue is in its holding
/// shape, highest behind the ridge: then `front` (the contact front) stands for it.
std::vector<double> dorsalHighPoint_m(const LumenProfile& lumen, int rest,
                                      std::span<const double> front, const ScoringRules& rules);

/// [frame] s_c: mean s of the particles still before the ramus; NaN where there are none.
std::vector<double> oralCentroid_m(const frame::BolusTrack& bolus, const ScoringRules& rules);

/// N: turning points of x (frames before `end`) between runs of at least `run`; one leading pair of
/// short, early runs is accommodation and dropped.
int countReversals(std::span<const double> time_s, std::span<const double> x, int end, double run,
                   const ScoringRules& rules);

/// What the decision rests on.
struct Component4Measures {
  std::optional<double> travel_m;  ///< larger of contact front's and dorsal high point's
  double waited_s = 0;             ///< history after the last cue
  std::optional<int> reversals;    ///< N
  bool reversalsUnsure = false;    ///< another run length (margin) would cross the cut
  std::optional<double> front_ms;  ///< v
  std::optional<double> delay_s;   ///< D_i
};

/// 4, 3, 2, 1, 0 in this order. No score where a measure that it needs is missing.
std::optional<int> scoreComponent4(const Component4Measures& m, const ScoringRules& rules);
/// With its reason; also ambiguous between slow and brisk, and where another run length would count
/// other reversals.
Decision decideComponent4(const Component4Measures& m, const ScoringRules& rules);

struct Component4Report : ComponentReport {
  Component4Measures measures;
  MeasuredEvent onset;  ///< tongue_onset
};

Component4Report measureComponent4(const frame::History& history, const LumenProfile& lumen,
                                   const MeasuredEvent& bpm, const ScoringRules& rules);
}  // namespace swallowclip::scoring
