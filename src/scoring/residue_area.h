// SPDX-License-Identifier: MIT
// Residue as it is measured on a lateral picture: areas of contrast in the pockets, of the pockets
// themselves, and the ratios made of them (percent full, %(C2-4)^2, NRRS of Pearson 2013).
#pragma once
#include <vector>

#include "frame/history.h"
#include "scoring/metrics.h"
#include "scoring/residue.h"

namespace swallowclip::scoring {

/// Area of the lateral projection of drops (m^2) where the way through contrast is at least
/// `chord_m`. A drop is a ball of its volume; film is left out (thinner than an x-ray shows).
double projectedArea_m2(const std::vector<Deposit>& drops, double chord_m);

/// Area (m^2) of a pocket, from its outline in the sagittal plane (y, z), under the level line
/// through the lower of its two rims.
double pocketArea_m2(const std::vector<Vec2>& outline);

/// Outlines of the valleculae and of the pyriform sinuses at a frame, side by side columns first;
/// the largest of the areas is the pocket's.
double valleculaSpace_m2(const frame::History& history, int frame, const ScoringRules& rules);
double pyriformSpace_m2(const frame::History& history, int frame, const ScoringRules& rules);

/// By location in mL and % of V0; by pocket % full, %(C2-4)^2 and NRRS; total %(C2-4)^2.
std::vector<Quantity> measureResidueAreas(const frame::History& history,
                                          const std::optional<Residue>& residue,
                                          const ScoringRules& rules);
}  // namespace swallowclip::scoring
