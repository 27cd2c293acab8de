// SPDX-License-Identifier: MIT
#include "airway/interpenetration.h"

#include <gtest/gtest.h>

#include "mouth.h"

namespace swallowclip::airway {
namespace {

// The box lumen with its floor raised in the middle by a plateau, to `gap_m` below the roof.
TriMesh pressed(double gap_m) {
  TriMesh m = test::refinedBox(test::kLow, test::kHigh, 4);
  for (Vec3& p : m.positions)
    if (p.z() == 0 && std::abs(p.x()) < 0.008 && std::abs(p.y() - 0.03) < 0.01)
      p.z() = test::kHeight_m - gap_m;
  return m;
}

TEST(Interpenetration, NothingCrossesDownToTheSmallestGap) {
  ThreadPool pool(2);
  for (double gap_m : {0.008, 1e-3, 1e-4, 2e-5, 5e-6}) {
    const TriMesh m = pressed(gap_m);
    const Interpenetration found = maxInterpenetration(m.positions, m.triangles, pool);
    EXPECT_EQ(found.depth_m, 0) << gap_m;
    EXPECT_EQ(found.vertex, -1);
  }
}

TEST(Interpenetration, MeasuresHowFarTheFloorIsThroughTheRoof) {
  ThreadPool pool(1);
  for (double depth_m : {1e-5, 1e-4, 1e-3, 2e-3}) {
    const TriMesh m = pressed(-depth_m);
    const Interpenetration found = maxInterpenetration(m.positions, m.triangles, pool);
    EXPECT_NEAR(found.depth_m, depth_m, 1e-3 * depth_m);
    EXPECT_GT(found.vertices, 10);
    EXPECT_GE(found.triangle, 0);
  }
}

TEST(Interpenetration, FindsTwoRoomsThatOverlap) {
  ThreadPool pool(1);
  TriMesh m = test::refinedBox({0, 0, 0}, {0.01, 0.01, 0.01}, 3);
  const TriMesh other = test::refinedBox({0.001, 0.001, 0.0095}, {0.009, 0.009, 0.02}, 3);
  const int shift = static_cast<int>(m.positions.size());
  m.positions.insert(m.positions.end(), other.positions.begin(), other.positions.end());
  for (const Triangle& t : other.triangles)
    m.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  const Interpenetration found = maxInterpenetration(m.positions, m.triangles, pool);
  EXPECT_NEAR(found.depth_m, 5e-4, 1e-9);
}

TEST(Interpenetration, DepthOfOneStructureInAnother) {
  ThreadPool pool(1);
  const TriMesh a = test::refinedBox({0, 0, 0}, {0.01, 0.01, 0.01}, 3);
  const TriMesh b = test::refinedBox({-0.01, -0.01, 0.0085}, {0.02, 0.02, 0.02}, 3);
  const TriMesh c = test::refinedBox({-0.01, -0.01, 0.0101}, {0.02, 0.02, 0.02}, 3);
  EXPECT_NEAR(depthInside(a, b, pool).depth_m, 0.0015, 1e-12);
  EXPECT_EQ(depthInside(a, c, pool).depth_m, 0);
  EXPECT_EQ(depthInside(a, c, pool).vertex, -1);
}

TEST(Interpenetration, SameAnswerForEveryThreadCount) {
  const TriMesh m = pressed(-1e-3);
  ThreadPool one(1), three(3);
  const auto a = maxInterpenetration(m.positions, m.triangles, one);
  const auto b = maxInterpenetration(m.positions, m.triangles, three);
  EXPECT_EQ(a.depth_m, b.depth_m);
  EXPECT_EQ(a.vertex, b.vertex);
  EXPECT_EQ(a.triangle, b.triangle);
}
}  // namespace
}  // namespace swallowclip::airway
