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

Tension::Tension(const Fluid& fluid, const Kernel& own, double spacing_m)
    : density_kgm3_(fluid.density_kgm3),
      spacing_m_(spacing_m),
      tension_Nm_(fluid.surfaceTension_Nm),
      kernel_(KernelKind::cubicSpline, kTensionReach * spacing_m),
      table_(kernel_),
      // cut and weighed by its own kernel's size: the same relative error with fewer points
      field_(table_, spacing_m * kernel_.support_m() / own.support_m()) {
  const double reach_m = meanDistance_m(kernel_) - kTakenOff * meanDistance_m(own);
  attraction_m2s2_ = 8 * fluid.surfaceTension_Nm / (fluid.density_kgm3 * reach_m);
  adhesion_m2s2_ = attraction_m2s2_ * (1 + std::cos(fluid.contactAngle_rad)) / 2;
}

// The shortest capillary wave that particles resolve must not cross a spacing within a step, dt^2 <
// c1 rho dx^3 / sigma, with weightless air c1 = 1 / (4 pi) (Brackbill, Kothe & Zemach 1992, eq.
// 61). Where viscosity holds it back, it creeps instead: dt^2 < c2 eta dx / sigma dt + c1 rho dx^3
// / sigma (Galusinski & Vigneaux 2008). A ripple of two spacings creeps back at the rate sigma pi /
// (2 eta dx), and a step may be twice as long as that at most: 1.3 eta dx / sigma.
double Tension::longestStep_s(double viscosity_Pas) const {
  constexpr double kCreep = 0.5;  // c2, assumed (0.3 to 1; drops rest with 50 as well)
  const double creep_s = kCreep * viscosity_Pas * spacing_m_ / tension_Nm_;
  const double wave2_s2 = density_kgm3_ * std::pow(spacing_m_, 3) / (4 * kPi * tension_Nm_);
  return creep_s / 2 + std::sqrt(creep_s * creep_s / 4 + wave2_s2);
}

// A sum_j grad W3, and what it transmits: that of a pressure of minus half of it everywhere.
void Tension::attract(const Flow& flow) {
  const double perHalf = 2 / kernel_.support_m();
  const AttractionSweep sweep{neighbours_.candidates(), static_cast<float>(perHalf),
                              static_cast<float>(attraction_m2s2_ * std::pow(spacing_m_, 3) *
                                                 table_.selfW() * perHalf * perHalf),
                              force_.data(), transmitted_.data()};
  flow.sweep([&](int begin, int end, int) {
    sweep.run(begin, end);
    for (int i = begin; i < end; ++i) {
      acceleration_[neighbours_.id[i]] = Vec3(&force_[3 * i]);
      stress_[neighbours_.id[i]] = -transmitted_[i];
    }
  });
}

// The same of the density's own kernel, taken off.
void Tension::attractLess(const Flow& flow) {
  half_.assign(flow.count() + 1, static_cast<float>(-kTakenOff * attraction_m2s2_ / 2));
  const GradientSweep sweep{flow.lists(), half_.data(), force_.data(), flow.neighbours.r.data(),
                            transmitted_.data()};
  flow.sweep([&](int begin, int end, int) {
    sweep.run(begin, end);
    for (int i = begin; i < end; ++i) {
      acceleration_[flow.particle(i)] += Vec3(&force_[3 * i]);
      stress_[flow.particle(i)] -= transmitted_[i];
    }
  });
}

void Tension::measure(const Flow& flow, std::span<const Vec3> positions,
                      std::span<const std::uint8_t> active, const Walls& walls,
                      const Vec3& period_m) {
  if (!neighbours_.carry(positions, active, flow.pool))
    neighbours_.collect(positions, active, kernel_.support_m(), flow.neighbours.skin_m(), period_m,
                        flow.pool);
  acceleration_.assign(positions.size(), Vec3::Zero());
  stress_.assign(positions.size(), 0.0);
  force_.resize(3 * flow.count());
  transmitted_.resize(flow.count());
  attract(flow);
  attractLess(flow);
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
