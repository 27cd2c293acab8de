// SPDX-License-Identifier: MIT
// Places for the first particles: a lattice inside the closed surface, lowest places first.
#pragma once
#include <vector>

#include "bolus/kernels.h"
#include "bolus/wall_motion.h"

namespace swallowclip::bolus {

/// Where the bolus is held: path coordinate range (m). Without path coordinates: everywhere.
struct SeedRange {
  double sMin_m = -1e9, sMax_m = 1e9;
};

/// Exactly `count` points inside the surface, at least 0.4 spacings (0.3 when space is short) from
/// it, on a lattice of the given spacing, or of a closer one when that has not enough places.
Result<std::vector<Vec3>> seedPlaces(const WallMotion& motion, const std::vector<Vec3>& positions,
                                     const Vec3& gravity_ms2, const SeedRange& range,
                                     double spacing_m, int count);
}  // namespace swallowclip::bolus
