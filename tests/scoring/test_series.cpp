// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>

#include "core/vec.h"
#include "scoring/series.h"

namespace swallowclip::scoring {
namespace {

std::vector<double> sine(double rate_Hz, double f_Hz, int n) {
  std::vector<double> x;
  for (int i = 0; i < n; ++i) x.push_back(std::sin(2 * kPi * f_Hz * i / rate_Hz));
  return x;
}

/// Gain in the middle of a long sine, by projection (also sees a phase shift).
double gainInPhase(double rate_Hz, double f_Hz) {
  const auto x = sine(rate_Hz, f_Hz, 1200);
  const auto y = zeroPhaseLowPass(x, rate_Hz, 6);
  double xy = 0, xx = 0;
  for (int i = 300; i < 900; ++i) xy += x[i] * y[i], xx += x[i] * x[i];
  return xy / xx;
}

TEST(Series, LowPassKeepsConstantsAndRamps) {
  std::vector<double> ramp;
  for (int i = 0; i < 40; ++i) ramp.push_back(3 + 0.7 * i);
  const auto y = zeroPhaseLowPass(ramp, 30, 6);
  for (int i = 0; i < 40; ++i) EXPECT_NEAR(y[i], ramp[i], 0.02) << i;
}

TEST(Series, LowPassCutsAtSixHertzWithoutPhase) {
  EXPECT_NEAR(gainInPhase(60, 1.2), 1, 0.01);
  EXPECT_NEAR(gainInPhase(60, 6), std::sqrt(0.5), 0.01);  // -3 dB of both passes together
  EXPECT_LT(gainInPhase(60, 15), 0.05);
}

TEST(Series, LowPassLeavesShortOrSlowSeriesAlone) {
  const std::vector<double> x{1, 5, 2};
  EXPECT_EQ(zeroPhaseLowPass(x, 30, 6), x);
  const std::vector<double> y{1, 5, 2, 7, 3, 3};
  EXPECT_EQ(zeroPhaseLowPass(y, 10, 6), y);
}

TEST(Series, RunsNeedTheirHysteresis) {
  const std::vector<double> x{0, 0, 5, 4, 9, 2, 3, 8};
  const auto r = runs(x, 4);
  ASSERT_EQ(r.size(), 3u);
  EXPECT_EQ(r[0].begin, 1);  // the last of the level frames
  EXPECT_EQ(r[0].end, 4);
  EXPECT_DOUBLE_EQ(r[0].change, 9);
  EXPECT_DOUBLE_EQ(r[1].change, -7);
  EXPECT_DOUBLE_EQ(r[2].change, 6);
  EXPECT_TRUE(runs(x, 20).empty());
}

TEST(Series, PathSlopeIsTheSlopeBetweenTheShares) {
  std::vector<double> t, x;
  for (int i = 0; i <= 30; ++i) t.push_back(i * 0.1), x.push_back(2.0 * std::max(0, i - 10) * 0.1);
  EXPECT_NEAR(pathSlope(t, x, 0, 30, 0.1, 0.9).value(), 2.0, 1e-12);
  EXPECT_FALSE(pathSlope(t, x, 0, 5, 0.1, 0.9).has_value());
}

TEST(Series, AdvancesNeedPathAndSpeed) {
  std::vector<double> t, x;
  for (int i = 0; i <= 60; ++i) t.push_back(i / 30.0), x.push_back(i < 30 ? 0 : (i - 30) * 2.0);
  const auto a = advances(t, x, 10, 20, 1);  // 60 per second
  ASSERT_EQ(a.size(), 1u);
  EXPECT_NEAR(a[0].onset_s, 1.0, 1 / 30.0);
  EXPECT_TRUE(advances(t, x, 100, 20, 1).empty());
  EXPECT_TRUE(advances(t, x, 10, 70, 1).empty());
}
}  // namespace
}  // namespace swallowclip::scoring
