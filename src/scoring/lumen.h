// SPDX-License-Identifier: MIT
// The midline gap of the airway-skin, g(s,t): how wide the lumen is at u = 0, from the lower sheet
// (tongue, larynx, anterior esophagus) to the upper one (palate, velum, posterior wall, posterior
// esophagus). The sheets slide along each other (the larynx rises), so that a gap is a distance to
// the other sheet, wherever its tissue is, never the distance of two vertices of equal s.
#pragma once
#include <utility>
#include <vector>

#include "core/error.h"
#include "frame/history.h"
#include "scoring/midline.h"

namespace swallowclip::scoring {

/// One midline vertex of the lower sheet.
struct Station {
  double s_m = 0;
  int vertex = -1;
  frame::Wall wall = frame::Wall::tongue;
};

struct LumenProfile {
  std::vector<Station> stations;           ///< s strictly rising
  std::vector<std::vector<double>> gap_m;  ///< [frame][station]
  /// [frame] narrowest distance between the two sides of the laryngeal vestibule on the midline;
  /// empty when the skin has no laryngeal branch.
  std::vector<double> vestibule_m;
  std::vector<int> vestibuleFront;                  ///< vertices of its epiglottic side
  std::vector<std::vector<double>> vestibuleGap_m;  ///< [frame][of them] distance to the other side

  /// [frame] the same of the velopharyngeal port; empty without a nasopharyngeal branch.
  std::vector<double> port_m;

  /// Gap at s by linear interpolation between stations, clamped at the ends.
  double gapAt(int frame, double s_m) const;
  /// Stations with from <= s <= to, as a half-open index range.
  std::pair<int, int> range(double from_m, double to_m) const;
};

/// Gap at a station: distance to the nearest triangle of the upper sheet that touches the midline.
/// Fails when the skin's arrays disagree or it has no midline column.
Result<LumenProfile> midlineGaps(const frame::SkinTrack& skin);

/// Area of the lumen in the midsagittal plane between two s (m^2): sum of mean gap times the
/// present distance between neighbouring lower vertices.
double midlineArea_m2(const LumenProfile& lumen, const frame::SkinTrack& skin, int frame,
                      double from_m, double to_m);
}  // namespace swallowclip::scoring
