// SPDX-License-Identifier: MIT
// Component 8, laryngeal elevation: how far thyroid and arytenoids have come at the moment at which
// the epiglottis lies most nearly level.
#pragma once
#include <optional>

#include "frame/history.h"
#include "scoring/decision.h"
#include "scoring/lumen.h"

namespace swallowclip::scoring {

/// The frame that is judged, and the normal rise at that moment.
struct ElevationMoment {
  int frame = -1;
  double normalRise_m = 0;
  const char* rule = "";
};
/// `angle` [frame] of the epiglottis; `hyb` the frame of the hyoid burst.
ElevationMoment elevationMoment(const frame::History& history, const std::vector<double>& angle_rad,
                                std::optional<int> hyb, const ScoringRules& rules);

struct Component8Measures {
  double rise = 0;                  ///< L
  std::optional<double> vestibule;  ///< G
};
std::optional<int> scoreComponent8(const Component8Measures& m, const ScoringRules& rules);

ComponentReport measureComponent8(const frame::History& history, const LumenProfile& lumen,
                                  const MeasuredEvent& hyb, const ScoringRules& rules);
}  // namespace swallowclip::scoring
