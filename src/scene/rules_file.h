// SPDX-License-Identifier: MIT
// scenes/scoring_rules.json -> scoring::ScoringRules. Every number must be there and in range, none
// may be unknown: a rule that nobody sees is no rule.
#pragma once
#include <filesystem>

#include "core/error.h"
#include "scoring/rules.h"

namespace swallowclip::scene {

Result<scoring::ScoringRules> loadScoringRules(const std::filesystem::path& file);

/// The file's place in a scenes folder.
std::filesystem::path scoringRulesFile(const std::filesystem::path& scenesFolder);
}  // namespace swallowclip::scene
