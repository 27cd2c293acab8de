// SPDX-License-Identifier: MIT
// A score and how far it is from being another one. Every deciding quantity is compared with cuts
// of the rules; a cut is moved until the score changes, and the smallest move (as a share of the
// cut) is the margin. That is |quantity - cut| / cut of the quantity that decides, however many
// quantities and cuts a component has.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scoring/metrics.h"
#include "scoring/rules.h"

namespace swallowclip::scoring {

struct Decision {
  std::optional<int> score;
  bool ambiguous = false;
  std::string reason;
  std::optional<double> margin;  ///< share of the nearest cut; empty: no cut moves the score
  std::string cut;               ///< "component_15.base_moves_ratio": the nearest one
};

/// What a component's measuring yields.
struct ComponentReport {
  Decision decision;
  std::vector<Quantity> quantities;
  std::vector<Series> series;
  int frame = -1;          ///< at which it is judged
  std::string liveSeries;  ///< of all series, the one that shows what decides
};

/// A score from rules whose cuts may have been moved.
using Judge = std::function<std::optional<int>(const ScoringRules&)>;

/// The judged score with its margin; ambiguous below rules.ambiguousMargin.
Decision decide(const Judge& judge, const ScoringRules& rules, std::string reason);
}  // namespace swallowclip::scoring
