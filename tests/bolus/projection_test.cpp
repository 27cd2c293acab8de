// SPDX-License-Identifier: MIT
// How the solve for places makes room beside particles that a wall has stopped; and what holds a
// thick liquid together.
#include "bolus/projection.h"

#include <gtest/gtest.h>

#include <random>

namespace swallowclip::bolus {
namespace {
constexpr double kSpacing_m = 1e-3, kStep_s = 1e-4;
constexpr int kAcross = 6;

/// A block with 17 % more particles than fit, or as many as fit, far from all walls.
struct Block {
  Kernel kernel{KernelKind::cubicSpline, supportPerSpacing(KernelKind::cubicSpline) * kSpacing_m};
  KernelTable table{kernel};
  ThreadPool pool{1};
  std::vector<Vec3> places;
  Neighbours neighbours;
  std::vector<WallSample> walls;
  std::vector<std::uint8_t> beside;
  std::vector<double> density;
  std::vector<Vec3> velocities;
  Projection projection;
  Flow flow{neighbours, walls, beside, pool};

  const double half_m;  ///< from the midst to the outermost particles

  /// `astray`: each up to that many spacings from its place along every axis, by chance.
  explicit Block(double apart_m = 0.95 * kSpacing_m, int across = kAcross, double astray = 0)
      : half_m((across - 1) / 2.0 * apart_m) {
    std::mt19937 random(7);
    const auto any = [&] { return astray * (random() / 2147483648.0 - 1); };
    for (int x = 0; x < across; ++x)
      for (int y = 0; y < across; ++y)
        for (int z = 0; z < across; ++z) {
          const double dx = any(), dy = any(), dz = any();
          places.push_back(apart_m * Vec3(x + dx, y + dy, z + dz));
        }
    const std::size_t n = places.size();
    neighbours.build(places, {}, table, std::pow(kSpacing_m, 3), Vec3::Zero(), 0, pool);
    walls.resize(n);
    beside.assign(n, 0);
    velocities.assign(n, Vec3::Zero());
    density.resize(n);
    for (std::size_t i = 0; i < n; ++i) density[neighbours.id[i]] = neighbours.sumW[i];
    projection.resize(static_cast<int>(n));
    projection.tolerances = {1e-5, 1e-5, 1e-4};
    prepare(0);
  }
  void prepare(double viscosity_Pas) {
    const std::vector<double> viscosities(flow.count(), viscosity_Pas);
    projection.prepare(flow);
    projection.pushByLastPressure(flow, kStep_s, velocities, 0, flow.count());
    projection.brake(flow, {{}, viscosities, 1000}, 0, flow.count());
    projection.takeLastPressureBack(flow, kStep_s, velocities, 0, flow.count());
    projection.startFrom(flow, velocities, 0, flow.count());
  }
  void hold(double viscosity_Pas) {
    prepare(viscosity_Pas);
    projection.divergenceFree(flow, density, kStep_s, velocities, [](int, int) {});
  }
  Vec3 fromMidst(int particle) const { return places[particle] - Vec3::Constant(half_m); }
  /// Slopes of the velocity along x, y and z, least squares over the inner half.
  Vec3 stretch_s() const {
    Vec3 sums = Vec3::Zero(), squares = Vec3::Zero();
    for (std::size_t p = 0; p < places.size(); ++p) {
      const Vec3 x = fromMidst(static_cast<int>(p));
      if (x.cwiseAbs().maxCoeff() > half_m / 2) continue;
      sums += x.cwiseProduct(velocities[p]);
      squares += x.cwiseAbs2();
    }
    return sums.cwiseQuotient(squares);
  }
  bool isInFirstLayer(int particle) const { return places[particle].x() < kSpacing_m / 2; }
};

TEST(Projection, WhoIsStoppedStaysAndOthersMakeRoom) {
  Block free;
  free.projection.constantDensity(free.flow, free.density, kStep_s, free.velocities);
  Block held;
  std::vector<Vec3f> stopped(held.flow.count(), Vec3f::Zero());
  for (int i = 0; i < held.flow.count(); ++i)
    if (held.isInFirstLayer(held.flow.particle(i))) stopped[i] = -Vec3f::UnitX();
  const ProjectionReport report =
      held.projection.makeRoom(held.flow, held.density, kStep_s, stopped, held.velocities);
  EXPECT_FALSE(report.atCap);
  EXPECT_LT(report.meanError, 1e-4) << "no denser for it";
  double across = 0, along = 0, others = 0, othersFree = 0;
  for (std::size_t p = 0; p < held.places.size(); ++p) {
    if (!held.isInFirstLayer(static_cast<int>(p))) {
      others += held.velocities[p].x();
      othersFree += free.velocities[p].x();
      continue;
    }
    EXPECT_LT(free.velocities[p].x(), 0) << "nobody stops it there";
    across = std::max(across, std::abs(held.velocities[p].x()));
    along = std::max(along, std::abs(held.velocities[p].y()));
  }
  EXPECT_LT(across, 1e-6 * along) << "it may go along the wall";
  EXPECT_GT(others, 1.5 * othersFree) << "what the first layer cannot take, the others do";
}

// The smallest modes of this block need 143 iterations of Nesterov's method.
TEST(Projection, TakesFewIterationsAlsoInDisorder) {
  for (const double astray : {0.1, 0.3, 0.6, 1.0, 2.0}) {
    Block b(0.95 * kSpacing_m, 12, astray);
    const ProjectionReport report =
        b.projection.constantDensity(b.flow, b.density, kStep_s, b.velocities);
    EXPECT_LT(report.iterations, 110) << astray;
    EXPECT_LT(report.meanError, 1e-5) << astray;
  }
}

TEST(Projection, NobodyStoppedIsTheSolveForPlaces) {
  Block one, other;
  one.projection.constantDensity(one.flow, one.density, kStep_s, one.velocities);
  other.projection.makeRoom(other.flow, other.density, kStep_s,
                            std::vector<Vec3f>(other.flow.count(), Vec3f::Zero()),
                            other.velocities);
  EXPECT_EQ(one.velocities, other.velocities);
}

TEST(Projection, AThickLiquidThatIsDrawnOutBecomesThinnerNotLessDense) {
  constexpr double kRate_s = 10;
  const auto drawn = [](double viscosity_Pas) {
    Block b(kSpacing_m, 12);
    b.projection.tolerances.rate = 1e-7;
    for (std::size_t p = 0; p < b.places.size(); ++p)
      b.velocities[p] = kRate_s * b.fromMidst(static_cast<int>(p)).x() * Vec3::UnitX();
    b.hold(viscosity_Pas);
    Vec3 momentum = Vec3::Zero();
    for (const Vec3& v : b.velocities) momentum += v;
    EXPECT_LT(momentum.norm(), 1e-12);
    return b.stretch_s();
  };
  // the root of 20 nu dt is 3 mm at 5 Pa.s, half of the block, and 30 mm
  const Vec3 thin = drawn(0), thick = drawn(5), stiff = drawn(500);
  EXPECT_NEAR(thin.sum(), kRate_s, 0.01 * kRate_s) << "nothing holds it";
  EXPECT_LT(thick.y(), -0.1 * kRate_s);
  EXPECT_NEAR(thick.y(), thick.z(), 1e-3 * kRate_s);
  EXPECT_LT(thick.sum(), 0.6 * kRate_s);
  // of a lattice's layers every other one may lag, which gradW does not see
  EXPECT_LT(stiff.sum(), 0.2 * kRate_s);
  EXPECT_GT(stiff.sum(), 0) << "a rate's stress takes none back";
}

TEST(Projection, WhatStandsStillOrTurnsFeelsNothingOfIt) {
  Block still(kSpacing_m), turning(kSpacing_m);
  still.hold(5);
  for (const Vec3& v : still.velocities) EXPECT_EQ(v, Vec3::Zero());
  const Vec3 turn_s(3, -2, 5);
  for (std::size_t p = 0; p < turning.places.size(); ++p)
    turning.velocities[p] = turn_s.cross(turning.fromMidst(static_cast<int>(p)));
  const std::vector<Vec3> before = turning.velocities;
  turning.hold(5);
  for (std::size_t p = 0; p < before.size(); ++p)
    EXPECT_LT((turning.velocities[p] - before[p]).norm(), 1e-4 * turn_s.norm() * kSpacing_m) << p;
}
}  // namespace
}  // namespace swallowclip::bolus
