// SPDX-License-Identifier: MIT
// Gradients of the velocity from neighbours and walls.
#pragma once
#include "bolus/projection.h"

namespace swallowclip::bolus {

/// dv_a / dx_b (1/s) at a slot that moves with `velocity`, walls included.
Mat3 velocityGradient_s(const Flow& flow, const SlopeSweep& slopes, const Vec3& velocity, int slot);
/// The same half way to the wall: along its normal the velocity changes as from here to it.
Mat3 gradientBeforeWall_s(const WallSample& wall, const Vec3& velocity, const Mat3& gradient_s);
/// sqrt(2 D:D) (1/s) of it.
double shearRate_s(const Mat3& velocityGradient_s);
}  // namespace swallowclip::bolus
