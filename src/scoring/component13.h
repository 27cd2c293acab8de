// SPDX-License-Identifier: MIT
// Component 13, pharyngeal contraction, seen from the front: the half-widths of the open lumen left
// and right of the midline, level by level of the pharyngeal wall (material levels: they rise with
// the shortening pharynx), and the shortening itself.
#pragma once
#include <optional>
#include <vector>

#include "frame/history.h"
#include "scoring/decision.h"

namespace swallowclip::scoring {

/// [level] outermost |x| at which the lumen is open by the visible chord; 0 where it is shut.
struct Outline {
  std::vector<double> left_m, right_m;
};

/// The side walls' levels of a skin.
class SideWalls {
 public:
  SideWalls(const frame::SkinTrack& skin, const ScoringRules& rules);
  const std::vector<double>& levels_m() const { return levels_m_; }  ///< s, rising
  Outline at(int frame) const;

 private:
  const frame::SkinTrack& skin_;
  double visible_m_;
  std::vector<double> levels_m_;
  std::vector<std::vector<int>> rows_;  ///< [level] vertices of the fixed sheet, u rising
  std::vector<Triangle> opposite_;
};

struct Component13Measures {
  double bulgeLeft = 0, bulgeRight = 0;  ///< B
  double residualWidth = 0;              ///< K
  double pouch_m = 0;
  double shortening = 0;  ///< ratio to normal
};
std::optional<int> scoreComponent13(const Component13Measures& m, const ScoringRules& rules);

/// Largest mean of w / rest - 1 over `height` of the levels.
double bulge(const std::vector<double>& levels_m, const std::vector<double>& width_m,
             const std::vector<double>& rest_m, double height_m);

/// Highest outward bump beyond the outline at rest that is no taller than the pouch height, over
/// the outline smoothed.
double pouchDepth_m(const std::vector<double>& levels_m, const std::vector<double>& width_m,
                    const std::vector<double>& rest_m, const ScoringRules& rules);

ComponentReport measureComponent13(const frame::History& history,
                                   const std::vector<MeasuredEvent>& events,
                                   const ScoringRules& rules);
}  // namespace swallowclip::scoring
