// SPDX-License-Identifier: MIT
#include "airway/surface_search.h"

#include <gtest/gtest.h>

#include <random>

#include "../biomech/shapes.h"

namespace swallowclip::airway {
namespace {

SurfacePoint slowNearest(const Vec3& p, const TriMesh& m) {
  SurfacePoint best;
  for (size_t t = 0; t < m.triangles.size(); ++t) {
    const auto& [a, b, c] = m.triangles[t];
    const Vec3 w = closestBarycentric(p, m.positions[a], m.positions[b], m.positions[c]);
    const Vec3 x = w[0] * m.positions[a] + w[1] * m.positions[b] + w[2] * m.positions[c];
    if ((x - p).norm() < best.distance_m) best = {static_cast<int>(t), w, x, (x - p).norm()};
  }
  return best;
}

TEST(SurfaceSearch, AgreesWithTheSlowTwin) {
  const TriMesh m = test::ellipsoid({0.03, 0.02, 0.01}, 4);
  const SurfaceSearch search(m.positions, m.triangles);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> u(-0.05, 0.05);
  double worstWinding = 0;
  for (int k = 0; k < 500; ++k) {
    const Vec3 p(u(random), u(random), u(random));
    const SurfacePoint fast = search.nearest(p), slow = slowNearest(p, m);
    ASSERT_EQ(fast.distance_m, slow.distance_m);
    ASSERT_LT((fast.point - p).norm() - fast.distance_m, 1e-15);
    worstWinding = std::max(
        worstWinding, std::abs(search.winding(p) - windingNumber(p, m.positions, m.triangles)));
  }
  EXPECT_LT(worstWinding, 0.03);
}

TEST(SurfaceSearch, WindingTellsInFromOutCloseToTheSurface) {
  const TriMesh m = test::ellipsoid({0.03, 0.02, 0.01}, 4);
  const SurfaceSearch search(m.positions, m.triangles);
  const auto normals = vertexNormals(m.positions, m.triangles);
  for (size_t v = 0; v < m.positions.size(); ++v) {
    ASSERT_NEAR(search.winding(m.positions[v] - 1e-6 * normals[v]), 1, 0.02);
    ASSERT_NEAR(search.winding(m.positions[v] + 1e-6 * normals[v]), 0, 0.02);
  }
}

TEST(SurfaceSearch, ReachAndOpposedSheet) {
  const TriMesh m = test::refinedBox({0, 0, 0}, {0.03, 0.03, 0.002}, 3);
  const SurfaceSearch search(m.positions, m.triangles);
  EXPECT_EQ(search.nearest({0.015, 0.015, 0.01}, 0.007).triangle, -1);
  EXPECT_NEAR(search.nearest({0.015, 0.015, 0.01}, 0.009).distance_m, 0.008, 1e-15);
  EXPECT_NEAR(search.nearestOpposed({0.015, 0.014, 0.002}, {0, 0, 1}).distance_m, 0.002, 1e-15);
}

TEST(SurfaceSearch, EmptyMeshHasNothing) {
  const SurfaceSearch search({}, {});
  EXPECT_EQ(search.nearest({0, 0, 0}).triangle, -1);
  EXPECT_EQ(search.winding({0, 0, 0}), 0);
}
}  // namespace
}  // namespace swallowclip::airway
