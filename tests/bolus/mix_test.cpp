// SPDX-License-Identifier: MIT
// Fluid that is put into disorder lies as evenly as before, moves as before and stays where it is.
#include <gtest/gtest.h>

#include "bolus/solver.h"
#include "shapes.h"

namespace swallowclip::bolus {
namespace {
constexpr double kSpacing_m = 1e-3;
constexpr int kSide = 10;

struct Lattice {
  std::vector<Vec3> places, velocities;
};
Lattice cube(const Vec3& low) {
  Lattice l;
  for (int i = 0; i < kSide * kSide * kSide; ++i) {
    const Vec3 cell(i % kSide, i / kSide % kSide, i / kSide / kSide);
    l.places.push_back(low + kSpacing_m * (cell + Vec3::Constant(0.5)));
    l.velocities.push_back(0.1 * cell);
  }
  return l;
}
BolusDef definition() {
  BolusDef d;
  d.fluid.viscosity_Pas = 1;
  d.spacing_m = kSpacing_m;
  d.volume_m3 = std::pow(kSide * kSpacing_m, 3);
  return d;
}

TEST(Mix, PutsALatticeIntoDisorderThatIsEven) {
  const double side_m = kSide * kSpacing_m;
  const WallMotion walls =
      testing::still(testing::box(Vec3::Zero(), Vec3::Constant(side_m), 2 * kSpacing_m));
  BolusDef d = definition();
  d.full = true;
  const Lattice start = cube(Vec3::Zero());
  std::uint64_t digest[2];
  for (int threads = 1; threads <= 2; ++threads) {
    Solver s(d, walls, threads);
    ASSERT_TRUE(s.place(0, start.places, start.velocities));
    ASSERT_TRUE(s.mix(0));
    digest[threads - 1] = s.digest();
    const Particles& p = s.particles();
    double moved2 = 0, mean = 0, off = 0, least = INFINITY;
    for (std::size_t i = 0; i < start.places.size(); ++i) {
      moved2 += (p.positions[i] - start.places[i]).squaredNorm() / start.places.size();
      mean += p.densityRatio[i] / start.places.size();
      EXPECT_EQ(p.velocities[i], start.velocities[i]);
      for (std::size_t j = 0; j < i; ++j)
        least = std::min(least, (p.positions[i] - p.positions[j]).norm());
    }
    for (double ratio : p.densityRatio) off = std::max(off, std::abs(ratio - mean));
    EXPECT_GT(std::sqrt(moved2), 0.1 * kSpacing_m);
    EXPECT_GT(least, 0.6 * kSpacing_m);
    EXPECT_LT(off, 0.03);
    EXPECT_EQ(s.ledger().escaped, 0);
  }
  EXPECT_EQ(digest[0], digest[1]);
}

TEST(Mix, LeavesWhatFloatsWhereItIs) {
  const WallMotion nothing = testing::still({});
  Solver s(definition(), nothing, 1);
  const Lattice start = cube({0, 0, 0.1});
  ASSERT_TRUE(s.place(0, start.places));
  ASSERT_TRUE(s.mix(0));
  Vec3 drift = Vec3::Zero();
  for (std::size_t i = 0; i < start.places.size(); ++i)
    drift += (s.particles().positions[i] - start.places[i]) / start.places.size();
  EXPECT_LT(drift.norm(), 1e-12);
}
}  // namespace
}  // namespace swallowclip::bolus
