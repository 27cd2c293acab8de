// SPDX-License-Identifier: MIT
#include <cstdint>

#include "bolus/solver_impl.h"

namespace swallowclip::bolus {
namespace {
constexpr double kJitter = 0.3;     // spacings along each axis, assumed (0.2 to 0.5)
constexpr double kRoomShare = 0.5;  // of the way to a wall, at most
constexpr int kRounds = 20;         // until they lie evenly, assumed (10 to 100)

/// -1 to 1, always the same: splitmix64 (Steele, Lea & Flood 2014) of a number.
double noise(std::uint64_t number) {
  std::uint64_t z = (number + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  z ^= z >> 31;
  return static_cast<double>(z >> 11) / static_cast<double>(1ull << 52) - 1;
}

Vec3 centreOf(const std::vector<Vec3>& places) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& x : places) sum += x;
  return sum / std::max<double>(1, static_cast<double>(places.size()));
}
}  // namespace

Result<void> Solver::mix(double t_s) {
  Impl& s = *impl_;
  std::vector<Vec3> velocities = s.particles.velocities;
  const Vec3 centre = centreOf(s.particles.positions);
  const Vec3 gravity_ms2 = s.def.gravity_ms2;
  s.frozen = s.mixing = true;
  s.settlingViscosity_Pas = Impl::kSettlingViscosity_Pas;
  s.def.gravity_ms2.setZero();
  std::fill(s.particles.velocities.begin(), s.particles.velocities.end(), Vec3::Zero());
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    double most_m = kJitter * s.def.spacing_m;
    for (const Contact& c : s.contacts[i])
      most_m = std::min(most_m, kRoomShare * std::max(0.0, c.distance_m));
    for (int axis = 0; axis < 3; ++axis)
      s.particles.positions[i][axis] += most_m * noise(3 * i + axis);
  }
  s.meetWalls(t_s);
  Result<void> ok;
  for (int round = 0; round < kRounds && ok; ++round) {
    const Impl::Substep step = s.substep(s.chooseStep_s(1e-3));
    if (step.broken) ok = s.checkStep(step, step.length_s);
  }
  s.frozen = s.mixing = false;
  s.settlingViscosity_Pas = 0;
  s.def.gravity_ms2 = gravity_ms2;
  if (s.motion->triangles.empty()) {  // nothing else holds it there
    const Vec3 drift = centreOf(s.particles.positions) - centre;
    for (Vec3& x : s.particles.positions) x -= drift;
  }
  if (ok) s.start(t_s, std::move(s.particles.positions), std::move(velocities));
  return ok;
}
}  // namespace swallowclip::bolus
