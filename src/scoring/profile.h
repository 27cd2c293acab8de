// SPDX-License-Identifier: MIT
// Where a chain of skin vertices (a midline column) crosses a level line, as on a lateral picture.
#pragma once
#include <vector>

#include "scoring/spine.h"

namespace swallowclip::scoring {

/// How far forward of the spine's axis the chain crosses a height: its rearmost crossing, or its
/// foremost; NaN where it does not.
double crossingForward_m(const std::vector<int>& chain, const std::vector<Vec3f>& positions,
                         const Spine& spine, double height_m, bool rearmost);
}  // namespace swallowclip::scoring
