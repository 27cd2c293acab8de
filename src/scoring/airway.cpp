// SPDX-License-Identifier: MIT
#include "scoring/airway.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "scoring/clearance.h"
#include "scoring/spine.h"

namespace swallowclip::scoring {
namespace {
using frame::History;
using frame::Region;

/// Particles in the airway: all, and those at or below the folds, and below them.
struct Inside {
  int all = 0, atFolds = 0, below = 0;
};

/// Height of the vocal folds: of the vocal processes.
std::optional<double> folds_m(const History& h, int frame, const Spine& spine) {
  const auto *left = wholeLandmark(h, "arytenoid_vocal_process_L"),
             *right = wholeLandmark(h, "arytenoid_vocal_process_R");
  if (!left || !right) return std::nullopt;
  return spine.height_m((0.5f * (left->positions[frame] + right->positions[frame])).cast<double>());
}

Inside insideAt(const History& h, int frame, const ScoringRules& rules) {
  Inside in;
  const Spine spine = spineAt(h, frame);
  const auto folds = folds_m(h, frame, spine);
  const auto& b = h.bolus;
  for (std::size_t k = 0; k < b.region[frame].size(); ++k) {
    if (b.region[frame][k] != Region::larynx || !isThere(b.state[frame][k])) continue;
    ++in.all;
    if (!folds) continue;
    const double above = spine.height_m(b.positions[frame][k].cast<double>()) - *folds;
    in.atFolds += above <= rules.foldsWithin_m;
    in.below += above < -rules.foldsWithin_m;
  }
  return in;
}
}  // namespace

int penetrationAspiration(AirwayDepth deepest, bool cleared, bool clearedBelowFolds) {
  switch (deepest) {
    case AirwayDepth::none:
      return 1;
    case AirwayDepth::aboveFolds:
      return cleared ? 2 : 3;
    case AirwayDepth::atFolds:
      return cleared ? 4 : 5;
    case AirwayDepth::belowFolds:
      break;
  }
  return clearedBelowFolds ? 6 : 8;
}

std::vector<Quantity> measureAirway(const History& h, const ScoringRules& rules) {
  const std::string lack = "the history has no bolus";
  Quantity pas{
      "pas",
      {},
      "",
      -1,
      fmt::format("penetration-aspiration scale: deepest level reached by {:g} particles or "
                  "more beyond the aryepiglottic rim, and whether any is left at the end; "
                  "no cough is modelled",
                  rules.leastParticles),
      lack};
  Quantity most{"airway_most", {}, "mL", -1, "most that is in the airway at any frame", lack};
  Quantity left{"airway_at_end", {}, "mL", -1, "in the airway at the last frame", lack};
  if (!hasBolus(h)) return {pas, most, left};
  const double ml = h.bolus.particleVolume_m3 * 1e6;
  AirwayDepth deepest = AirwayDepth::none;
  int at = -1, mostAll = 0, mostFrame = 0;
  const auto reach = [&](AirwayDepth depth, int particles, int frame) {
    if (particles < rules.leastParticles || depth <= deepest) return;
    deepest = depth, at = frame;
  };
  for (int f = 0; f < h.frames(); ++f) {
    const Inside in = insideAt(h, f, rules);
    if (in.all > mostAll) mostAll = in.all, mostFrame = f;
    reach(AirwayDepth::aboveFolds, in.all, f);
    reach(AirwayDepth::atFolds, in.atFolds, f);
    reach(AirwayDepth::belowFolds, in.below, f);
  }
  const int last = h.frames() - 1;
  const Inside end = insideAt(h, last, rules);
  set(pas, penetrationAspiration(deepest, end.all == 0, end.below == 0), at);
  set(most, mostAll * ml, mostFrame);
  set(left, end.all * ml, last);
  return {pas, most, left};
}
}  // namespace swallowclip::scoring
