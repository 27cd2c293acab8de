// SPDX-License-Identifier: MIT
// What is left: shares, places, thickness and lateral areas of heaps with known answers.
#include <gtest/gtest.h>

#include <random>

#include "fake_swallow.h"
#include "scoring/residue_area.h"

namespace swallowclip::scoring {
namespace {
using namespace testing;
using frame::Region;

/// 625 particles of 8 mm^3 (5 mL); those not placed are swallowed.
struct Heap {
  frame::History h;
  int used = 0;

  explicit Heap() {
    FakeSwallow f{.duration_s = 0.2, .particles = 625};
    h = makeHistory(f);
    for (auto& state : h.bolus.state)
      std::fill(state.begin(), state.end(), frame::ParticleState::swallowed);
  }
  /// At path coordinate s, width u, height above the floor (-8 mm) of the channel.
  void put(double s_m, double u, double above_m, Region region) {
    for (int f = 0; f < h.frames(); ++f) {
      h.bolus.state[f][used] = frame::ParticleState::fluid;
      h.bolus.region[f][used] = region;
      h.bolus.positions[f][used] = Vec3(0.010 * u, s_m, -0.008 + above_m).cast<float>();
    }
    ++used;
  }
  Residue residue() const { return measureResidue(h, 1, testRules()).value(); }
};

TEST(Residue, OneMillilitreInTheLeftSulcus) {
  Heap heap;
  for (int k = 0; k < 125; ++k)  // 1 mL
    heap.put(0.030 + 0.002 * (k % 10), 0.9, 0.001 + 0.0005 * (k / 10), Region::oral);
  const Residue r = heap.residue();
  EXPECT_EQ(r.frame, 1);
  EXPECT_NEAR(r.volume_m3(Location::sulcusLeft) * 1e6, 1.0, 1e-9);
  EXPECT_EQ(r.volume_m3(Location::sulcusRight), 0);
  EXPECT_NEAR(r.volume_m3(5) / r.offered_m3, 0.2, 1e-12);
  const ComponentReport five = measureResidueComponent(5, r, testRules());
  EXPECT_EQ(five.decision.score, 2) << five.decision.reason;
  EXPECT_NE(five.decision.reason.find("at D"), std::string::npos);
  EXPECT_EQ(measureResidueComponent(16, r, testRules()).decision.score, 0);
}

TEST(Residue, EveryPlaceHasItsName) {
  struct Place {
    double s_mm, u, above_mm;
    Region region;
    Location location;
  };
  const Place places[] = {{3, 0, 0.5, Region::oral, Location::floorOfMouth},
                          {30, 0, 7.5, Region::oral, Location::palate},
                          {30, 0, 0.5, Region::oral, Location::tongue},
                          {30, -0.9, 0.5, Region::oral, Location::sulcusRight},
                          {90, 0, 0.5, Region::oropharynx, Location::tongueBase},
                          {105, 0.4, 0.5, Region::oropharynx, Location::valleculaLeft},
                          {105, -0.4, 0.5, Region::oropharynx, Location::valleculaRight},
                          {100, 0, 7.5, Region::oropharynx, Location::pharyngealWall},
                          {125, 0, 0.5, Region::hypopharynx, Location::folds},
                          {135, 0.75, 0.5, Region::hypopharynx, Location::pyriformLeft},
                          {135, -0.75, 0.5, Region::hypopharynx, Location::pyriformRight},
                          {120, 0, 0.5, Region::larynx, Location::elsewhere}};
  for (const Place& p : places) {
    Heap heap;
    heap.put(p.s_mm * kMm, p.u, p.above_mm * kMm, p.region);
    EXPECT_EQ(heap.residue().deposits.at(0).location, p.location)
        << name(p.location) << " at s " << p.s_mm << ", u " << p.u;
  }
}

TEST(Residue, AFullSheetOfParticlesIsAsThickAsItsSpacing) {
  Heap heap;
  for (int i = 0; i < 10; ++i)
    for (int j = -2; j <= 2; ++j)  // 2 mm apart
      heap.put(0.030 + 0.002 * i, 0.2 * j, 0.001, Region::oral);
  // Balls within 4 mm of the middle: 13 of 8 mm^3 over 50.3 mm^2.
  EXPECT_NEAR(heap.residue().thickness_m(5, 0.0041), 13 * 8e-9 / (kPi * 0.0041 * 0.0041), 1e-9);
  EXPECT_NEAR(heap.residue().thickness_m(5, 0.0041), 0.002, 0.0001);
}

TEST(Residue, FilmCountsWithItsAreaAndThickness) {
  Heap heap;
  heap.h.skin.film_m.assign(heap.h.frames(), std::vector<float>(heap.h.skin.triangles.size(), 0));
  // 0.12 mm over the roof from 0 to 48 mm, 20 mm wide: 0.1152 mL, 2.3 % of V0.
  const std::size_t half = heap.h.skin.s_m.size() / 2;
  for (auto& film : heap.h.skin.film_m)
    for (std::size_t t = 0; t < film.size(); ++t) {
      const Triangle& tri = heap.h.skin.triangles[t];
      bool roof = true;
      for (int v : tri) roof &= v >= static_cast<int>(half) && heap.h.skin.s_m[v] < 0.0481;
      if (roof) film[t] = 0.12e-3f;
    }
  const Residue r = heap.residue();
  EXPECT_NEAR(r.volume_m3(5) * 1e6, 0.12 * 48 * 20 * 1e-3, 1e-4);
  EXPECT_NEAR(r.thickness_m(5, 0.004), 0.12e-3, 1e-9);
  EXPECT_EQ(measureResidueComponent(5, r, testRules()).decision.score, 1);
}

TEST(Residue, RuleTable) {
  const auto score = [](double share, double thick_mm) {
    return scoreResidue({share, thick_mm * kMm}, testRules());
  };
  EXPECT_EQ(score(0.005, 0.1), 0);
  EXPECT_EQ(score(0.03, 0.1), 1);
  EXPECT_EQ(score(0.03, 2.0), 2);
  EXPECT_EQ(score(0.2, 0.1), 2);
  EXPECT_EQ(score(0.7, 3), 3);
  EXPECT_EQ(score(0.95, 3), 4);
}

TEST(Residue, WaitsForWhatStillMoves) {
  Heap heap;
  heap.put(0.030, 0, 0.001, Region::oral);
  for (int f = 0; f < 4; ++f) heap.h.bolus.velocities[f][0] = Vec3f(0, 0.05f, 0);
  EXPECT_EQ(heap.residue().frame, 4);
  EXPECT_EQ(measureResidue(heap.h, {}, testRules())->frame, heap.h.frames() - 1);
}

TEST(ResidueArea, PocketsUnderALevelLine) {
  // A triangle 10 mm wide and 6 mm deep; one rim is 2 mm higher and does not count.
  EXPECT_NEAR(pocketArea_m2({{0, 0}, {0.005, -0.006}, {0.010, 0}}), 30e-6, 1e-12);
  EXPECT_NEAR(pocketArea_m2({{-0.005, 0.002}, {0, 0}, {0.005, -0.006}, {0.010, 0}}), 30e-6, 1e-12);
  EXPECT_EQ(pocketArea_m2({{0, 0}, {0.005, -0.006}, {0.010, -0.01}}), 0);
}

TEST(ResidueArea, ABallThrowsItsDiscAndABruteForceTwinAgrees) {
  Deposit one;
  one.volume_m3 = 4.0 / 3 * kPi * std::pow(0.005, 3);
  // Seen where the chord is at least 0.5 mm: a disc of radius sqrt(5^2 - 0.25^2) mm.
  // Pixels of 0.25 mm along a rim of 31 mm leave 1 % to chance.
  EXPECT_NEAR(projectedArea_m2({one}, 0.5e-3), kPi * (25e-6 - 0.0625e-6), 0.8e-6);

  std::mt19937 rng(3);
  std::uniform_real_distribution<double> place(-0.006, 0.006);
  std::vector<Deposit> drops(40);
  for (Deposit& d : drops)
    d.volume_m3 = 8e-9, d.position = Vec3(place(rng), place(rng), place(rng));
  // Twin: rays through random points of a square, every ball asked.
  const double r = std::cbrt(3 * 8e-9 / (4 * kPi)), side = 0.020;
  std::uniform_real_distribution<double> ray(-side / 2, side / 2);
  int seen = 0;
  constexpr int kRays = 200000;
  for (int k = 0; k < kRays; ++k) {
    const double y = ray(rng), z = ray(rng);
    double chord = 0;
    for (const Deposit& d : drops) {
      const double q = r * r - std::pow(y - d.position.y(), 2) - std::pow(z - d.position.z(), 2);
      if (q > 0) chord += 2 * std::sqrt(q);
    }
    seen += chord >= 0.5e-3;
  }
  EXPECT_NEAR(projectedArea_m2(drops, 0.5e-3), side * side * seen / kRays, 1.5e-6);
}
}  // namespace
}  // namespace swallowclip::scoring
