// SPDX-License-Identifier: MIT
#include "bolus/viscosity.h"

#include <gtest/gtest.h>

namespace swallowclip::bolus {
namespace {
// v_x = a z + b z^2 / 2 over a wall at z = 0, seen from z = d: half way the slope is a + b d / 2.
TEST(Viscosity, ShearHalfWayToTheWall) {
  const double a = 3, b = -400, d = 4e-4, weight = 250;
  WallSample w;
  w.gradLambda = {0, 0, -weight};
  w.area = weight;
  w.friction = weight / d;
  Mat3 gradient = Mat3::Zero();
  gradient(0, 2) = a + b * d;
  gradient(1, 0) = 0.7;  // along the wall nothing changes
  Mat3 expected = gradient;
  expected(0, 2) = a + b * d / 2;
  const Vec3 v(a * d + b * d * d / 2, 0, 0);
  const Mat3 halfWay = gradientBeforeWall_s(w, v, gradient);
  EXPECT_LT((halfWay - expected).norm(), 1e-12 * a) << halfWay;
  // and a wall that moves with the fluid takes its motion off
  const Vec3 wall(0.1, -0.2, 0);
  w.frictionVelocity = w.friction * wall;
  EXPECT_LT((gradientBeforeWall_s(w, v + wall, gradient) - expected).norm(), 1e-12 * a);
  EXPECT_EQ(gradientBeforeWall_s({}, v, gradient), gradient);  // no wall within reach
}
}  // namespace
}  // namespace swallowclip::bolus
