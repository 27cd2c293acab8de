// SPDX-License-Identifier: MIT
#include "bolus/point_grid.h"

#include <gtest/gtest.h>

#include <random>

namespace swallowclip::bolus {
namespace {
// None within reach is left out, from inside and outside, and few are looked at in vain.
TEST(PointGrid, RowsHoldAllWithinReach) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(0, 1);
  std::vector<Vec3> points(2000);
  for (Vec3& p : points) p = Vec3(any(random), 2 * any(random), 0.5 * any(random));
  points.back() = Vec3(1, 2, 0.5);  // in the last corner
  PointGrid grid;
  grid.build(points, {}, 0.1);
  std::size_t visited = 0, near = 0;
  for (int k = 0; k < 500; ++k) {
    const Vec3 p = 3 * Vec3(any(random), any(random), any(random)) - Vec3::Ones();
    const double reach = 0.02 + 0.3 * any(random);
    std::vector<int> seen(points.size(), 0);
    grid.rowsAround(p, reach, [&](int first, int last) {
      ASSERT_LT(first, last);
      for (int e = first; e < last; ++e) ++seen[grid.order()[e]];
    });
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool within = (points[i] - p).norm() <= reach;
      ASSERT_LE(seen[i], 1);
      ASSERT_TRUE(seen[i] == 1 || !within) << p.transpose() << ", " << points[i].transpose();
      visited += seen[i];
      near += within;
    }
  }
  EXPECT_LT(visited, 4 * near);
}
TEST(PointGrid, NothingTakenIsNothingFound) {
  const std::vector<Vec3> points(3, Vec3::Zero());
  const std::vector<std::uint8_t> none(3, 0);
  PointGrid grid;
  grid.build(points, none, 1);
  grid.rowsAround(Vec3::Zero(), 10, [](int, int) { FAIL(); });
}
}  // namespace
}  // namespace swallowclip::bolus
