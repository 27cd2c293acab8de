// SPDX-License-Identifier: MIT
// Penetration-aspiration scale (Rosenbek 1996): the deepest level that the bolus reaches in the
// airway, and whether it is out again at the end.
#pragma once
#include <optional>
#include <string>

#include "frame/history.h"
#include "scoring/metrics.h"
#include "scoring/rules.h"

namespace swallowclip::scoring {

enum class AirwayDepth { none, aboveFolds, atFolds, belowFolds };

/// 1 to 8. No cough or throat clearing is modelled, so 7 is never given.
int penetrationAspiration(AirwayDepth deepest, bool cleared, bool clearedBelowFolds);

/// pas, airway_depth, airway_most, airway_at_end; empty values without bolus.
std::vector<Quantity> measureAirway(const frame::History& history, const ScoringRules& rules);
}  // namespace swallowclip::scoring
