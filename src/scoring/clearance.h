// SPDX-License-Identifier: MIT
// How the bolus passes along the path: shares of V0 (all particles of the track) beyond a station,
// and what is left where at the end.
#pragma once
#include <vector>

#include "frame/history.h"
#include "scoring/metrics.h"
#include "scoring/rules.h"

namespace swallowclip::scoring {

/// True when the history carries a bolus.
bool hasBolus(const frame::History& history);

/// [frame] share of V0 with s > s_m, swallowed ones included. Empty without bolus.
std::vector<double> shareBeyond(const frame::BolusTrack& bolus, double s_m);

/// t50 past the ramus, residue by region at the last frame (fluid and film), shares of V0.
std::vector<Quantity> measureClearance(const frame::History& history, const ScoringRules& rules);
}  // namespace swallowclip::scoring
