// SPDX-License-Identifier: MIT
// Where the bolus is when it matters: components 2 (held until the tongue moves) and 6 (where the
// head is when the hyoid sets off).
#pragma once
#include "frame/history.h"
#include "scoring/decision.h"

namespace swallowclip::scoring {

struct Component2Measures {
  double beside = 0;  ///< a: share of V0 in the lateral sulci and the floor of the mouth
  double past = 0;    ///< p: share past the ramus
};
std::optional<int> scoreComponent2(const Component2Measures& m, const ScoringRules& rules);
ComponentReport measureComponent2(const frame::History& history, const MeasuredEvent& onset,
                                  const ScoringRules& rules);

/// [frame] s of the bolus head: beyond it lies the head's share of V0; NaN without bolus.
std::vector<double> bolusHead_m(const frame::BolusTrack& bolus, const ScoringRules& rules);
/// [frame] mean s of what is not swallowed; NaN once all is.
std::vector<double> bolusCentroid_m(const frame::BolusTrack& bolus);

/// `head_m` empty: no burst in the time waited for.
std::optional<int> scoreComponent6(std::optional<double> head_m, const ScoringRules& rules);
ComponentReport measureComponent6(const frame::History& history, const MeasuredEvent& hyb,
                                  const ScoringRules& rules);
}  // namespace swallowclip::scoring
