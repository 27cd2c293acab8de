// SPDX-License-Identifier: MIT
// Where every particle went: counts at the last frame of a history.
#pragma once
#include <optional>

#include "frame/history.h"
#include "scoring/metrics.h"

namespace swallowclip::scoring {

/// Empty when the history has no bolus. Without a ledger nothing counts as escaped.
std::optional<Conservation> countParticles(const frame::History& history);
}  // namespace swallowclip::scoring
