// SPDX-License-Identifier: MIT
#include "bolus/shifting.h"

#include <algorithm>
#include <cmath>

#include "bolus/velocity_gradient.h"

namespace swallowclip::bolus {
namespace {
// A, of a shift that remembers: what it does in the end is 1 / (1 - kMemory) times as much. Less
// lets a start-up flow between plates, strained by 0.2 in all, end 2 to 3.6 % too slow; more stirs
// a column at rest by its own flicker. Lind's own, 2 h |v|, is about 15 there. Assumed (50 to 80).
constexpr double kStrength = 60;
constexpr double kMemory = 0.5;  // of the last shift, assumed (0.4 to 0.6)
// Before a wall particles lie in layers, which are no strings: there shifting only leaves
// compression. Assumed (4 to 8).
constexpr double kStrengthAtWall = 8;
// A rate_i dt, the share of the gradient that a step moves down, at most. From 0.4 on neighbours
// overshoot each other, and the noise thins fluids that shear makes thin. Assumed (0.25 to 0.35).
constexpr double kMostShare = 0.3;
// What is left of a push that takes back the last. With 1 peristaltic flows are up to 3.2 % off and
// a pipe of a power law 5 %, with 0.5 and 0.25 at most 1.9 and 1.5 %. Assumed (0.1 to 0.5).
constexpr double kTakenBack = 0.25;
constexpr double kMostGradient = 0.1;  // of the concentration over a spacing, assumed (0.05 to 0.2)
constexpr double kFullDensity = 0.97;  // of all neighbours: no free surface near, assumed
}  // namespace

void Shifting::resize(int particles) {
  for (Last* l : {&last_, &next_})
    for (auto* a : {&l->shift, &l->push}) a->assign(particles, Vec3f::Zero());
}

void Shifting::begin(const Flow& f, std::vector<Vec3>& moving) {
  const int n = f.count();
  density_.resize(n + 1);
  density_[n] = INFINITY;
  least_.resize(n);
  velocity_.shape(n, 1);
  moving.resize(f.walls.size());
  for (auto* a : {&next_.shift, &next_.push}) a->resize(f.walls.size());  // after a checkpoint
  for (std::size_t p = 0; p < f.neighbours.slot.size(); ++p)
    if (f.neighbours.slot[p] < 0) next_.shift[p] = next_.push[p] = Vec3f::Zero();
}

void Shifting::look(const Flow& f, const std::vector<double>& density, const std::vector<Vec3>& v,
                    int begin, int end) {
  for (int i = begin; i < end; ++i) {
    density_[i] = static_cast<float>(density[f.particle(i)]);
    velocity_.set(i, v[f.particle(i)]);
  }
}

void Shifting::shift(const Flow& f, const Step& s, const std::vector<Vec3>& v,
                     std::vector<Vec3>& moving, std::span<Mat3f> slopes_s,
                     const Projection::Range& then) {
  const LeastSweep least{f.lists(), density_.data(), least_.data()};
  const SlopeSweep slopes{f.lists(), velocity_.data()};
  f.sweep([&](int begin, int end, int) {
    least.run(begin, end);
    for (int i = begin; i < end; ++i) {
      const int p = f.particle(i);
      moving[p] = v[p];
      next_.shift[p].setZero();
      const bool inside = least_[i] >= kFullDensity;
      if (!inside && slopes_s.empty()) continue;
      const Mat3 slope_s = velocityGradient_s(f, slopes, v[p], i);
      if (!slopes_s.empty()) slopes_s[i] = slope_s.cast<float>();
      if (!inside) continue;
      Vec3 gradient = s.spacing_m * (f.wall(i).gradLambda + f.neighbours.sumG.at(i).cast<double>());
      gradient *= kMostGradient / std::max(kMostGradient, gradient.norm());
      const double strength = f.wall(i).lambda > 0 ? kStrengthAtWall : kStrength;
      const double share =
          s.mixing ? kMostShare : std::min(strength * shearRate_s(slope_s) * s.dt_s, kMostShare);
      const Vec3 shift = kMemory * last_.shift[p].cast<double>() - share * gradient;
      next_.shift[p] = shift.cast<float>();
      moving[p] += s.spacing_m / s.dt_s * shift;
    }
    then(begin, end);
  });
}

Vec3 Shifting::calm(int p, const Vec3& move) {
  const Vec3 shift = next_.shift[p].cast<double>();
  Vec3 push = move - shift;
  if (push.dot(last_.push[p].cast<double>()) < 0) push *= kTakenBack;
  next_.push[p] = push.cast<float>();
  return shift + push;
}
}  // namespace swallowclip::bolus
