// SPDX-License-Identifier: MIT
#include "bolus/projection.h"

#include <algorithm>
#include <cmath>

namespace swallowclip::bolus {
namespace {
// Step along the gradient over the diagonal, at most one over the largest eigenvalue of the scaled
// operator. Ihmsen et al. 2014, sec. 3.2 have 0.5 for Jacobi.
constexpr float kRelaxation = 0.25f;
// A wall has the pressure of the particle before it: (k_i + k_wall) grad lambda. The rate counts a
// wall's approach by the same factor, which keeps the operator symmetric: with 1 there and 1.5 or 2
// here, a column that starts 4 % too dense at its edges blows up to 3 or 28 m/s; so it stays below
// 0.4 m/s and comes to rest. What is counted twice is only the motion between a particle and its
// wall, which contacts stop anyway, and the next step measures it anew.
constexpr float kWallMirror = 2;
// No particle may be left with more than this, however good the mean: in a closing slit some few
// particles far from a solution are thrown out of it at 100 m/s. Assumed (0.5 to 5 %).
constexpr double kWorstLeft = 0.02;
// What is compressed already spreads within this time, or within the step if that is longer. Within
// every step, however short, it would do so at a speed that shortens the next step, and so on to
// 100 m/s. Assumed (0.05 to 0.2 ms).
constexpr double kCorrection_s = 1e-4;
constexpr int kDensityCap = 150;     // iterations, assumed (100 to 300)
constexpr int kRateCap = 50;         // assumed (20 to 100): leftovers go to the density solve
constexpr float kNoLimit = 1e30f;    // m^2/s^2
constexpr int kLeastIterations = 2;  // Bender & Koschier 2015
}  // namespace

void Projection::resize(int n) {
  densityK_.assign(n, 0.0);
  rateK_.assign(n, 0.0);
}

void Projection::prepare(const Flow& f, std::span<const double> wallDrag) {
  const Neighbours& nb = f.neighbours;
  const int n = f.count();
  for (auto* a : {&mobility_, &diagonal_, &source_, &x_, &y_}) a->assign(n + 1, 0.f);
  wall_.assign(n + 1);
  acceleration_.assign(n + 1);
  for (std::size_t p = 0; p < nb.slot.size(); ++p)
    if (nb.slot[p] < 0) densityK_[p] = rateK_[p] = 0;
  for (int i = 0; i < n; ++i) {
    const Vec3f g = kWallMirror * f.walls[f.particle(i)].gradLambda.cast<float>();
    wall_.x[i] = g.x();
    wall_.y[i] = g.y();
    wall_.z[i] = g.z();
    mobility_[i] = wallDrag.empty() ? 1.f : static_cast<float>(1 / (1 + wallDrag[f.particle(i)]));
  }
  const DiagonalSweep sweep{f.lists(),      mobility_.data(), wall_.x.data(),
                            wall_.y.data(), wall_.z.data(),   diagonal_.data()};
  f.sweep([&](int begin, int end, int) { sweep.run(begin, end); });
}

/// Rate of rho* (1/s) into source_.
void Projection::densityRate(const Flow& f, const std::vector<Vec3>& v) {
  velocity_.assign(f.count() + 1);
  for (int i = 0; i < f.count(); ++i) velocity_.set(i, v[f.particle(i)]);
  const RateSweep sweep{f.lists(), velocity_.x.data(), velocity_.y.data(), velocity_.z.data(),
                        source_.data()};
  f.sweep([&](int begin, int end, int) {
    sweep.run(begin, end);
    for (int i = begin; i < end; ++i) {
      const int p = f.particle(i);
      source_[i] +=
          static_cast<float>(kWallMirror * (v[p].dot(f.walls[p].gradLambda) - f.walls[p].flux_s));
    }
  });
}

// (-D a(k)) = source,  k >= 0.  source_ in 1/s^2.
ProjectionReport Projection::project(const Flow& f, double dt_s, int cap, double tolerance,
                                     std::vector<double>& warmK, std::vector<Vec3>& v) {
  ProjectionReport report;
  const int n = f.count();
  if (n == 0) return report;
  for (int i = 0; i < n; ++i)
    x_[i] = y_[i] = diagonal_[i] > 0 ? static_cast<float>(warmK[f.particle(i)]) : 0.f;
  const PressureSweep pressure{f.lists(),
                               y_.data(),
                               mobility_.data(),
                               wall_.x.data(),
                               wall_.y.data(),
                               wall_.z.data(),
                               acceleration_.x.data(),
                               acceleration_.y.data(),
                               acceleration_.z.data()};
  StepSweep step{f.lists(),
                 acceleration_.x.data(),
                 acceleration_.y.data(),
                 acceleration_.z.data(),
                 wall_.x.data(),
                 wall_.y.data(),
                 wall_.z.data(),
                 source_.data(),
                 diagonal_.data(),
                 kRelaxation,
                 0,
                 full ? -kNoLimit : 0.f,
                 x_.data(),
                 y_.data()};
  std::vector<StepSweep::Sums> parts((n + kSweepChunk - 1) / kSweepChunk);
  double theta = 1;
  for (report.iterations = 1;; ++report.iterations) {
    const double next = (1 + std::sqrt(1 + 4 * theta * theta)) / 2;
    step.momentum = static_cast<float>((theta - 1) / next);
    theta = next;
    f.sweep([&](int b, int e, int) { pressure.run(b, e); });
    f.sweep([&](int b, int e, int c) { parts[c] = step.run(b, e); });
    StepSweep::Sums all;
    for (const StepSweep::Sums& p : parts) {
      all.residual += p.residual;
      all.ahead += p.ahead;
      all.most = std::max(all.most, p.most);
    }
    report.meanError = all.residual / n * dt_s * dt_s;
    if (report.iterations > kLeastIterations && report.meanError < tolerance &&
        all.most * dt_s * dt_s < kWorstLeft)
      break;
    report.atCap = report.iterations >= cap;
    if (report.atCap) break;
    if (all.ahead < 0) theta = 1;
  }
  force_.resize(3 * n);
  const GradientSweep gradient{f.lists(), x_.data(), force_.data()};
  f.sweep([&](int begin, int end, int) {
    gradient.run(begin, end);
    for (int i = begin; i < end; ++i) {
      const int p = f.particle(i);
      const Vec3 a =
          -Vec3(&force_[3 * i]) - kWallMirror * static_cast<double>(x_[i]) * f.walls[p].gradLambda;
      v[p] += dt_s * mobility_[i] * a;
      warmK[p] = x_[i];
    }
  });
  return report;
}

// What compresses all of a full room alike has no solution and no meaning.
void Projection::takeMeanOff(int count) {
  if (!full || count == 0) return;
  double mean = 0;
  for (int i = 0; i < count; ++i) mean += source_[i] / count;
  for (int i = 0; i < count; ++i) source_[i] -= static_cast<float>(mean);
}

ProjectionReport Projection::divergenceFree(const Flow& f, const std::vector<double>& density,
                                            double dt_s, std::vector<Vec3>& v) {
  densityRate(f, v);
  // what is still below rest density may close up; nothing is pulled apart
  for (int i = 0; i < f.count(); ++i) {
    const double open = full ? 0 : std::max(0.0, 1 - density[f.particle(i)]) / dt_s;
    source_[i] = static_cast<float>((source_[i] - open) / dt_s);
  }
  takeMeanOff(f.count());
  return project(f, dt_s, kRateCap, tolerances.rate, rateK_, v);
}

ProjectionReport Projection::constantDensity(const Flow& f, const std::vector<double>& density,
                                             double dt_s, std::vector<Vec3>& v) {
  densityRate(f, v);
  const double within_s = std::max(dt_s, kCorrection_s);
  for (int i = 0; i < f.count(); ++i)
    source_[i] = static_cast<float>((source_[i] + (density[f.particle(i)] - 1) / within_s) / dt_s);
  takeMeanOff(f.count());
  return project(f, dt_s, kDensityCap, tolerances.density, densityK_, v);
}
}  // namespace swallowclip::bolus
