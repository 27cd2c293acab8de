// SPDX-License-Identifier: MIT
#include "bolus/shifting.h"

#include <algorithm>

#include "bolus/viscosity.h"

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

void Shifting::apply(const Flow& f, const std::vector<double>& density, double spacing_m,
                     double dt_s, std::vector<Vec3>& v, std::vector<Vec3>& moving) {
  const Neighbours& nb = f.neighbours;
  shift_.assign(f.count(), Vec3::Zero());
  carried_.assign(f.count(), Vec3::Zero());
  f.sweep([&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      const int p = f.particle(i);
      Vec3 gradient = f.walls[p].gradLambda;
      double least = density[p];
      for (int k = nb.start[i]; k < nb.start[i + 1] && nb.index[k] < nb.count; ++k) {
        least = std::min(least, density[nb.id[nb.index[k]]]);
        gradient += Vec3(nb.gx[k], nb.gy[k], nb.gz[k]);
      }
      if (least < kFullDensity) continue;
      gradient *= spacing_m;
      gradient *= kMostGradient / std::max(kMostGradient, gradient.norm());
      const Mat3 slope = velocityGradient_s(f, v, i);
      const double strength = f.walls[p].lambda > 0 ? kStrengthAtWall : kStrength;
      shift_[i] = -strength * spacing_m * shearRate_s(slope) * gradient;
      carried_[i] = dt_s * (slope * shift_[i]);
    }
  });
  // What the fluid as a whole gains by that is taken back from all: momentum is kept.
  Vec3 gained = Vec3::Zero();
  for (const Vec3& c : carried_) gained += c;
  gained /= std::max(1, f.count());
  for (int i = 0; i < f.count(); ++i) {
    v[f.particle(i)] += carried_[i] - gained;
    moving[f.particle(i)] = v[f.particle(i)] + shift_[i];
  }
}
}  // namespace swallowclip::bolus
