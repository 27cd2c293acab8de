// SPDX-License-Identifier: MIT
#include "bolus/tension.h"

#include <algorithm>
#include <cmath>

namespace swallowclip::bolus {
namespace {
// Share of the density's own kernel taken off the attraction. Measured on drops of 5 to 12 mm at 1
// mm: at 0 and 0.3 surfaces go on packing for seconds, and Laplace's pressure creeps from 0.7 to
// 1.6 times its value; at 0.55 to 0.65 it settles within 10 % of it, without a factor; from 0.7 on
// surfaces fray (6 mm: pressure varies by a fifth across the drop).
constexpr double kTakenOff = 0.6;

// Farther than this, relative to the walls, from where walls were last integrated, or when the
// fastest walls have gone that far, it is done again: spacings, both assumed (0.1 to 0.2, 0.2 to
// 0.5).
constexpr double kHeldMove = 0.15, kHeldMoveOfWalls = 0.3;

double meanDistance_m(const Kernel& kernel) {  // int r W dV, by the midpoint rule
  constexpr int kSteps = 2000;
  const double step = kernel.support_m() / kSteps;
  double sum = 0;
  for (int k = 0; k < kSteps; ++k) {
    const double r = (k + 0.5) * step;
    sum += 4 * kPi * r * r * r * kernel.w(r) * step;
  }
  return sum;
}
}  // namespace

// The shortest capillary wave that particles resolve must not cross a spacing within a step: dt^2 <
// (rho + rho_air) / 2 dx^3 / (2 pi sigma), Brackbill, Kothe & Zemach 1992, eq. 61, with weightless
// air.
Tension::Tension(const Fluid& fluid, const Kernel& own, double spacing_m)
    : density_kgm3_(fluid.density_kgm3),
      spacing_m_(spacing_m),
      longestStep_s_(std::sqrt(fluid.density_kgm3 * std::pow(spacing_m, 3) /
                               (4 * kPi * fluid.surfaceTension_Nm))),
      kernel_(KernelKind::cubicSpline, kTensionReach * spacing_m),
      table_(kernel_),
      field_(table_, spacing_m) {
  const double reach_m = meanDistance_m(kernel_) - kTakenOff * meanDistance_m(own);
  attraction_m2s2_ = 8 * fluid.surfaceTension_Nm / (fluid.density_kgm3 * reach_m);
  adhesion_m2s2_ = attraction_m2s2_ * (1 + std::cos(fluid.contactAngle_rad)) / 2;
}

// sum attraction g_ij, and what it transmits: that of a pressure of minus half of it everywhere.
void Tension::add(const Flow& flow, const Neighbours& pairs, double attraction) {
  const int n = pairs.count;
  half_.assign(n + 1, static_cast<float>(attraction / 2));
  transmitted_.assign(n + 1, 0.f);
  force_.resize(3 * n);
  const GradientSweep gradient{pairs.lists(), half_.data(), force_.data(), pairs.r.data(),
                               transmitted_.data()};
  flow.sweep([&](int begin, int end, int) {
    gradient.run(begin, end);
    for (int i = begin; i < end; ++i) {
      acceleration_[pairs.id[i]] += Vec3(&force_[3 * i]);
      stress_[pairs.id[i]] -= transmitted_[i];
    }
  });
}

void Tension::measure(const Flow& flow, std::span<const Vec3> positions,
                      std::span<const std::uint8_t> active, const Walls& walls,
                      const Vec3& period_m) {
  neighbours_.build(positions, active, table_, std::pow(spacing_m_, 3), period_m, 0, flow.pool);
  acceleration_.assign(positions.size(), Vec3::Zero());
  stress_.assign(positions.size(), 0.0);
  add(flow, neighbours_, attraction_m2s2_);
  add(flow, flow.neighbours, -kTakenOff * attraction_m2s2_);
  if (walls.triangles.empty() || adhesion_m2s2_ == 0) return;
  due_.resize(flow.count());
  flow.sweep([&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      const int p = flow.particle(i);
      held_[p].fastestWall_ms = std::max(held_[p].fastestWall_ms, walls.fastest_ms);
      due_[i] = isDue(held_[p], positions[p], walls.time_s);
    }
  });
  if (std::ranges::find(due_, 1) != due_.end())
    field_.follow(walls.field, walls.triangles, walls.positions, walls.velocities, walls.skipped);
  flow.sweep([&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      const int p = flow.particle(i);
      const Vec3& x = positions[p];
      HeldWalls& h = held_[p];
      if (due_[i]) h = {field_.sample(x), x, walls.time_s, walls.fastest_ms};
      const WallSample far = field_.nearTo(h.sample, x - h.place, walls.time_s - h.time_s);
      const WallSample& near = flow.wall(i);
      acceleration_[p] += adhesion_m2s2_ * (far.gradLambda - kTakenOff * near.gradLambda);
      stress_[p] -= adhesion_m2s2_ / 2 * (far.lambdaSlope - kTakenOff * near.lambdaSlope);
    }
  });
}

// The attraction reaches far and is smooth, and serves on for longer than what bears pressure.
bool Tension::isDue(const HeldWalls& h, const Vec3& x, double time_s) const {
  const WallSample& s = h.sample;
  const double since_s = time_s - h.time_s;
  if (!std::isfinite(since_s)) return true;
  if (s.clear_m - h.moved_m(x, time_s) > kernel_.support_m()) return false;
  Vec3 away = x - h.place;
  if (s.friction > 0) away -= since_s / s.friction * s.frictionVelocity;
  return !(away.norm() < kHeldMove * spacing_m_ &&
           since_s * h.fastestWall_ms < kHeldMoveOfWalls * spacing_m_);
}

void Tension::push(double dt_s, std::vector<Vec3>& v) const {
  for (std::size_t i = 0; i < v.size(); ++i) v[i] += dt_s * acceleration_[i];
}

// As the projections' own, per volume that a particle really has (substep.cpp).
void Tension::addPressure_Pa(const std::vector<double>& densityRatio,
                             std::vector<double>& pressure_Pa) const {
  for (std::size_t i = 0; i < pressure_Pa.size(); ++i)
    pressure_Pa[i] += density_kgm3_ * densityRatio[i] * stress_[i];
}
}  // namespace swallowclip::bolus
