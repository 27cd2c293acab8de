// SPDX-License-Identifier: MIT
// What surface tension must do whatever its strength; how strong it is, scenes/verify/drop-*.json
// ask.
#include "bolus/tension.h"

#include <gtest/gtest.h>

#include "bolus/solver.h"
#include "shapes.h"

namespace swallowclip::bolus {
namespace {
constexpr double kSpacing_m = 2e-3;

WallMotion freeSpace() {
  WallMotion walls;
  walls.at = [](double, std::vector<Vec3>& x, std::vector<Vec3>& v) {
    x.clear();
    v.clear();
  };
  return walls;
}

BolusDef watery(double surfaceTension_Nm, double angle_deg = 90) {
  BolusDef d;
  d.fluid.viscosity_Pas = 0.1;
  d.fluid.surfaceTension_Nm = surfaceTension_Nm;
  d.fluid.contactAngle_rad = angle_deg * kPi / 180;
  d.gravity_ms2.setZero();
  return d;
}

std::vector<Vec3> block(const Vec3& low, int nx, int ny, int nz) {
  std::vector<Vec3> places;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        places.push_back(low + kSpacing_m * (Vec3(i, j, k) + Vec3::Constant(0.5)));
  return places;
}

/// Standard deviation along an axis.
double spread(const std::vector<Vec3>& places, int axis) {
  double mean = 0, square = 0;
  for (const Vec3& p : places) mean += p[axis] / static_cast<double>(places.size());
  for (const Vec3& p : places)
    square += std::pow(p[axis] - mean, 2) / static_cast<double>(places.size());
  return std::sqrt(square);
}

double meanHeightOnFloor(double angle_deg) {
  const WallMotion walls =
      testing::still(testing::box({-0.04, -0.04, 0}, {0.04, 0.04, 0.03}, 0.01));
  Solver s(watery(0.07, angle_deg), walls, 1);
  EXPECT_TRUE(s.place(0, block({-6e-3, -6e-3, 0}, 6, 6, 4)));
  EXPECT_TRUE(s.advanceTo(0.3));
  EXPECT_EQ(s.ledger().escaped, 0);
  double mean = 0;
  for (const Vec3& p : s.particles().positions) mean += p.z();
  return mean / static_cast<double>(s.particles().positions.size());
}

TEST(Tension, ABarDrawsTogetherAndKeepsItsMomentum) {
  const WallMotion walls = freeSpace();
  Solver s(watery(0.07), walls, 1);
  const std::vector<Vec3> bar = block({-8e-3, -8e-3, -16e-3}, 4, 4, 12);
  ASSERT_TRUE(s.place(0, bar, std::vector<Vec3>(bar.size(), Vec3(0.01, 0, 0))));
  const double before = spread(bar, 2) / spread(bar, 0);
  ASSERT_TRUE(s.advanceTo(0.4));
  const auto& p = s.particles();
  EXPECT_LT(spread(p.positions, 2) / spread(p.positions, 0), 1 + 0.2 * (before - 1));
  Vec3 mean = Vec3::Zero();
  for (const Vec3& v : p.velocities) mean += v / static_cast<double>(p.velocities.size());
  EXPECT_LT((mean - Vec3(0.01, 0, 0)).norm(), 1e-14);
}

TEST(Tension, WithoutItTheBarStays) {
  const WallMotion walls = freeSpace();
  Solver s(watery(0), walls, 1);
  const std::vector<Vec3> bar = block({-8e-3, -8e-3, -16e-3}, 4, 4, 12);
  ASSERT_TRUE(s.place(0, bar));
  ASSERT_TRUE(s.advanceTo(0.1));
  EXPECT_NEAR(spread(s.particles().positions, 2), spread(bar, 2), 0.01 * spread(bar, 2));
}

TEST(Tension, WettedFloorsSpreadTheDrop) {
  const double wetted = meanHeightOnFloor(30), neutral = meanHeightOnFloor(90),
               shed = meanHeightOnFloor(150);
  EXPECT_LT(wetted, 0.95 * neutral);
  EXPECT_GT(shed, 1.1 * neutral);
}

// At 0.5 mm and 0.07 N/m: 0.38 ms (Brackbill, Kothe & Zemach 1992) where viscosity is nothing, and
// whatever else allows where ripples can only creep (Galusinski & Vigneaux 2008).
TEST(Tension, StepsFollowCapillaryWavesUnlessTheyCreep) {
  const WallMotion walls = freeSpace();
  BolusDef def = watery(0.07);
  def.spacing_m = 5e-4;
  const auto substeps = [&](double viscosity_Pas) {
    def.fluid.viscosity_Pas = viscosity_Pas;
    Solver s(def, walls, 1);
    EXPECT_TRUE(s.place(0, {Vec3::Zero(), Vec3(4e-4, 0, 0)}));
    const auto report = s.advanceTo(0.01);
    EXPECT_TRUE(report);
    return report ? report->substeps : 0;
  };
  EXPECT_EQ(substeps(1e-3), 27);
  EXPECT_EQ(substeps(0.1), 17);
  EXPECT_EQ(substeps(1), 10);
}

// Steps four times as long as its waves would allow do not shake a thick drop.
TEST(Tension, AThickDropComesToRestInLongSteps) {
  const WallMotion walls = freeSpace();
  BolusDef def = watery(0.07);
  def.fluid.viscosity_Pas = 0.3;
  def.spacing_m = kSpacing_m / 2;
  def.longestStep_s = 5e-3;
  Solver s(def, walls, 1);
  std::vector<Vec3> cube = block({-8e-3, -8e-3, -8e-3}, 8, 8, 8);
  for (Vec3& p : cube) p /= 2;
  ASSERT_TRUE(s.place(0, cube));
  ASSERT_TRUE(s.advanceTo(1));
  double speed_ms = 0;
  for (const Vec3& v : s.particles().velocities)
    speed_ms += v.norm() / static_cast<double>(cube.size());
  EXPECT_LT(speed_ms, 2e-3) << "sigma / eta is 0.23 m/s";
}

TEST(Tension, ThreadsAndCheckpointsNeverChangeTheResult) {
  const WallMotion walls = testing::closingTube({});
  BolusDef def;
  def.swallowedAt_s_m = 0.08;
  def.fluid.surfaceTension_Nm = 0.07;
  def.fluid.contactAngle_rad = 1;
  Solver whole(def, walls, 1);
  ASSERT_TRUE(whole.seed(0, {0, 0.06}));
  ASSERT_TRUE(whole.advanceTo(0.05));
  const std::string saved = whole.save();
  ASSERT_TRUE(whole.advanceTo(0.08));
  for (int threads : {2, 3}) {
    Solver resumed(def, walls, threads);
    const auto restored = resumed.restore(saved);
    ASSERT_TRUE(restored) << restored.error().text();
    ASSERT_TRUE(resumed.advanceTo(0.08));
    EXPECT_EQ(resumed.digest(), whole.digest());
  }
  def.fluid.contactAngle_rad = 2;
  EXPECT_FALSE(Solver(def, walls, 1).restore(saved)) << "another wall, another bolus";
}

TEST(Tension, BadNumbersAreNamed) {
  Fluid f;
  for (const double bad : {-0.01, 2.0, double(NAN)}) {
    f.surfaceTension_Nm = bad;
    EXPECT_NE(f.validate().find("surfaceTension_Nm"), std::string::npos) << bad;
  }
  f.surfaceTension_Nm = 0.07;
  for (const double bad : {-0.1, 3.2, double(NAN)}) {
    f.contactAngle_rad = bad;
    EXPECT_NE(f.validate().find("contactAngle_rad"), std::string::npos) << bad;
  }
}
}  // namespace
}  // namespace swallowclip::bolus
