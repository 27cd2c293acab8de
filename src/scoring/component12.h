// SPDX-License-Identifier: MIT
// Component 12, pharyngeal stripping wave: how far the back wall comes forward at the levels of C2,
// C3 and C4, and whether the crests run downwards in time.
#pragma once
#include <array>

#include "frame/history.h"
#include "scoring/decision.h"

namespace swallowclip::scoring {

inline constexpr int kWallLevels = 3;

struct Component12Measures {
  std::array<double, kWallLevels> excursion{};  ///< over normal, C2 C3 C4
  std::optional<double> crest_ms;               ///< C2 to C4; empty when not downwards
};
std::optional<int> scoreComponent12(const Component12Measures& m, const ScoringRules& rules);

ComponentReport measureComponent12(const frame::History& history, const ScoringRules& rules);
}  // namespace swallowclip::scoring
