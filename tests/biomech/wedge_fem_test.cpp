// SPDX-License-Identifier: MIT
#include "biomech/wedge_fem.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "shapes.h"

namespace swallowclip::biomech {
namespace {

const Material kMuscle{"muscle", 1050, 8e3, 0.49};

WedgeMesh meshOf(const TriMesh& surface, double layer_m = 1e-3, Material material = kMuscle) {
  auto built = WedgeMesh::build(surface, {layer_m, material});
  EXPECT_TRUE(built.has_value()) << (built ? "" : built.error().text());
  return std::move(*built);
}

double leastRestJacobian(const WedgeMesh& w) {
  double least = 1e30;
  for (const auto& e : w.connectivity()) {
    Wedge one;
    for (int a = 0; a < 6; ++a) one[a] = w.restNodes()[e[a]];
    least = std::min(least, wedgeMinJacobian(one));
  }
  return least;
}

std::vector<Vec3> mapped(std::vector<Vec3> points, const Mat3& f, const Vec3& shift) {
  for (Vec3& p : points) p = f * p + shift;
  return points;
}

TEST(Wedge, RightPrismHasItsVolumeAndJacobian) {
  const Wedge w = {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0, 3, 0),
                   Vec3(0, 0, 5), Vec3(2, 0, 5), Vec3(0, 3, 5)};
  EXPECT_NEAR(wedgeVolume(w), 15, 1e-13);
  EXPECT_NEAR(wedgeMinJacobian(w), 15, 1e-13);
}

TEST(Wedge, TwistedElementIsFoundInverted) {
  Wedge w = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0),
             Vec3(0, 0, 1), Vec3(1, 0, 1), Vec3(0, 1, 1)};
  w[3].z() = -0.5;
  EXPECT_LT(wedgeMinJacobian(w), 0);
}

// Patch test: under any affine motion of the nodes every element shows exactly that strain.
TEST(WedgeMesh, PatchTestGivesTheExactStrain) {
  ThreadPool pool(2);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> u(-0.4, 0.4);
  const WedgeMesh w = meshOf(test::ellipsoid({0.03, 0.02, 0.015}, 3));
  for (int round = 0; round < 10; ++round) {
    Mat3 f = Mat3::Identity();
    for (int i = 0; i < 9; ++i) f(i / 3, i % 3) += u(random);
    const Mat3 exact = 0.5 * (f.transpose() * f - Mat3::Identity());
    const StrainField field = w.strain(mapped(w.restNodes(), f, {0.1, -0.2, 0.3}), pool);
    for (int e = 0; e < w.elements(); ++e) {
      ASSERT_LT((field.strain[e] - exact).norm(), 1e-9);
      ASSERT_NEAR(field.vonMises_Pa[e], vonMises(hookeStress(exact, kMuscle)), 1e-5);
    }
  }
}

TEST(WedgeMesh, RigidMotionLeavesNoStrain) {
  ThreadPool pool(1);
  const TriMesh surface = test::ellipsoid({0.03, 0.02, 0.015}, 3);
  const WedgeMesh w = meshOf(surface);
  const Pose pose = test::poseAt(2.2, {1, -2, 0.5}, {0.3, 0.1, -0.2});
  const auto nodes = w.follow(test::applied(pose, surface.positions));
  const auto expected = test::applied(pose, w.restNodes());
  for (size_t i = 0; i < nodes.size(); ++i) ASSERT_LT((nodes[i] - expected[i]).norm(), 1e-12);
  const StrainField field = w.strain(nodes, pool);
  for (const Mat3& e : field.strain) ASSERT_LT(e.norm(), 1e-10);
  EXPECT_NEAR(field.minJacobianRatio, w.strain(w.restNodes(), pool).minJacobianRatio, 1e-9);
  EXPECT_GT(field.minJacobianRatio, 0.5);
  EXPECT_EQ(field.foldedElements, 0);
}

TEST(WedgeMesh, RestNodesFollowTheRestSurface) {
  const TriMesh surface = test::ellipsoid({0.03, 0.02, 0.015}, 3);
  const WedgeMesh w = meshOf(surface);
  const auto nodes = w.follow(surface.positions);
  for (size_t i = 0; i < nodes.size(); ++i) ASSERT_LT((nodes[i] - w.restNodes()[i]).norm(), 1e-15);
}

// A wide plate stretched along x and free to contract across (nu) and in thickness (the driven
// inner nodes): away from its rim the stress is E e along x and nothing else.
TEST(WedgeMesh, UniaxialStretchGivesTheAnalyticStress) {
  ThreadPool pool(1);
  const Material soft{"muscle", 1050, 10e3, 0.3};
  const TriMesh plate = test::refinedBox({-0.02, -0.02, -0.005}, {0.02, 0.02, 0.005}, 4);
  const WedgeMesh w = meshOf(plate, 1e-3, soft);
  const double e = 1e-4;
  const Mat3 f = Vec3(1 + e, 1 - soft.poisson * e, 1 - soft.poisson * e).asDiagonal();
  const StrainField field = w.strain(w.follow(mapped(plate.positions, f, Vec3::Zero())), pool);
  int seen = 0;
  for (int i = 0; i < w.elements(); ++i) {
    Vec3 centre = Vec3::Zero();
    for (int v : plate.triangles[w.triangleOf(i)]) centre += plate.positions[v] / 3;
    if (std::abs(centre.x()) > 0.015 || std::abs(centre.y()) > 0.015) continue;
    ++seen;
    EXPECT_NEAR(field.stress_Pa[i](0, 0), soft.young_Pa * e, 2e-3);  // of 1 Pa
    EXPECT_NEAR(field.stress_Pa[i](1, 1), 0, 2e-3);
    EXPECT_NEAR(field.stress_Pa[i](2, 2), 0, 2e-3);
    EXPECT_NEAR(field.vonMises_Pa[i], soft.young_Pa * e, 2e-3);
  }
  EXPECT_GT(seen, 500);
}

TEST(WedgeMesh, ElementVolumesSumToTheShell) {
  const TriMesh outer = test::ellipsoid({0.02, 0.02, 0.02}, 4);
  const WedgeMesh w = meshOf(outer);
  // the shell between the surface and its innermost nodes, both closed triangle meshes up to the
  // elements' curved side faces
  const int n = w.vertices();
  const TriMesh inner{{w.restNodes().end() - n, w.restNodes().end()}, outer.triangles};
  const double shell = volume(outer) - volume(inner);
  EXPECT_NEAR(w.volume(w.restNodes()) / shell, 1, 1e-4);
  EXPECT_NEAR(w.volume(w.restNodes()), 4 * kPi / 3 * (std::pow(0.02, 3) - std::pow(0.018, 3)),
              2e-2 * shell);
  EXPECT_EQ(w.elements(), 2 * static_cast<int>(outer.triangles.size()));
}

TEST(WedgeMesh, EveryBindJacobianIsPositiveWhereCurvatureWouldFoldIt) {
  for (double half : {0.02, 0.003, 0.001, 0.0004}) {
    const WedgeMesh w = meshOf(test::ellipsoid({0.02, 0.01, half}, 4));
    EXPECT_GT(leastRestJacobian(w), 0) << half;
    EXPECT_EQ(w.skippedTriangles(), 0) << half;
  }
  const WedgeMesh thin = meshOf(test::ellipsoid({0.02, 0.01, 0.0004}, 4));
  EXPECT_LT(thin.thinnestLayer_m(), 1e-3);
  const WedgeMesh corner = meshOf(test::refinedBox({0, 0, 0}, {0.004, 0.03, 0.03}, 3));
  EXPECT_GT(leastRestJacobian(corner), 0);
  EXPECT_EQ(corner.skippedTriangles(), 0);
}

TEST(WedgeMesh, SliversCarryNoElementAndAreCounted) {
  TriMesh mesh = test::box({0, 0, 0}, {0.01, 0.01, 0.01});
  mesh.positions.push_back((mesh.positions[0] + mesh.positions[1]) / 2);  // on an edge
  mesh.triangles.push_back({0, 8, 1});
  const WedgeMesh w = meshOf(mesh);
  EXPECT_EQ(w.skippedTriangles(), 1);
  EXPECT_GT(leastRestJacobian(w), 0);
}

TEST(WedgeMesh, SameFieldForEveryThreadCount) {
  const TriMesh surface = test::ellipsoid({0.03, 0.02, 0.015}, 4);
  const WedgeMesh w = meshOf(surface);
  const auto nodes = w.follow(test::ellipsoid({0.035, 0.019, 0.014}, 4).positions);
  ThreadPool one(1), three(3);
  EXPECT_EQ(w.strain(nodes, one).vonMises_Pa, w.strain(nodes, three).vonMises_Pa);
}

TEST(WedgeMesh, RefusesNonsense) {
  const TriMesh good = test::box({0, 0, 0}, {0.01, 0.01, 0.01});
  EXPECT_FALSE(WedgeMesh::build(good, {0, kMuscle}).has_value());
  EXPECT_FALSE(WedgeMesh::build(good, {1e-3, {"x", 1000, 1e3, 0.5}}).has_value());
  TriMesh bad = good;
  bad.triangles[3][1] = 99;
  EXPECT_FALSE(WedgeMesh::build(bad, {1e-3, kMuscle}).has_value());
  bad = good;
  bad.positions[2].x() = std::nan("");
  EXPECT_FALSE(WedgeMesh::build(bad, {1e-3, kMuscle}).has_value());
}
}  // namespace
}  // namespace swallowclip::biomech
