// SPDX-License-Identifier: MIT
// Events that a swallow file plans (ASPEKT names); what really happens is measured by scoring.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "kinematics/swallow_def.h"

namespace swallowclip::kinematics {
/// (name, time after the cue in s), in order of time; only those the swallow really has.
std::vector<std::pair<std::string, double>> plannedEvents(const SwallowDef& swallow);
}  // namespace swallowclip::kinematics
