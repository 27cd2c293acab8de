// SPDX-License-Identifier: MIT
// The grid against its slow twin: every pair.
#include "bolus/neighbours.h"

#include <gtest/gtest.h>

#include <random>

namespace swallowclip::bolus {
namespace {
TEST(Neighbours, AgreeWithEveryPair) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> along(-0.02, 0.03);
  std::vector<Vec3> points(700);
  std::vector<std::uint8_t> take(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = {along(random), 0.4 * along(random), 0.2 * along(random)};
    take[i] = i % 5 != 0;
  }
  points[11] = points[12];  // two at one place
  const Kernel kernel(KernelKind::cubicSpline, 4e-3);
  ThreadPool pool(2);
  Neighbours nb;
  nb.build(points, take, kernel, pool);
  int pairs = 0;
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    int k = nb.start[i];
    double sum = take[i] ? kernel.w(0) : 0;
    for (int j = 0; j < static_cast<int>(points.size()); ++j) {
      const Vec3 d = points[i] - points[j];
      if (i == j || !take[i] || !take[j] || d.norm() >= kernel.support_m()) continue;
      ASSERT_LT(k, nb.start[i + 1]);
      EXPECT_EQ(nb.index[k], j);
      const Vec3 expected =
          d.norm() > 0 ? Vec3(kernel.slope(d.norm()) / d.norm() * d) : Vec3::Zero();
      EXPECT_LT((nb.gradW[k] - expected).norm(), 1e-9 * kernel.w(0) / 4e-3);
      sum += kernel.w(d.norm());
      ++k;
      ++pairs;
    }
    EXPECT_EQ(k, nb.start[i + 1]) << "particle " << i;
    EXPECT_NEAR(nb.sumW[i], sum, 1e-9 * kernel.w(0));
  }
  EXPECT_GT(pairs, 5000);
}

TEST(Neighbours, StrayParticleCostsNoMemory) {
  std::vector<Vec3> points{{0, 0, 0}, {1e-3, 0, 0}, {500, -800, 1000}};
  ThreadPool pool(1);
  Neighbours nb;
  nb.build(points, {}, Kernel(KernelKind::cubicSpline, 4e-3), pool);
  EXPECT_EQ(nb.start[1] - nb.start[0], 1);
  EXPECT_EQ(nb.start[3] - nb.start[2], 0);
}
}  // namespace
}  // namespace swallowclip::bolus
