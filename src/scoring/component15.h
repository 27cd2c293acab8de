// SPDX-License-Identifier: MIT
// Component 15, tongue base retraction: the AP gap between tongue base and posterior wall on the
// midline, at the frame of greatest retraction.
#pragma once
#include <optional>
#include <vector>

#include "frame/history.h"
#include "scoring/decision.h"
#include "scoring/metrics.h"

namespace swallowclip::scoring {

struct TongueBase {
  std::vector<double> gap_m;     ///< [frame] median over the height between C2 and C3
  std::vector<double> travel_m;  ///< [frame] median way back of the tongue base since rest
};

/// Along level lines every millimetre of the height; NaN where fewer than 5 of them meet both
/// tongue and wall.
TongueBase measureTongueBase(const frame::History& history, int rest, const ScoringRules& rules);

struct Component15Measures {
  double gap_m = 0, ratio = 0, travelRatio = 0;
};
std::optional<int> scoreComponent15(const Component15Measures& m, const ScoringRules& rules);

ComponentReport measureComponent15(const frame::History& history, const ScoringRules& rules);
}  // namespace swallowclip::scoring
