// SPDX-License-Identifier: MIT
// Wall integrals against brute-force quadrature of the kernel over the volume outside.
#include "bolus/wall_field.h"

#include <gtest/gtest.h>

#include <random>

#include "bolus/contact_response.h"
#include "shapes.h"

namespace swallowclip::bolus {
namespace {
struct Brute {
  double lambda = 0;
  Vec3 grad = Vec3::Zero();
};
// Midpoint rule over the support ball; each cell counts with its share outside the box.
Brute brute(const Kernel& k, const Vec3& p, const Vec3& low, const Vec3& high) {
  Brute out;
  const int n = 60;
  const double cell = k.support_m() / n, dV = cell * cell * cell;
  for (int x = -n; x < n; ++x)
    for (int y = -n; y < n; ++y)
      for (int z = -n; z < n; ++z) {
        const Vec3 d = cell * Vec3(x + 0.5, y + 0.5, z + 0.5);
        const double r = d.norm();
        if (r >= k.support_m()) continue;
        const Vec3 lower = (p + d).array() - cell / 2, upper = (p + d).array() + cell / 2;
        const Vec3 overlap = upper.cwiseMin(high) - lower.cwiseMax(low);
        const double outside = 1 - overlap.cwiseMax(0).prod() / dV;
        out.lambda += k.w(r) * dV * outside;
        out.grad += k.slope(r) / r * -d * dV * outside;  // gradient at p of W(p - y)
      }
  return out;
}

void compare(const Vec3& low, const Vec3& high, const Vec3& p, double spacing, double tolerance) {
  const Kernel kernel(KernelKind::cubicSpline, 2 * spacing);
  const KernelTable table(kernel);
  const testing::Mesh mesh = testing::box(low, high, 1.1e-3);  // diagonals of 1.5 mm
  WallField field(table, spacing);
  const std::vector<Vec3> v(mesh.positions.size(), Vec3(0.1, -0.2, 0.3));
  field.build(mesh.triangles, mesh.positions, v, p, p);
  const WallSample got = field.sample(p);
  const Brute want = brute(kernel, p, low, high);
  EXPECT_NEAR(got.lambda, want.lambda, tolerance) << p.transpose();
  const double scale = 1 / kernel.support_m();
  EXPECT_LT((got.gradLambda - want.grad).norm(), 5 * tolerance * scale)
      << got.gradLambda.transpose() << " wanted " << want.grad.transpose();
  // all walls move alike: the flux is that velocity along the gradient
  EXPECT_NEAR(got.flux_s, v[0].dot(got.gradLambda), 1e-6 * scale);
}

TEST(WallField, PlaneAtManyDistances) {
  for (double d : {0.05e-3, 0.4e-3, 0.8e-3, 1.5e-3, 3e-3, 3.9e-3})
    compare({-0.02, -0.02, 0}, {0.02, 0.02, 0.04}, {0.13e-3, 0.31e-3, d}, 2e-3, 5e-3);
}
TEST(WallField, PlaneAtOneMillimetre) {
  for (double d : {0.05e-3, 0.4e-3, 1e-3})
    compare({-0.01, -0.01, 0}, {0.01, 0.01, 0.02}, {0.13e-3, 0.31e-3, d}, 1e-3, 5e-3);
}
TEST(WallField, CubeCorner) {
  compare({0, 0, 0}, {0.02, 0.02, 0.02}, {0.8e-3, 1.1e-3, 0.9e-3}, 2e-3, 5e-3);
  compare({0, 0, 0}, {0.02, 0.02, 0.02}, {0.2e-3, 0.3e-3, 2e-3}, 2e-3, 5e-3);
}
TEST(WallField, ThinGap) {
  compare({-0.02, -0.02, 0}, {0.02, 0.02, 1e-4}, {0, 0, 4e-5}, 2e-3, 5e-3);
  compare({-0.02, -0.02, 0}, {0.02, 0.02, 1e-3}, {0.2e-3, 0, 4e-4}, 2e-3, 5e-3);
}
TEST(WallField, FarInsideIsFree) {
  const testing::Mesh mesh = testing::box({0, 0, 0}, {0.02, 0.02, 0.02}, 1e-3);
  const KernelTable table{Kernel(KernelKind::cubicSpline, 4e-3)};
  WallField field(table, 2e-3);
  const std::vector<Vec3> v(mesh.positions.size(), Vec3::Zero());
  const Vec3 p(0.01, 0.01, 0.01);
  field.build(mesh.triangles, mesh.positions, v, p, p);
  EXPECT_EQ(field.sample(p).lambda, 0);
}
TEST(WallField, LargeTrianglesAreCut) {
  const testing::Mesh coarse = testing::box({0, 0, 0}, {0.02, 0.02, 0.02}, 1);
  const testing::Mesh fine = testing::box({0, 0, 0}, {0.02, 0.02, 0.02}, 1e-3);
  const KernelTable table{Kernel(KernelKind::cubicSpline, 4e-3)};
  const std::vector<Vec3> v(fine.positions.size(), Vec3::Zero());
  const Vec3 p(1.2e-3, 5e-3, 0.7e-3);
  WallField a(table, 2e-3), b(table, 2e-3);
  a.build(coarse.triangles, coarse.positions, v, p, p);
  b.build(fine.triangles, fine.positions, v, p, p);
  EXPECT_NEAR(a.sample(p).lambda, b.sample(p).lambda, 5e-3);
}
// Large triangles, whose far ones have fewer points, against sixteen times as many small ones.
TEST(WallField, FewPointsFarAwayAreEnough) {
  const double spacing = 1e-3;
  const Vec3 high(0.012, 0.012, 0.012);
  const testing::Mesh large = testing::box({0, 0, 0}, high, 1.3e-3);  // diagonals of 1.8 mm
  const testing::Mesh small = testing::box({0, 0, 0}, high, 0.3e-3);
  const KernelTable table{Kernel(KernelKind::cubicSpline, 2 * spacing)};
  WallField a(table, spacing), b(table, spacing);
  a.build(large.triangles, large.positions, std::vector<Vec3>(large.positions.size(), Vec3::Zero()),
          Vec3::Zero(), high);
  b.build(small.triangles, small.positions, std::vector<Vec3>(small.positions.size(), Vec3::Zero()),
          Vec3::Zero(), high);
  for (int k = 0; k < 200; ++k) {
    const Vec3 p = 1e-3 * Vec3(0.4 + 0.011 * (k * 37 % 200), 0.4 + 0.056 * (k * 73 % 200),
                               0.4 + 0.056 * (k * 91 % 200));
    const WallSample x = a.sample(p), y = b.sample(p);
    EXPECT_NEAR(x.lambda, y.lambda, 1e-3) << p.transpose();
    EXPECT_LT((x.gradLambda - y.gradLambda).norm() * spacing, 3e-3) << p.transpose();
  }
}
// A tenth of a spacing away, before flat walls, edges and corners, which move on: what follows from
// the sample against integrals of its own there.
TEST(WallField, SamplesServeNearTheirPlace) {
  const double spacing = 1e-3, since_s = 0.01;
  const Vec3 high(0.012, 0.012, 0.012), wall_ms(2e-3, -1e-3, 3e-3);
  const testing::Mesh mesh = testing::box({0, 0, 0}, high, 0.7e-3);
  const std::vector<Vec3> v(mesh.positions.size(), wall_ms);
  std::vector<Vec3> later = mesh.positions;
  for (Vec3& x : later) x += since_s * wall_ms;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const KernelKind kind : {KernelKind::cubicSpline, KernelKind::wendlandC2}) {
    const KernelTable table{Kernel(kind, 2 * spacing)};
    WallField a(table, spacing), b(table, spacing);
    a.build(mesh.triangles, mesh.positions, v, Vec3::Zero(), high);
    b.build(mesh.triangles, later, v, Vec3::Zero(), high);
    for (int k = 0; k < 400; ++k) {
      const bool flat = k % 2 == 0;
      Vec3 p, moved(any(random), any(random), any(random));
      for (int axis = 0; axis < 3; ++axis)
        p[axis] = 1e-3 * (flat && axis < 2 ? 6 : 1.2 + 0.8 * any(random));
      moved *= 0.1 * spacing / moved.norm();
      const WallSample s = a.sample(p), got = a.nearTo(s, moved, since_s),
                       want = b.sample(p + moved);
      EXPECT_NEAR(got.lambda, want.lambda, 5e-4) << p.transpose();
      EXPECT_LT((got.gradLambda - want.gradLambda).norm() * spacing, 1e-2) << p.transpose();
      EXPECT_NEAR(got.flux_s, want.flux_s, 1e-2 * wall_ms.norm() / spacing) << p.transpose();
      // which wall it is of is not known
      EXPECT_NEAR(got.lambdaSlope, want.lambdaSlope, flat ? 5e-3 : 3e-2) << p.transpose();
      EXPECT_NEAR(got.area * spacing, want.area * spacing, flat ? 1e-2 : 6e-2) << p.transpose();
      EXPECT_NEAR(got.friction, want.friction,
                  (flat ? 0.02 : 0.08) * (want.friction + 1 / (spacing * spacing)))
          << p.transpose();
    }
  }
}
TEST(WallField, NoWallIsNearerThanItSays) {
  const testing::Mesh mesh = testing::box({0, 0, 0}, {0.02, 0.02, 0.02}, 2e-3);
  const KernelTable table{Kernel(KernelKind::cubicSpline, 4e-3)};
  WallField field(table, 2e-3);
  const std::vector<Vec3> v(mesh.positions.size(), Vec3::Zero());
  field.build(mesh.triangles, mesh.positions, v, Vec3::Zero(), Vec3::Constant(0.02));
  for (int k = 0; k < 300; ++k) {
    const Vec3 p = 1e-4 * Vec3(1 + k * 37 % 198, 1 + k * 73 % 198, 1 + k * 91 % 198);
    const double away_m = nearestPoint(p, mesh.positions, mesh.triangles).distance_m;
    const double clear_m = field.sample(p).clear_m;
    EXPECT_LE(clear_m, away_m + 1e-8) << p.transpose();
    EXPECT_GE(clear_m, std::min(away_m, table.support_m()) / 2) << p.transpose();  // worth asking
  }
}
TEST(TriangleRuns, FindWhatLookingAtAllFinds) {
  const testing::Mesh mesh = testing::box({0, 0, 0}, {0.02, 0.015, 0.03}, 1.3e-3);
  TriangleRuns runs;
  runs.build(mesh.positions, mesh.triangles);
  for (int k = 0; k < 500; ++k) {  // on planes of symmetry too, where several are equally near
    const Vec3 p = 5e-4 * Vec3(k * 37 % 41, k * 73 % 31, k * 91 % 61);
    for (const int guess : {-1, k % 7}) {
      const NearestPoint a = nearestPoint(p, mesh.positions, mesh.triangles);
      const NearestPoint b = runs.nearest(p, mesh.positions, mesh.triangles, guess);
      EXPECT_EQ(a.triangle, b.triangle) << p.transpose();
      EXPECT_EQ(a.distance_m, b.distance_m) << p.transpose();
    }
  }
}
TEST(WallField, ContactsTellSideAndGap) {
  const testing::Mesh mesh = testing::box({0, 0, 0}, {0.02, 0.02, 1e-3}, 1e-3);
  const KernelTable table{Kernel(KernelKind::cubicSpline, 4e-3)};
  const std::vector<Vec3> v(mesh.positions.size(), Vec3::Zero());
  WallField field(table, 2e-3);
  field.build(mesh.triangles, mesh.positions, v, Vec3::Zero(), Vec3::Constant(0.02));
  std::vector<Contact> c;
  field.contacts({0.0101, 0.0102, 0.3e-3}, 1.8e-3, c);
  ASSERT_GE(c.size(), 2u);
  EXPECT_NEAR(c[0].distance_m, 0.3e-3, 1e-12);
  EXPECT_NEAR(c[0].inward.z(), 1, 1e-12);
  field.contacts({0.0101, 0.0102, -0.2e-3}, 1.8e-3, c);
  ASSERT_EQ(c.size(), 1u);
  EXPECT_NEAR(c[0].distance_m, -0.2e-3, 1e-12);
  field.contacts({-0.1e-3, -0.1e-3, -0.1e-3}, 1.8e-3, c);  // beyond a corner
  ASSERT_EQ(c.size(), 1u);
  EXPECT_LT(c[0].distance_m, 0);
  EXPECT_GT(c[0].inward.minCoeff(), 0.5);
}

// A particle nearer to a wall than it may be, as where a fold has just opened.
TEST(Contacts, PushWithinATimeNotWithinAStep) {
  const testing::Mesh mesh = testing::box({0, 0, 0}, {0.02, 0.02, 0.02}, 2e-3);
  constexpr double kSpacing_m = 1e-3, kNear_m = 0.05e-3, kKept_m = 0.4e-3;
  const KernelTable table{Kernel(KernelKind::cubicSpline, 2 * kSpacing_m)};
  WallField field(table, kSpacing_m);
  const std::vector<Vec3> v(mesh.positions.size(), Vec3::Zero());
  const Vec3 start(0.0101, 0.0103, kNear_m);
  field.build(mesh.triangles, mesh.positions, v, start, start);
  const auto after = [&](double dt_s, double walls_m, int steps) {
    Vec3 x = start;
    std::vector<Contact> contacts;
    for (int k = 0; k < steps; ++k)
      EXPECT_FALSE(projectInside(field, kSpacing_m, longestPush_m(kSpacing_m, dt_s, walls_m), false,
                                 x, contacts));
    EXPECT_NEAR(contacts[0].distance_m, x.z(), 1e-9);
    return x;
  };
  const auto pushed_m = [&](double dt_s, double walls_m, int steps) {
    return (after(dt_s, walls_m, steps) - start).norm();
  };
  EXPECT_NEAR(pushed_m(1e-3, 0, 1), 0.2e-3, 1e-9) << "a fifth of a spacing";
  EXPECT_NEAR(pushed_m(1e-5, 0, 1), 0.02e-3, 1e-9) << "a tenth of it in a tenth of 0.1 ms";
  EXPECT_NEAR(pushed_m(1e-5, 0, 10), 0.2e-3, 2e-6);
  EXPECT_NEAR(pushed_m(1e-5, 0.05e-3, 1), 0.1e-3, 1e-9) << "ahead of a fast wall";
  EXPECT_NEAR(after(1e-3, 0, 3).z(), kKept_m, 1e-9);
}
}  // namespace
}  // namespace swallowclip::bolus
