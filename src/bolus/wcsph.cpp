// SPDX-License-Identifier: MIT
#include "bolus/wcsph.h"

#include <algorithm>
#include <cmath>

namespace swallowclip::bolus {
namespace {
constexpr double kCompression = 0.01;   // delta of eq. 4.20 (Monaghan 1994: about 1 %)
constexpr double kCourant = 0.4;        // lambda_1 of eq. 4.25
constexpr double kForceFactor = 0.25;   // lambda_2 of eq. 4.25
constexpr double kSoundMemory_s = 0.1;  // how slowly c falls again, assumed (0.05 to 0.2)
constexpr double kSoundRise_s = 2e-3;   // a sound wave's way through the bolus, assumed (1 to 5 ms)
constexpr double kMostSound_ms = 100;   // then a pocket has no room, assumed (60 to 150)
// alpha of eq. 4.12: 0.02 (Monaghan 1994 took 0.01 for water); the thesis' "around 1" would give 5
// mL of water the viscosity of honey: alpha h c / 10 (Monaghan 2005).
constexpr double kAlpha = 0.02;
constexpr double kPairFactor = 10;  // 2 (d + 2), d = 3 (Monaghan 2005)
// What a wall gives back of a particle's pressure. With 2, as in projection.cpp, an explicit step
// keeps a column circling at 190 mm/s; with 1.5 at 20.
constexpr double kWallMirror = 1.5;
// Cutoff r0 of eq. 4.27. In the thesis boundary particles lie on the wall and r0 is the spacing;
// walls that fill the kernel let particles rest half a spacing away, and contacts hold at 0.4.
constexpr double kRepulsionReach = 0.5;     // spacings
constexpr double kRepulsionGapShare = 0.5;  // of a slit: both walls push alike in its middle
// Share of the kernel inside the walls that still counts: a slit of film's width has 0.2.
constexpr double kLeastShare = 0.2;
constexpr double kRepulsionNearest = 0.7;  // of r0: nearer the force grows no more, assumed

// gamma of Ferrand et al. 2013
double ownShare(const WallSample& w) {
  return std::max(kLeastShare, 1 - w.lambda);
}

// Eq. 4.27 with n1 = 12, n2 = 4, over the distance from the wall itself. D is "at the same scale as
// the square of the largest velocity": here of this particle's own approach, so that what lies at
// rest is not thrown off and what leaves is not held.
Vec3 repulsion_ms2(const std::vector<Contact>& contacts, const Vec3& v, double spacing_m) {
  Vec3 sum = Vec3::Zero();
  const double r0 =
      std::min(kRepulsionReach * spacing_m, kRepulsionGapShare * localGap_m(contacts));
  for (const Contact& c : contacts) {
    const double approach = (c.velocity - v).dot(c.inward);
    if (approach <= 0 || c.distance_m >= r0 || r0 <= 0) continue;
    const double r = std::max(c.distance_m, kRepulsionNearest * r0);
    const double ratio4 = std::pow(r0 / r, 4);
    sum += approach * approach * (ratio4 * ratio4 * ratio4 - ratio4) / r * c.inward;
  }
  return sum;
}
}  // namespace

void Wcsph::chooseSound(const Scales& s, double sinceLast_s) {
  const double scale2 =
      std::max({s.speed_ms * s.speed_ms, s.viscosity_m2s * s.speed_ms / s.spacing_m,
                s.bodyForce_ms2 * s.depth_m}) /
      kCompression;
  const double excess = compression_ / kCompression - 1;
  const double change = excess > 0 ? std::min(excess, 1.0) * sinceLast_s / kSoundRise_s
                                   : -std::min(1.0, sinceLast_s / kSoundMemory_s);
  const double before2 = sound_ms_ * sound_ms_;
  sound_ms_ = std::sqrt(std::max(
      scale2, std::min(before2 * (1 + change), std::max(kMostSound_ms * kMostSound_ms, scale2))));
}

double Wcsph::leastViscosity_m2s(double smoothing_m) const {
  return kAlpha * smoothing_m * sound_ms_ / kPairFactor;
}

double Wcsph::longestStep_s(double h) const {
  double dt = INFINITY;
  // beta = 0: no shocks here
  if (sound_ms_ > 0) dt = kCourant * h / (sound_ms_ * (1 + 0.6 * kAlpha));
  if (fastestKick_ms2_ > 0) dt = std::min(dt, kForceFactor * std::sqrt(h / fastestKick_ms2_));
  return dt;
}

void Wcsph::kick(const Flow& f, const std::vector<std::vector<Contact>>& contacts,
                 const Vec3& gravity, double spacing_m, double density_kgm3, double dt_s,
                 std::vector<Vec3>& v, std::vector<double>& pressure_Pa) {
  const Neighbours& nb = f.neighbours;
  const int n = f.count();
  k_.resize(n);
  std::fill(pressure_Pa.begin(), pressure_Pa.end(), 0.0);
  double sum = 0, squares = 0;
  for (int i = 0; i < n; ++i) {
    const int p = f.particle(i);
    const double ratio = nb.sumW[i] / ownShare(f.wall(i));
    const double e = std::max(0.0, ratio - 1);
    sum += e;
    squares += e * e;
    pressure_Pa[p] = density_kgm3 * sound_ms_ * sound_ms_ * e;
    k_[i] = sound_ms_ * sound_ms_ * e / (ratio * ratio);
  }
  compression_ = sum > 0 ? squares / sum : 0;
  fastestPart_.assign((n + kSweepChunk - 1) / kSweepChunk, 0.0);
  f.sweep([&](int begin, int end, int chunk) {
    for (int i = begin; i < end; ++i) {
      const int p = f.particle(i);
      Vec3 a = Vec3::Zero();
      for (int e = nb.start[i]; e < nb.stop[i] && nb.index[e] < nb.count; ++e)
        a -= (k_[i] + k_[nb.index[e]]) * Vec3(nb.gx[e], nb.gy[e], nb.gz[e]);
      a -= kWallMirror * k_[i] * f.wall(i).gradLambda;
      a /= ownShare(f.wall(i));
      a += gravity + repulsion_ms2(contacts[p], v[p], spacing_m);
      fastestPart_[chunk] = std::max(fastestPart_[chunk], a.norm());
      v[p] += dt_s * a;
    }
  });
  fastestKick_ms2_ = 0;
  for (double part : fastestPart_) fastestKick_ms2_ = std::max(fastestKick_ms2_, part);
}
}  // namespace swallowclip::bolus
