// SPDX-License-Identifier: MIT
// The solver on cases with known answers.
#include "bolus/solver.h"

#include <gtest/gtest.h>

#include "bolus/wall_field.h"
#include "shapes.h"

namespace swallowclip::bolus {
namespace {
BolusDef smallBolus(double viscosity_Pas) {
  BolusDef d;
  d.fluid.viscosity_Pas = viscosity_Pas;
  d.volume_m3 = 1e-6;
  return d;
}

TEST(BolusDef, FiveMillilitresAreThe621ParticlesOfTheThesis) {
  EXPECT_EQ(BolusDef{}.particleCount(), 621);
}
TEST(BolusDef, BadNumbersAreNamed) {
  const WallMotion walls = testing::still(testing::box({0, 0, 0}, {0.02, 0.02, 0.02}, 2e-3));
  BolusDef d;
  d.spacing_m = 0;
  Solver s(BolusDef{}, walls, 1);
  d.spacing_m = -1;
  EXPECT_NE(d.validate().find("spacing_m"), std::string::npos);
}

TEST(Solver, FreeFall) {
  const WallMotion walls = testing::still(testing::box({-0.1, -0.1, -0.5}, {0.1, 0.1, 0.1}, 0.02));
  Solver s(smallBolus(1), walls, 1);
  std::vector<Vec3> drop;
  for (int i = 0; i < 64; ++i) drop.push_back(2e-3 * Vec3(i % 4, i / 4 % 4, i / 16));
  ASSERT_TRUE(s.place(0, drop));
  ASSERT_TRUE(s.advanceTo(0.2));
  const double v = s.particles().velocities[0].z();
  EXPECT_NEAR(v, -9.81 * 0.2, 1e-6);
  // symplectic Euler falls dt v / 2 too far
  EXPECT_NEAR(s.particles().positions[0].z(), -0.5 * 9.81 * 0.04, 2e-3);
  EXPECT_NEAR((s.particles().positions[63] - s.particles().positions[0]).norm(),
              2e-3 * std::sqrt(27.), 2e-5);
}

// So thin that neighbours rub once in four steps, for the time of all four: as fast as ever. The
// lattice hardly moves, so that nothing but viscosity slows it.
TEST(Solver, AThinFluidsShearWaveDecaysAsViscositySays) {
  const WallMotion walls =
      testing::still(testing::box({-0.05, -0.05, -0.05}, {0.06, 0.06, 0.06}, 0.01));
  BolusDef d = smallBolus(2e-4);
  d.spacing_m = 1e-3;
  d.gravity_ms2.setZero();
  d.period_m = Vec3::Constant(6e-3);
  d.full = true;
  Solver s(d, walls, 1);
  const double k = 2 * kPi / d.period_m.y(), fastest_ms = 1e-5;
  std::vector<Vec3> x, v;
  for (int i = 0; i < 216; ++i) {
    x.push_back(d.spacing_m * (Vec3(i % 6, i / 6 % 6, i / 36) + Vec3::Constant(0.5)));
    v.push_back({fastest_ms * std::sin(k * x.back().y()), 0, 0});
  }
  ASSERT_TRUE(s.place(0, x, v));
  const double end_s = 1;
  ASSERT_TRUE(s.advanceTo(end_s));
  EXPECT_GT(s.stats().steps, 500);
  double amplitude_ms = 0;
  for (int i = 0; i < 216; ++i)
    amplitude_ms += s.particles().velocities[i].x() * std::sin(k * x[i].y()) * 2 / 216;
  const double rate_s = -std::log(amplitude_ms / fastest_ms) / end_s;
  // six particles a wave length: the sum over pairs is a few percent off
  EXPECT_NEAR(rate_s, d.fluid.viscosity_Pas / d.fluid.density_kgm3 * k * k, 0.1 * rate_s);
}

// What only one pressure everywhere could meet is not met: it would rise without end.
TEST(Solver, TheLevelOfPressureInAFullRoomIsNotLookedFor) {
  const WallMotion walls =
      testing::still(testing::box({-0.05, -0.05, -0.05}, {0.06, 0.06, 0.06}, 0.01));
  BolusDef d = smallBolus(1);
  d.spacing_m = 1e-3;
  d.gravity_ms2 = {3, 0, 0};
  d.period_m = Vec3::Constant(8e-3);
  d.full = true;
  d.solveShare = 1e-4;
  Solver s(d, walls, 1);
  std::vector<Vec3> x, v;
  for (int i = 0; i < 512; ++i) {
    x.push_back(d.spacing_m * (Vec3(i % 8, i / 8 % 8, i / 64) + Vec3::Constant(0.5)));
    v.push_back({0.02 * std::sin(2 * kPi / d.period_m.y() * x.back().y()), 0, 0});
  }
  ASSERT_TRUE(s.place(0, x, v));
  ASSERT_TRUE(s.mix(0));
  ASSERT_TRUE(s.advanceTo(0.2));
  EXPECT_LT(s.stats().rateIterations, 100 * s.stats().steps);
  double mean_Pa = 0;
  for (const double p_Pa : s.particles().pressure_Pa) mean_Pa += p_Pa / 512;
  EXPECT_NEAR(mean_Pa, 0, 1e-3);
}

// A lump of honey turns in free space: no stress at its surface, so nothing slows it. (Where du/dn
// vanishes there instead, the first millisecond takes a fifth.)
TEST(Solver, ALumpOfHoneyKeepsTurning) {
  const WallMotion walls =
      testing::still(testing::box({-0.05, -0.05, -0.05}, {0.05, 0.05, 0.05}, 0.01));
  BolusDef d = smallBolus(5);
  d.spacing_m = 1e-3;
  d.gravity_ms2.setZero();
  Solver s(d, walls, 1);
  const Vec3 turn_s(0, 0, 5);
  std::vector<Vec3> x, v;
  for (int i = 0; i < 13 * 13 * 13; ++i) {
    const Vec3 at = d.spacing_m * Vec3(i % 13 - 6, i / 13 % 13 - 6, i / 169 - 6);
    if (at.norm() > 6.2e-3) continue;
    x.push_back(at);
    v.push_back(turn_s.cross(at));
  }
  ASSERT_TRUE(s.place(0, x, v));
  const auto angularMomentum = [](const std::vector<Vec3>& at, const std::vector<Vec3>& velocity) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < at.size(); ++i) sum += at[i].cross(velocity[i]);
    return sum;
  };
  const Vec3 before = angularMomentum(x, v);
  ASSERT_TRUE(s.advanceTo(0.1));
  const Vec3 after = angularMomentum(s.particles().positions, s.particles().velocities);
  EXPECT_LT((after - before).norm(), 0.01 * before.norm()) << after.z() / before.z();
  Vec3 momentum = Vec3::Zero();
  for (const Vec3& each : s.particles().velocities) momentum += each;
  EXPECT_LT(momentum.norm(), 1e-9 * turn_s.norm());
}

// One particle too many among so many that the mean hardly shows it. Steps are a tenth of the time
// in which compression spreads: what each may leave must not stay for good.
TEST(Solver, ALumpSpreadsInShortStepsToo) {
  const WallMotion walls =
      testing::still(testing::box({-0.05, -0.05, -0.05}, {0.05, 0.05, 0.05}, 0.01));
  BolusDef d = smallBolus(5);
  d.spacing_m = 1e-3;
  d.gravity_ms2.setZero();
  d.longestStep_s = 1e-5;
  Solver s(d, walls, 1);
  std::vector<Vec3> x{Vec3::Constant(0.5e-3)};
  for (int i = 0; i < 12 * 12 * 12; ++i)
    x.push_back(d.spacing_m * Vec3(i % 12 - 6, i / 12 % 12 - 6, i / 144 - 6));
  ASSERT_TRUE(s.place(0, x));
  const auto densest = [&] { return std::ranges::max(s.particles().densityRatio); };
  const double before = densest();
  EXPECT_GT(before, 1.1);
  ASSERT_TRUE(s.advanceTo(2e-3));
  EXPECT_LT(densest(), 1.03) << "from " << before;
}

// A wall out of reach that hurries for a moment and then creeps up: it is felt when it is there.
TEST(Solver, AWallThatHurriedIsNotForgotten) {
  const double spacing_m = 1e-3, from_s = 1e-3, for_s = 10e-3, slow_ms = 5e-3, more_ms = 0.175;
  const testing::Mesh mesh = testing::box({0, 0, 0}, {0.012, 0.012, 0.012}, 0.5e-3);
  WallMotion walls = testing::still(mesh);
  walls.standsStill = false;
  const auto moved_m = [=](double t_s) {
    const double x = std::clamp((t_s - from_s) / for_s, 0.0, 1.0);
    return slow_ms * t_s + more_ms * for_s * (x / 2 - std::sin(2 * kPi * x) / (4 * kPi));
  };
  walls.at = [&](double t_s, std::vector<Vec3>& x, std::vector<Vec3>& v) {
    const double phase = std::clamp((t_s - from_s) / for_s, 0.0, 1.0);
    x = mesh.positions;
    for (Vec3& p : x) p.x() += moved_m(t_s);
    v.assign(x.size(), Vec3(slow_ms + more_ms * std::pow(std::sin(kPi * phase), 2), 0, 0));
  };
  BolusDef def;
  def.spacing_m = spacing_m;
  def.gravity_ms2 = Vec3::Zero();
  Solver solver(def, walls, 1);
  const Vec3 place(3.9e-3, 6e-3, 6e-3);
  ASSERT_TRUE(solver.place(0, {place}));
  const double alone = solver.particles().densityRatio[0];
  const KernelTable table{Kernel(def.kernel, 2 * spacing_m)};
  for (double t_s : {0.012, 0.1, 0.2, 0.25, 0.29, 0.33}) {
    ASSERT_TRUE(solver.advanceTo(t_s));
    WallField field(table, spacing_m);
    std::vector<Vec3> x, v;
    walls.at(t_s, x, v);
    field.build(walls.triangles, x, v, place, place);
    const Vec3& now = solver.particles().positions[0];
    EXPECT_NEAR(solver.particles().densityRatio[0] - alone, field.sample(now).lambda, 2e-4) << t_s;
  }
  EXPECT_GT(solver.particles().densityRatio[0] - alone, 1e-3);
}
TEST(Solver, SurfaceMustBeClosed) {
  testing::Mesh mesh = testing::box({0, 0, 0}, {0.02, 0.02, 0.02}, 2e-3);
  mesh.triangles.pop_back();
  const WallMotion walls = testing::still(mesh);
  Solver s(smallBolus(1), walls, 1);
  const auto r = s.seed(0, {});
  ASSERT_FALSE(r);
  EXPECT_NE(r.error().problem.find("open"), std::string::npos);
}

TEST(Solver, TooSmallRoomIsSaid) {
  const WallMotion walls = testing::still(testing::box({0, 0, 0}, {0.008, 0.008, 0.008}, 2e-3));
  Solver s(smallBolus(1), walls, 1);
  const auto r = s.seed(0, {});
  ASSERT_FALSE(r);
  EXPECT_NE(r.error().problem.find("places for"), std::string::npos);
}

TEST(Solver, HydrostaticColumn) {
  // 12 x 12 mm column: 5 mL stand 34.5 mm high
  const WallMotion walls = testing::still(testing::box({0, 0, 0}, {0.012, 0.012, 0.05}, 1.5e-3));
  BolusDef d;
  d.fluid.viscosity_Pas = 0.1;
  Solver s(d, walls, 2);
  ASSERT_TRUE(s.seed(0, {}));
  const auto rest = s.relax(0);
  ASSERT_TRUE(rest) << rest.error().text();
  EXPECT_TRUE(rest->atRest) << rest->maxDrift_ms << " " << rest->meanDrift_ms;
  ASSERT_TRUE(s.advanceTo(0.2));
  EXPECT_LT(s.stats().meanDensityError, 3e-3);
  EXPECT_LT(s.stats().maxDensityError, 0.05);
  EXPECT_EQ(s.ledger().fluid, 621);
  EXPECT_EQ(s.ledger().escaped, 0);
  double top = 0, middle = 0;
  for (const Vec3& p : s.particles().positions) {
    top = std::max(top, p.z());
    middle += p.z() / 621;
  }
  const double height = d.particleCount() * 8e-9 / 0.012 / 0.012;
  EXPECT_NEAR(middle, height / 2, 0.05 * height) << "top " << top;
  EXPECT_NEAR(top, height - 1e-3, 2e-3);
}

TEST(Solver, ThreadsNeverChangeTheResult) {
  const WallMotion walls = testing::closingTube({});
  std::uint64_t digest[3];
  for (int threads = 1; threads <= 3; ++threads) {
    BolusDef d;
    d.swallowedAt_s_m = 0.08;
    Solver s(d, walls, threads);
    ASSERT_TRUE(s.seed(0, {0, 0.06}));
    ASSERT_TRUE(s.advanceTo(0.03));
    digest[threads - 1] = s.digest();
  }
  EXPECT_EQ(digest[0], digest[1]);
  EXPECT_EQ(digest[0], digest[2]);
}

TEST(Solver, SealedPocketIsReported) {
  // the tube ends at 50 mm and the wave runs to its end: 5 mL have nowhere to go
  testing::TubeDef tube;
  tube.length_m = 0.05;
  const WallMotion walls = testing::closingTube(tube);
  BolusDef d;
  d.swallowedAt_s_m = 1;
  Solver s(d, walls, 2);
  ASSERT_TRUE(s.seed(0, {}));
  Result<StepReport> r;
  for (int frame = 1; frame <= 20 && (r = s.advanceTo(frame / 30.0)); ++frame) {
  }
  ASSERT_FALSE(r);
  EXPECT_NE(r.error().problem.find("sealed pocket"), std::string::npos) << r.error().text();
  EXPECT_NE(r.error().place.find("s = "), std::string::npos) << r.error().text();
}
}  // namespace
}  // namespace swallowclip::bolus
