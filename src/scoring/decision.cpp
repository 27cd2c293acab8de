// SPDX-License-Identifier: MIT
#include "scoring/decision.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace swallowclip::scoring {
namespace {
constexpr double kFarthest = 8;    // a cut is moved to at most this multiple of itself
constexpr double kNearest = 1e-9;  // and down to next to nothing
constexpr int kHalvings = 40;

/// Smallest share of the cut by which it must move for the score to change; empty when it need not.
std::optional<double> moveOf(const Judge& judge, const ScoringRules& rules, const RuleField& field,
                             std::optional<int> score, double farthest) {
  ScoringRules moved = rules;
  const auto changes = [&](double factor) {
    moved.*field.member = rules.*field.member * factor;
    return judge(moved) != score;
  };
  if (!changes(farthest)) return std::nullopt;
  double same = 1, other = farthest;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (same + other);
    (changes(middle) ? other : same) = middle;
  }
  return std::abs(other - 1);
}
}  // namespace

Decision decide(const Judge& judge, const ScoringRules& rules, std::string reason) {
  Decision d{judge(rules), false, std::move(reason), {}, {}};
  if (!d.score) return d;
  for (const RuleField& field : ruleFields()) {
    if (!field.quantities) continue;
    // A cut stays inside its own range: no cut of a share can exclude all of it.
    const double most = field.max * field.scale / (rules.*field.member) * (1 - kNearest);
    for (const double farthest : {kNearest, std::clamp(most, 1.0, kFarthest)}) {
      const auto move = moveOf(judge, rules, field, d.score, farthest);
      if (!move || (d.margin && *d.margin <= *move)) continue;
      d.margin = move;
      d.cut = fmt::format("{}.{}", field.section, field.key);
    }
  }
  d.ambiguous = d.margin && *d.margin < rules.ambiguousMargin;
  return d;
}
}  // namespace swallowclip::scoring
