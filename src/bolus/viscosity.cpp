// SPDX-License-Identifier: MIT
#include "bolus/viscosity.h"

#include <algorithm>
#include <cmath>

namespace swallowclip::bolus {
namespace {
constexpr double kPairFactor = 10;   // 2 (d + 2), d = 3 (Monaghan 2005)
constexpr double kWallFactor = 2;    // Ferrand et al. 2013, eq. 38: 2 nu |grad gamma| u / distance
constexpr double kSoftening = 0.01;  // eta^2 / (H/2)^2 against division by zero (Monaghan 2005)
constexpr int kCap = 300;            // iterations, assumed (100 to 500)
constexpr double kTolerance = 1e-4;  // residual over right side, assumed (1e-5 to 1e-3)
constexpr double kSmallSpeed_ms = 1e-6;  // residual speed nobody sees, assumed
}  // namespace

double shearRate_s(const Flow& f, const std::vector<Vec3>& v, int i) {
  const Neighbours& nb = f.neighbours;
  Mat3 gradient = Mat3::Zero();
  for (int k = nb.start[i]; k < nb.start[i + 1]; ++k)
    gradient += (v[nb.index[k]] - v[i]) * nb.gradW[k].transpose();
  gradient *= f.volume_m3;
  const WallSample& w = f.walls[i];
  const double steep = w.gradLambda.norm();
  // outside, the velocity goes on linearly through the wall's: (v_wall - v) / distance along n
  if (w.friction > 0 && w.area > 0 && steep > 0)
    gradient += std::min(w.lambda, 1.0) / (w.area * steep) *
                (w.frictionVelocity - w.friction * v[i]) * w.gradLambda.transpose();
  const Mat3 d = 0.5 * (gradient + gradient.transpose());
  return std::sqrt(2 * d.squaredNorm());
}

void Viscosity::updateViscosity(const Flow& f, const Fluid& fluid, const std::vector<Vec3>& v) {
  f.pool.forChunks(static_cast<int>(v.size()), kSweepChunk, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i)
      if (f.active[i]) viscosity_[i] = apparentViscosity_Pas(fluid, shearRate_s(f, v, i));
  });
}

void Viscosity::assemble(const Flow& f, double density, double dt, double support) {
  const Neighbours& nb = f.neighbours;
  const double eta2 = kSoftening * support * support / 4;
  pair_.resize(nb.index.size());
  f.pool.forChunks(static_cast<int>(wall_.size()), kSweepChunk, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      if (!f.active[i]) continue;
      // Across a slit with no room for a second particle the profile is not resolved: there the
      // walls brake at least as in plane Poiseuille flow, 12 nu / gap^2.
      const WallSample& w = f.walls[i];
      const double slit = w.friction > 0 ? 12 / (w.gap_m * w.gap_m) : 0;
      wall_[i] = dt * viscosity_[i] / density * std::max(kWallFactor * w.friction, slit);
      Mat3 diagonal = Mat3::Identity() * (1 + wall_[i]);
      for (int k = nb.start[i]; k < nb.start[i + 1]; ++k) {
        const int j = nb.index[k];
        const Vec3 x = f.positions[i] - f.positions[j];
        const double r2 = x.squaredNorm();
        // harmonic mean: the thinner of two layers decides the stress (Cleary & Monaghan 1999)
        const double mu = 2 * viscosity_[i] * viscosity_[j] / (viscosity_[i] + viscosity_[j]);
        const double slope = r2 > 0 ? -nb.gradW[k].dot(x) / r2 : 0;  // -W'/r
        pair_[k] = dt * kPairFactor * mu / density * f.volume_m3 * slope / (r2 + eta2);
        diagonal += pair_[k] * x * x.transpose();
      }
      inverseDiagonal_[i] = diagonal.inverse();
    }
  });
}

void Viscosity::multiply(const Flow& f, const std::vector<Vec3>& v, std::vector<Vec3>& out) const {
  const Neighbours& nb = f.neighbours;
  f.pool.forChunks(static_cast<int>(v.size()), kSweepChunk, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      if (!f.active[i]) continue;
      Vec3 sum = (1 + wall_[i]) * v[i];
      for (int k = nb.start[i]; k < nb.start[i + 1]; ++k) {
        const int j = nb.index[k];
        const Vec3 x = f.positions[i] - f.positions[j];
        sum += (pair_[k] * (v[i] - v[j]).dot(x)) * x;
      }
      out[i] = sum;
    }
  });
}

Viscosity::Report Viscosity::apply(const Flow& f, const Fluid& fluid, double override_Pas,
                                   double dt_s, double support_m, std::vector<Vec3>& v) {
  const int n = static_cast<int>(v.size());
  viscosity_.resize(n, fluid.viscosity_Pas);
  wall_.assign(n, 0.0);
  inverseDiagonal_.resize(n);
  for (auto* a : {&residual_, &direction_, &product_, &preconditioned_}) a->assign(n, Vec3::Zero());
  if (override_Pas > 0)
    std::fill(viscosity_.begin(), viscosity_.end(), override_Pas);
  else
    updateViscosity(f, fluid, v);
  assemble(f, fluid.density_kgm3, dt_s, support_m);

  auto dot = [&](const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    return f.pool.sumChunks(n, 4 * kSweepChunk, [&](int begin, int end) {
      double sum = 0;
      for (int i = begin; i < end; ++i)
        if (f.active[i]) sum += a[i].dot(b[i]);
      return sum;
    });
  };
  // right side b = v + wall drag; first guess v itself
  multiply(f, v, product_);
  double right2 = 0, active = 0;
  for (int i = 0; i < n; ++i) {
    if (!f.active[i]) continue;
    const WallSample& w = f.walls[i];
    const Vec3 b = w.friction > 0 ? Vec3(v[i] + wall_[i] / w.friction * w.frictionVelocity) : v[i];
    right2 += b.squaredNorm();
    active += 1;
    residual_[i] = b - product_[i];
    preconditioned_[i] = inverseDiagonal_[i] * residual_[i];
    direction_[i] = preconditioned_[i];
  }
  const double goal2 =
      std::max(kTolerance * kTolerance * right2, kSmallSpeed_ms * kSmallSpeed_ms * active);
  Report report;
  double rz = dot(residual_, preconditioned_);
  while (dot(residual_, residual_) > goal2) {
    report.atCap = report.iterations >= kCap;
    if (report.atCap) break;
    ++report.iterations;
    multiply(f, direction_, product_);
    const double step = rz / dot(direction_, product_);
    for (int i = 0; i < n; ++i) {
      if (!f.active[i]) continue;
      v[i] += step * direction_[i];
      residual_[i] -= step * product_[i];
      preconditioned_[i] = inverseDiagonal_[i] * residual_[i];
    }
    const double next = dot(residual_, preconditioned_);
    const double keep = next / rz;
    rz = next;
    for (int i = 0; i < n; ++i) direction_[i] = preconditioned_[i] + keep * direction_[i];
  }
  return report;
}
}  // namespace swallowclip::bolus
