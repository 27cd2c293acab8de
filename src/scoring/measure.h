// SPDX-License-Identifier: MIT
// The room's front door: one finished history in, everything measured on it out. Pure: the same
// history and rules give the same metrics.
#pragma once
#include "core/error.h"
#include "frame/history.h"
#include "scoring/metrics.h"
#include "scoring/rules.h"

namespace swallowclip::scoring {

/// Fails only when the history cannot be measured at all (no frames, arrays that disagree, no
/// airway-skin midline); whatever else is missing leaves its quantity empty with a reason.
Result<Metrics> measure(const frame::History& history, const ScoringRules& rules);
}  // namespace swallowclip::scoring
