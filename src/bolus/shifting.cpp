// SPDX-License-Identifier: MIT
#include "bolus/shifting.h"

#include <algorithm>
#include <cmath>

#include "bolus/velocity_gradient.h"

namespace swallowclip::bolus {
namespace {
// A. Less lets a start-up flow between plates, strained by 0.2 in all, end 2 to 3.6 % too slow
// (80), 0.4 to 0.9 % with 120 and 200; from 150 on a column at rest is stirred by its own flicker.
// Lind's own, 2 h |v|, is about 15 there. Assumed (100 to 140).
constexpr double kStrength = 120;
// Before a wall particles lie in layers, which are no strings: there shifting only leaves
// compression. Assumed (0.05 to 0.15).
constexpr double kStrengthAtWall = 8;
// A rate_i dt, the share of the gradient that a step moves down, at most. With 0.4 neighbours begin
// to overshoot each other, and the noise thins fluids that shear makes thin: between plates 16
// spacings apart yielding fluids and power laws were 2.3 % off on average and 8 % at single
// moments, a pipe is 1 % off with 0.3 and 9 % with 0.5. Assumed (0.2 to 0.35).
constexpr double kMostShare = 0.3;
// More where a flow stretches more than it turns, which is what makes strings: without it vortices
// lose 5 % too much of their energy, with it 0.6 %; with 0.5 a nearly closed wave of plates carries
// 5 % too much. Assumed (0.2 to 0.4).
constexpr double kMostStretched = 0.3;
constexpr double kMixingShare = 0.3;   // the same of fluid that is mixed, assumed (0.2 to 0.4)
constexpr double kMostGradient = 0.1;  // of the concentration over a spacing, assumed (0.05 to 0.2)
constexpr double kFullDensity = 0.97;  // of all neighbours: no free surface near, assumed

/// 0 where a flow shears or turns, 1 where it only stretches.
double stretchShare(const Mat3& slope_s, double rate_s) {
  const Mat3 turn_s = slope_s - slope_s.transpose();
  return std::max(0.0, 1 - turn_s.squaredNorm() / 2 / std::max(1e-30, rate_s * rate_s));
}
}  // namespace

void Shifting::begin(const Flow& f, std::vector<Vec3>& moving) {
  const int n = f.count();
  density_.resize(n + 1);
  density_[n] = INFINITY;
  least_.resize(n);
  velocity_.shape(n, 1);
  moving.resize(f.walls.size());
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
      const bool inside = least_[i] >= kFullDensity;
      if (!inside && slopes_s.empty()) continue;
      const Mat3 slope_s = velocityGradient_s(f, slopes, v[p], i);
      if (!slopes_s.empty()) slopes_s[i] = slope_s.cast<float>();
      if (!inside) continue;
      Vec3 gradient = s.spacing_m * (f.wall(i).gradLambda + f.neighbours.sumG.at(i).cast<double>());
      gradient *= kMostGradient / std::max(kMostGradient, gradient.norm());
      const double strength = f.wall(i).lambda > 0 ? kStrengthAtWall : kStrength;
      const double rate_s = shearRate_s(slope_s);
      const double most = kMostShare + kMostStretched * stretchShare(slope_s, rate_s);
      const double share = std::min(strength * rate_s * s.dt_s, most);
      const double moves = s.mixing ? std::max(kMixingShare, share) : share;
      moving[p] -= moves / s.dt_s * s.spacing_m * gradient;
    }
    then(begin, end);
  });
}
}  // namespace swallowclip::bolus
