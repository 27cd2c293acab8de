// SPDX-License-Identifier: MIT
// The promise as one table: every built-in score simulated with the boluses of its component, what
// was intended against what was measured.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace swallowclip::pipeline {

/// One simulated swallow and what became of its label.
struct Judged {
  int component = 0, intended = 0;
  std::string bolus;
  std::optional<int> measured;   ///< empty: could not be scored, or the simulation failed
  std::optional<double> margin;  ///< share of the nearest cut; empty: no cut is near
  bool confirmed = false;
  std::string reason;  ///< the deciding quantities, or why there is no score
};

/// Scores that have a swallow file, ascending.
std::vector<int> builtInScores(const std::filesystem::path& scenesFolder, int component);

/// Markdown: one matrix per component (rows intended, columns measured, numbers of swallows) and
/// the list of all swallows with the quantities that decided.
std::string confusionText(const std::vector<Judged>& swallows);
}  // namespace swallowclip::pipeline
