// SPDX-License-Identifier: MIT
#include "kinematics/follow.h"

#include <gtest/gtest.h>

#include <numeric>

namespace swallowclip::kinematics {
namespace {

// A 6 x 6 patch of points, 2 mm apart.
std::vector<Vec3> patch() {
  std::vector<Vec3> p;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) p.push_back({i * 2e-3, j * 2e-3, 0});
  return p;
}

std::vector<int> all(const std::vector<Vec3>& p) {
  std::vector<int> indices(p.size());
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

TEST(Follow, WeightsSumToOne) {
  const auto points = patch();
  for (double z : {0.0, 1e-3, 0.05}) {
    const Attachment a = attach({5e-3, 4e-3, z}, points, all(points));
    EXPECT_NEAR(std::accumulate(a.weight.begin(), a.weight.end(), 0.0), 1, 1e-12);
  }
}

TEST(Follow, OneShiftOfAllCarriersShiftsThePointExactly) {
  const auto points = patch();
  auto moved = points;
  const Vec3 shift(1e-3, -2e-3, 3e-3);
  for (Vec3& p : moved) p += shift;
  const Attachment a = attach({3.3e-3, 7e-3, 4e-3}, points, all(points));
  EXPECT_LT((follow(a, points, moved) - shift).norm(), 1e-15);
  EXPECT_EQ(follow(a, points, points), Vec3(Vec3::Zero()));
}

TEST(Follow, ATouchingPointGoesWithTheOneItTouches) {
  const auto points = patch();
  auto moved = points;
  moved[14] += Vec3(0, 0, 5e-3);
  const Attachment a = attach(points[14], points, all(points));
  EXPECT_GT(follow(a, points, moved).z(), 0.95 * 5e-3);
}

// Neighbours come and go with weight zero, so the displacement has no steps along a path.
TEST(Follow, DisplacementIsContinuousInSpace) {
  const auto points = patch();
  auto moved = points;
  for (std::size_t i = 0; i < moved.size(); ++i) moved[i].z() += i % 2 ? 4e-3 : 0;
  double last = 0, most = 0;
  for (int k = 0; k <= 2000; ++k) {
    const Vec3 p(1e-3 + k * 4e-6, 3.1e-3 + k * 1e-6, 2e-3);
    const double z = follow(attach(p, points, all(points)), points, moved).z();
    if (k > 0) most = std::max(most, std::abs(z - last));
    last = z;
  }
  EXPECT_LT(most, 2e-5);  // m, over steps of 4 um
}
}  // namespace
}  // namespace swallowclip::kinematics
