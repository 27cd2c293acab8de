// SPDX-License-Identifier: MIT
#include "bolus/shifting.h"

#include <algorithm>
#include <cmath>

#include "bolus/velocity_gradient.h"

namespace swallowclip::bolus {
namespace {
// A. Vortices that turn a quarter keep their shape from 60 on; from 150 on a column at rest is
// stirred by its own flicker. Lind's own, 2 h |v|, is about 15 there. Assumed (60 to 120).
constexpr double kStrength = 80;
// Before a wall particles lie in layers, which are no strings: there shifting only leaves
// compression. Assumed (0.05 to 0.15).
constexpr double kStrengthAtWall = 8;
constexpr double kMostGradient = 0.1;  // of the concentration over a spacing, assumed (0.05 to 0.2)
constexpr double kFullDensity = 0.97;  // of all neighbours: no free surface near, assumed
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

void Shifting::shift(const Flow& f, double spacing_m, const std::vector<Vec3>& v,
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
      Vec3 gradient = spacing_m * (f.wall(i).gradLambda + f.neighbours.sumG.at(i).cast<double>());
      gradient *= kMostGradient / std::max(kMostGradient, gradient.norm());
      const double strength = f.wall(i).lambda > 0 ? kStrengthAtWall : kStrength;
      moving[p] -= strength * spacing_m * shearRate_s(slope_s) * gradient;
    }
    then(begin, end);
  });
}
}  // namespace swallowclip::bolus
