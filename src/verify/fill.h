// SPDX-License-Identifier: MIT
// Places and velocities of the first particles.
#pragma once
#include <vector>

#include "core/error.h"
#include "verify/case.h"
#include "verify/domain.h"

namespace swallowclip::verify {

struct Start {
  std::vector<Vec3> positions, velocities;  ///< world
  double volume_m3 = 0;                     ///< of the fluid as the case gives it
  /// So that the particles have exactly that volume; next to the wanted spacing.
  double spacing_m = 0;
};

/// At a place in the domain's own axes, beside that of its fill.
Vec3 startVelocity(const CaseDef& def, const Vec3& p);
Result<Start> fillDomain(const CaseDef& def, const Domain& domain, double spacing_m);
}  // namespace swallowclip::verify
