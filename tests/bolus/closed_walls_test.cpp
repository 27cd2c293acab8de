// SPDX-License-Identifier: MIT
#include "bolus/closed_walls.h"

#include <gtest/gtest.h>

#include <random>

#include "shapes.h"

namespace swallowclip::bolus {
namespace {
using testing::box;

TEST(CapHoles, CloseWhatIsLeftOfAClosedSurface) {
  const auto m = box(Vec3(0, 0, 0), Vec3(6, 4, 2), 1);
  std::vector<std::uint8_t> skip(m.triangles.size(), 0);
  // a hole of 4 x 2 squares in the top, and another one in the side
  for (std::size_t k = 0; k < m.triangles.size(); ++k) {
    Vec3 c = Vec3::Zero();
    for (int v : m.triangles[k]) c += m.positions[v] / 3;
    skip[k] = (c.z() == 2 && c.x() > 1 && c.x() < 5 && c.y() > 1 && c.y() < 3) ||
              (c.x() == 6 && c.y() > 1 && c.y() < 2);
  }
  const auto caps = capHoles(m.triangles, skip, m.positions);
  std::vector<Triangle> whole = caps;
  int taken = 0;
  for (std::size_t k = 0; k < m.triangles.size(); ++k)
    skip[k] ? void(++taken) : whole.push_back(m.triangles[k]);
  ASSERT_EQ(taken, 16 + 4);
  EXPECT_EQ(caps.size(), 10u + 4u);  // loops of 12 and 6 edges: two triangles less than edges
  std::vector<int> compacted(m.positions.size(), -1);
  int used = 0;
  for (Triangle& t : whole)
    for (int& v : t) {
      if (compacted[v] < 0) compacted[v] = used++;
      v = compacted[v];
    }
  const auto report = checkManifold(whole, used);
  EXPECT_TRUE(report.closed()) << report.text();
  std::vector<Vec3> x(used);
  for (std::size_t v = 0; v < compacted.size(); ++v)
    if (compacted[v] >= 0) x[compacted[v]] = m.positions[v];
  EXPECT_NEAR(volume(x, whole), 48, 1e-9);  // flat holes, faced as their surroundings
}

TEST(CapHoles, ASlitIsZippedAcross) {
  // two facing strips, 6 long and 0.01 apart, joined at the back: a flat tube open on one side
  auto m = box(Vec3(0, 0, 0), Vec3(6, 2, 0.01), 1);
  std::vector<std::uint8_t> skip(m.triangles.size(), 0);
  for (std::size_t k = 0; k < m.triangles.size(); ++k) {
    skip[k] = 1;
    for (int v : m.triangles[k]) skip[k] = skip[k] && m.positions[v].y() == 0;
  }
  const auto caps = capHoles(m.triangles, skip, m.positions);
  ASSERT_EQ(caps.size(), 12u);
  for (const Triangle& t : caps)
    for (int e = 0; e < 3; ++e)
      EXPECT_LT((m.positions[t[e]] - m.positions[t[(e + 1) % 3]]).norm(), 1.1);
}

TEST(ColumnIndex, AgreesWithTheWindingNumber) {
  const auto m = testing::box(Vec3(-1, -2, -3), Vec3(2, 2, 1), 0.4);
  ColumnIndex index;
  index.build(m.triangles, m.positions);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> at(-4, 4);
  int inside = 0;
  for (int k = 0; k < 3000; ++k) {
    const Vec3 p(at(random), at(random), at(random));
    const bool expected = windingNumber(p, m.positions, m.triangles) > 0.5;
    EXPECT_EQ(index.inside(p), expected) << p.transpose();
    inside += expected;
  }
  EXPECT_GT(inside, 200);
}
}  // namespace
}  // namespace swallowclip::bolus
