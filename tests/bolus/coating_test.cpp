// SPDX-License-Identifier: MIT
// The coating of walls: its law, and that it makes and loses nothing.
#include "bolus/coating.h"

#include <gtest/gtest.h>

#include "bolus/solver.h"
#include "shapes.h"

namespace swallowclip::bolus {
namespace {
Fluid coats(double viscosity_Pas) {
  Fluid f;
  f.viscosity_Pas = viscosity_Pas;
  f.coatingTension_Nm = 0.06;
  return f;
}
/// A thin bolus that a closing tube squirts along, so that walls are left, wetted again and shut.
BolusDef thin() {
  BolusDef d;
  d.fluid = coats(0.02);
  d.volume_m3 = 3e-6;
  d.swallowedAt_s_m = 0.08;
  return d;
}
constexpr double kStart_s = 0.35, kEnd_s = 0.42;

TEST(FilmThickness, IsThatOfLandauAndLevichOrOfBretherton) {
  const Fluid f = coats(0.006);  // Ca = U / 10 m/s
  const double capillary_m = std::sqrt(0.06 / 9810);
  EXPECT_NEAR(filmThickness_m(f, 9.81, 0.01, 1), 0.944 * capillary_m * 0.01, 1e-9);
  EXPECT_NEAR(filmThickness_m(f, 0, 0.01, 1e-3), 1.34e-5 / 1.0335, 1e-9);
  EXPECT_EQ(filmThickness_m(f, 9.81, 0, 1e-3), 0);
  const double ratio = filmThickness_m(f, 9.81, 0.08, 1) / filmThickness_m(f, 9.81, 0.01, 1);
  EXPECT_NEAR(ratio, 4, 1e-9);
}

TEST(FilmThickness, TakesTheViscosityOfTheFilmsOwnShear) {
  Fluid f = coats(1);
  f.model = RheologyModel::powerLaw;
  f.consistency_Pasn = 3;
  f.index = 0.4;
  const double h = filmThickness_m(f, 9.81, 0.05, 4e-3);
  Fluid same = coats(apparentViscosity_Pas(f, 0.05 / h));
  EXPECT_NEAR(filmThickness_m(same, 9.81, 0.05, 4e-3), h, 1e-6 * h);
}

TEST(Coating, MakesAndLosesNothing) {
  const WallMotion walls = testing::closingTube({});
  Solver s(thin(), walls, 1);
  ASSERT_TRUE(s.seed(0, {0, 0.06}));
  ASSERT_TRUE(s.relax(0, 0.05));
  double most_m3 = 0;
  for (int k = 1; k <= 24; ++k) {
    const auto ok = s.advanceTo(0.025 * k);
    ASSERT_TRUE(ok) << ok.error().text();
    const Ledger l = s.ledger();
    EXPECT_NEAR((l.particles_m3 + l.coating_m3) / l.start_m3, 1, 1e-12);
    EXPECT_EQ(l.start, l.fluid + l.film + l.swallowed + l.coating);
    EXPECT_EQ(l.escaped, 0);
    for (const double v : s.coating().volume_m3()) EXPECT_GE(v, 0);
    for (const double v : s.coating().lent_m3())
      EXPECT_TRUE(v >= 0 && v <= s.particleVolume_m3()) << v;
    most_m3 = std::max(most_m3, l.coating_m3);
  }
  EXPECT_GT(most_m3, 1e-8) << "the walls were never coated";
}

TEST(Coating, GoesOnToTheBitWithAnyNumberOfThreads) {
  const WallMotion walls = testing::closingTube({});
  Solver whole(thin(), walls, 1);
  ASSERT_TRUE(whole.seed(0, {0, 0.06}));
  ASSERT_TRUE(whole.relax(0, 0.05));
  ASSERT_TRUE(whole.advanceTo(kStart_s));
  ASSERT_GT(whole.ledger().coating_m3, 0);
  const std::string saved = whole.save();
  ASSERT_TRUE(whole.advanceTo(kEnd_s));
  for (const int threads : {1, 2, 3}) {
    Solver resumed(thin(), walls, threads);
    ASSERT_TRUE(resumed.restore(saved));
    ASSERT_TRUE(resumed.advanceTo(kEnd_s));
    EXPECT_EQ(resumed.digest(), whole.digest()) << threads;
    EXPECT_EQ(resumed.coating().volume_m3(), whole.coating().volume_m3()) << threads;
    EXPECT_EQ(resumed.coating().lent_m3(), whole.coating().lent_m3()) << threads;
  }
}

TEST(Coating, IsOffUnlessAskedFor) {
  const WallMotion walls = testing::closingTube({});
  BolusDef def = thin();
  def.fluid.coatingTension_Nm = 0;
  Solver s(def, walls, 1);
  ASSERT_TRUE(s.seed(0, {0, 0.06}));
  EXPECT_FALSE(s.coating().on());
  EXPECT_TRUE(s.coatingThickness_m().empty());
  EXPECT_EQ(s.ledger().coating_m3, 0);
  EXPECT_EQ(s.ledger().particles_m3, s.ledger().start_m3);
}
}  // namespace
}  // namespace swallowclip::bolus
