// SPDX-License-Identifier: MIT
// Which vertices of the airway-skin form the midline of which sheet. The path coordinates alone do
// not tell: the branches (nasopharynx, larynx) repeat the s of their rims, and both sheets of the
// esophagus carry one label. The sheets' columns are what can be walked from the path's ends along
// midline edges on which s changes; along a branch it does not.
#pragma once
#include <vector>

#include "frame/history.h"

namespace swallowclip::scoring {

/// |u| below this is the midline column (u = 0 exactly, stored as float).
inline constexpr double kMidlineU = 1e-6;
/// Vertices whose s agree within this are level (m); grid rows are about 1.5 mm apart.
inline constexpr double kSameStation_m = 1e-5;
/// Longest step of s along a column (m); assumed, 3-8 mm, well above a row and below a branch.
inline constexpr double kColumnStep_m = 5e-3;

/// Vertex lists, s rising.
struct MidlineColumns {
  std::vector<int> lower;  ///< tongue, larynx, anterior esophagus
  std::vector<int> upper;  ///< palate, velum, posterior wall, posterior esophagus
  /// Inside of the laryngeal branch: epiglottic and arytenoid side. Empty without such a branch.
  std::vector<int> vestibuleFront, vestibuleBack;
  /// Inside of the nasopharyngeal branch: velar and posterior side. Empty without such a branch.
  std::vector<int> portFront, portBack;
};

/// The skin's arrays must agree (see midlineGaps).
MidlineColumns findMidline(const frame::SkinTrack& skin);
}  // namespace swallowclip::scoring
