// SPDX-License-Identifier: MIT
// How the solve for places makes room beside particles that a wall has stopped.
#include "bolus/projection.h"

#include <gtest/gtest.h>

namespace swallowclip::bolus {
namespace {
constexpr double kSpacing_m = 1e-3, kStep_s = 1e-4;
constexpr int kAcross = 6;

/// A block with 17 % more particles than fit, far from all walls.
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

  Block() {
    const double apart_m = 0.95 * kSpacing_m;
    for (int x = 0; x < kAcross; ++x)
      for (int y = 0; y < kAcross; ++y)
        for (int z = 0; z < kAcross; ++z) places.push_back(apart_m * Vec3(x, y, z));
    const std::size_t n = places.size();
    neighbours.build(places, {}, table, std::pow(kSpacing_m, 3), Vec3::Zero(), 0, pool);
    walls.resize(n);
    beside.assign(n, 0);
    velocities.assign(n, Vec3::Zero());
    density.resize(n);
    for (std::size_t i = 0; i < n; ++i) density[neighbours.id[i]] = neighbours.sumW[i];
    projection.resize(static_cast<int>(n));
    projection.tolerances = {1e-5, 1e-5, 1e-4};
    projection.prepare(flow);
    projection.pushByLastPressure(flow, kStep_s, velocities, 0, flow.count());
    projection.brake(flow, {}, 0, flow.count());
    projection.takeLastPressureBack(flow, kStep_s, velocities, 0, flow.count());
    projection.startFrom(flow, velocities, 0, flow.count());
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

TEST(Projection, NobodyStoppedIsTheSolveForPlaces) {
  Block one, other;
  one.projection.constantDensity(one.flow, one.density, kStep_s, one.velocities);
  other.projection.makeRoom(other.flow, other.density, kStep_s,
                            std::vector<Vec3f>(other.flow.count(), Vec3f::Zero()),
                            other.velocities);
  EXPECT_EQ(one.velocities, other.velocities);
}
}  // namespace
}  // namespace swallowclip::bolus
