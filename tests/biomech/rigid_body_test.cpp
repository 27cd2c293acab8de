// SPDX-License-Identifier: MIT
#include "biomech/rigid_body.h"

#include <gtest/gtest.h>

#include <random>

#include "biomech/material.h"
#include "shapes.h"

namespace swallowclip::biomech {
namespace {

TEST(MassProperties, BoxIsExact) {
  const auto m = massProperties(test::box({0.1, 0.2, 0.3}, {0.12, 0.23, 0.34}), 1920);
  ASSERT_TRUE(m.has_value());
  const double mass = 1920 * 0.02 * 0.03 * 0.04;
  EXPECT_NEAR(m->mass_kg, mass, 1e-15);
  EXPECT_LT((m->centre_m - Vec3(0.11, 0.215, 0.32)).norm(), 1e-15);
  const Vec3 expected =
      mass / 12 *
      Vec3(0.03 * 0.03 + 0.04 * 0.04, 0.02 * 0.02 + 0.04 * 0.04, 0.02 * 0.02 + 0.03 * 0.03);
  EXPECT_LT((m->inertia_kgm2 - Mat3(expected.asDiagonal())).norm(), 1e-12 * expected.norm());
}

TEST(MassProperties, FarFromTheOriginLosesNothing) {
  const TriMesh mesh = test::ellipsoid({0.03, 0.02, 0.01}, 3);
  const auto here = massProperties(mesh, 1000);
  const Pose pose = test::poseAt(0.7, {1, 2, 3}, {5, -7, 9});
  const auto there = massProperties({test::applied(pose, mesh.positions), mesh.triangles}, 1000);
  ASSERT_TRUE(here && there);
  const MassProperties expected = moved(*here, pose);
  EXPECT_LT((there->centre_m - expected.centre_m).norm(), 1e-13);
  EXPECT_LT((there->inertia_kgm2 - expected.inertia_kgm2).norm(),
            1e-10 * expected.inertia_kgm2.norm());
}

TEST(MassProperties, EllipsoidConvergesToTheSolid) {
  const Vec3 half(0.03, 0.02, 0.01);
  const auto m = massProperties(test::ellipsoid(half, 5), 1050);
  ASSERT_TRUE(m.has_value());
  const double mass = 1050 * 4 * kPi / 3 * half.prod();
  EXPECT_NEAR(m->mass_kg / mass, 1, 2e-3);
  EXPECT_NEAR(m->inertia_kgm2(0, 0) / (mass / 5 * (half.y() * half.y() + half.z() * half.z())), 1,
              4e-3);
}

TEST(MassProperties, RefusesOpenAndInsideOutMeshes) {
  TriMesh mesh = test::box({0, 0, 0}, {1, 1, 1});
  for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
  const auto insideOut = massProperties(mesh, 1000);
  ASSERT_FALSE(insideOut.has_value());
  EXPECT_NE(insideOut.error().remedy.find("outward"), std::string::npos);
  mesh.triangles.pop_back();
  EXPECT_FALSE(massProperties(mesh, 1000).has_value());
  EXPECT_FALSE(massProperties(test::box({0, 0, 0}, {1, 1, 1}), -1).has_value());
}

TEST(FitPose, RecoversRandomPoses) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  const TriMesh mesh = test::ellipsoid({0.03, 0.02, 0.01}, 2);
  for (int k = 0; k < 200; ++k) {
    const Pose pose = test::poseAt(kPi * u(random), {u(random), u(random), u(random)},
                                   {u(random), u(random), u(random)});
    const auto now = test::applied(pose, mesh.positions);
    const RigidFit fit = fitPose(mesh.positions, now);
    EXPECT_LT(fit.rms_m, 1e-15);
    EXPECT_LT(fit.worldFromRest.q.angularDistance(pose.q), 1e-7);
    for (size_t i = 0; i < now.size(); ++i)
      ASSERT_LT((fit.worldFromRest.apply(mesh.positions[i]) - now[i]).norm(), 1e-14);
  }
}

TEST(FitPose, NeverReflects) {
  std::vector<Vec3> rest = test::box({-1, -2, -3}, {1, 2, 3}).positions, mirrored = rest;
  for (Vec3& p : mirrored) p.x() = -p.x();
  mirrored[0] += Vec3(0.1, 0.2, 0.3);
  EXPECT_NEAR(fitPose(rest, mirrored).worldFromRest.q.toRotationMatrix().determinant(), 1, 1e-12);
  // flat, straight and single-point sets still give a rotation that fits
  const Pose pose = test::poseAt(1.1, {3, 1, 2}, {0.1, 0.2, 0.3});
  for (const std::vector<Vec3>& few :
       {std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 2, 0}},
        std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, std::vector<Vec3>{{1, 2, 3}}}) {
    const RigidFit fit = fitPose(few, test::applied(pose, few));
    EXPECT_NEAR(fit.worldFromRest.q.toRotationMatrix().determinant(), 1, 1e-12);
    EXPECT_LT(fit.rms_m, 1e-14);
  }
}

TEST(FitPose, ReportsTheResidualOfADeformedBody) {
  std::vector<Vec3> rest, now;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      for (int k = 0; k < 2; ++k) {
        rest.push_back(Vec3(i, j, k) - Vec3(0.5, 0.5, 0.5));
        now.push_back(rest.back() + Vec3(0.01 * (2 * i - 1), 0, 0));  // stretched by 2 % along x
      }
  const RigidFit fit = fitPose(rest, now);
  EXPECT_NEAR(fit.rms_m, 0.01, 1e-12);
  EXPECT_NEAR(fit.max_m, 0.01, 1e-12);
}

TEST(PoseTrack, TwistIsTheDerivativeOfThePose) {
  std::vector<Pose> poses;
  for (int k = 0; k < 20; ++k)
    poses.push_back(test::poseAt(0.3 * k + 0.1 * std::sin(k), Vec3(1, 0.1 * k, 2),
                                 Vec3(0.01 * k, 0.005 * std::sin(0.9 * k), 0)));
  const Vec3 centre(0.01, 0.02, -0.01), point(0.03, -0.01, 0.02);
  const PoseTrack track(0.1, 34, poses, centre);
  const double h_s = 1e-6;
  for (double t = 0.0; t < 0.8; t += 0.0123) {
    Pose p, before, after;
    Twist v, ignored;
    track.at(t, p, v);
    track.at(t - h_s, before, ignored);
    track.at(t + h_s, after, ignored);
    const Vec3 measured = (after.apply(point) - before.apply(point)) / (2 * h_s);
    const Vec3 arm = p.q * (point - centre);
    ASSERT_LT((measured - v.linear_ms - v.angular_rads.cross(arm)).norm(), 3e-4) << t;
  }
}

TEST(PoseTrack, PassesThroughItsPosesAndRestsOutside) {
  std::vector<Pose> poses;
  for (int k = 0; k < 8; ++k) poses.push_back(test::poseAt(1.5 * k, {0, 1, 1}, {0.01 * k, 0, 0}));
  const PoseTrack track(0, 10, poses, {0.5, 0, 0});
  Pose p;
  Twist v;
  for (int k = 0; k < 8; ++k) {
    track.at(k / 10.0, p, v);
    EXPECT_LT(p.q.angularDistance(poses[k].q), 1e-7);
    EXPECT_LT((p.t - poses[k].t).norm(), 1e-12);
  }
  track.at(55, p, v);
  EXPECT_EQ(v.linear_ms, Vec3(0, 0, 0));
  EXPECT_LT(v.angular_rads.norm(), 1e-12);
}
}  // namespace
}  // namespace swallowclip::biomech
