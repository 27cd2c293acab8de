// SPDX-License-Identifier: MIT
#include "core/curve.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace swallowclip;

TEST(Curve, PassesThroughItsKnotsAndNeverOvershoots) {
  const std::vector<double> x{0, 1, 1.5, 4, 4.2}, y{0, 0, 3, 3, -1};
  const Curve curve(x, y);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(curve(x[i]), y[i], 1e-14);
  for (double t = -1; t < 6; t += 0.01) {
    EXPECT_GE(curve(t), -1 - 1e-12) << t;
    EXPECT_LE(curve(t), 3 + 1e-12) << t;
  }
  EXPECT_EQ(curve(-10), 0);
  EXPECT_EQ(curve(10), -1);
}

TEST(Curve, SlopeIsTheDerivativeAndContinuous) {
  const Curve curve({0, 1, 1.5, 4, 4.2}, {0, 2, 3, 3.5, 9});
  constexpr double h = 1e-6;
  for (double t = 0.05; t < 4.2; t += 0.037)
    EXPECT_NEAR(curve.slope(t), (curve(t + h) - curve(t - h)) / (2 * h), 1e-4) << t;
  for (const double knot : {1.0, 1.5, 4.0})
    EXPECT_NEAR(curve.slope(knot - 1e-9), curve.slope(knot + 1e-9), 1e-5) << knot;
}

TEST(Curve, ShiftedComesLaterAndReachesInvertsIt) {
  const Curve curve({0, 1, 2, 4}, {-1, 0, 5, 6});
  const Curve later = curve.shifted(0.25);
  for (double x = -1; x < 5; x += 0.1) EXPECT_NEAR(later(x + 0.25), curve(x), 1e-12) << x;
  for (const double y : {-0.9, 0.0, 2.0, 5.5}) EXPECT_NEAR(curve(curve.reaches(y)), y, 1e-9) << y;
  EXPECT_NEAR(curve.reaches(-2), 0, 1e-12);
  EXPECT_EQ(curve.reaches(7), 4);
}

TEST(Easing, EndsAndMiddle) {
  for (const auto ease : {smoothstep, minimumJerk}) {
    EXPECT_EQ(ease(-1), 0);
    EXPECT_EQ(ease(2), 1);
    EXPECT_NEAR(ease(0.5), 0.5, 1e-14);
  }
  EXPECT_EQ(plateau(0.5, 1, 2, 3, 4), 0);
  EXPECT_EQ(plateau(2.5, 1, 2, 3, 4), 1);
  EXPECT_EQ(plateau(4.5, 1, 2, 3, 4), 0);
  EXPECT_NEAR(plateau(1.5, 1, 2, 3, 4), 0.5, 1e-14);
}
