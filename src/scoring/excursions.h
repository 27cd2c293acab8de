// SPDX-License-Identifier: MIT
// How far hyoid, larynx and epiglottis travel: displacements in mm and as a share of C2-C4, and
// components 9 (anterior hyoid excursion) and 10 (epiglottic movement).
#pragma once
#include "frame/history.h"
#include "scoring/decision.h"

namespace swallowclip::scoring {

/// Largest anterior and superior displacements of hyoid and larynx since the cue.
struct Excursions {
  std::vector<Quantity> quantities;
  std::vector<Series> series;
};
Excursions measureExcursions(const frame::History& history);

/// 9: forward travel at the height of the swallow (largest hyoid displacement) over normal.
ComponentReport measureComponent9(const frame::History& history, const ScoringRules& rules);
std::optional<int> scoreComponent9(double ratio, const ScoringRules& rules);

/// 10: largest angle of the epiglottis.
ComponentReport measureComponent10(const frame::History& history, const ScoringRules& rules);
std::optional<int> scoreComponent10(double angle_rad, const ScoringRules& rules);
}  // namespace swallowclip::scoring
