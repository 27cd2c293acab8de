// SPDX-License-Identifier: MIT
// Component 14, pharyngoesophageal segment opening: how wide, how long, and what is held up.
#pragma once
#include "frame/history.h"
#include "scoring/decision.h"

namespace swallowclip::scoring {

struct Component14Measures {
  double diameter = 0;               ///< d: largest AP width over normal
  double openTime = 0;               ///< T: over normal
  std::optional<double> obstructed;  ///< O; empty without bolus
};
std::optional<int> scoreComponent14(const Component14Measures& m, const ScoringRules& rules);

/// `ues_m` [frame]: gap at the narrowest level; `events` as measured.
ComponentReport measureComponent14(const frame::History& history, const std::vector<double>& ues_m,
                                   const std::vector<MeasuredEvent>& events,
                                   const ScoringRules& rules);
}  // namespace swallowclip::scoring
