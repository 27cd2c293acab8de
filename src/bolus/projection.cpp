// SPDX-License-Identifier: MIT
#include "bolus/projection.h"

#include <algorithm>
#include <cmath>

#include "core/simd.h"

namespace swallowclip::bolus {
namespace {
// Step along the gradient over the diagonal: for the optimized gradient method at most one over the
// largest eigenvalue of the scaled operator, which is 2.63 to 2.96 in 60 systems of swallows and of
// cases of verify, but more among particles that were put down at random. So a solve of which more
// is left again than kGrows times the least is taken for one of those and goes on with the second,
// by Nesterov's method, which bears a third more. Ihmsen et al. 2014, sec. 3.2 have 0.5 for Jacobi.
constexpr float kRelaxation = 0.3f, kCarefulRelaxation = 0.25f;
constexpr double kGrows = 4;  // assumed (2 to 10)
// A wall has the pressure of the particle before it: (k_i + k_wall) grad lambda. The rate counts a
// wall's approach by the same factor, which keeps the operator symmetric: with 1 there and 1.5 or 2
// here, a column that starts 4 % too dense at its edges blows up to 3 or 28 m/s; so it stays below
// 0.4 m/s and comes to rest. What is counted twice is only the motion between a particle and its
// wall, which contacts stop anyway, and the next step measures it anew.
constexpr float kWallMirror = 2;
// Along a wall the sum of gradW misses the share lambda of its kernel beyond it, while the wall's
// own term points across: a pressure that changes along the wall would push the first layer only
// with 1 - lambda of its gradient (0.8 at half a spacing), and a column 10 mm wide would need 9 %
// more pressure to stand. So that layer is moved 1 / (1 - lambda) as far along the wall. As a
// factor on the motion, not on the pairs, it keeps the operator symmetric and an even pressure
// without effect.
constexpr float kMostLambda = 0.5;  // counted at most, assumed (0.4 to 0.6): an edge has 0.4
// No particle may be left with more than this, however good the mean: in a closing slit some few
// particles far from a solution are thrown out of it at 100 m/s. Assumed (0.5 to 5 %). Of steps
// shorter than kCorrection_s in proportion: as much in each would add up.
constexpr double kWorstLeft = 0.02;
// What is compressed already spreads within this time, or within the step if that is longer. Within
// every step, however short, it would do so at a speed that shortens the next step, and so on to
// 100 m/s. Assumed (0.05 to 0.2 ms).
constexpr double kCorrection_s = 1e-4;
// A solve goes on until it leaves Tolerances::share of what it was to remove, or its tolerance if
// that is less; and no further than this share of its tolerance. Fluid driven through a long gap
// needs it: the compression that drives it is small beside what pressure and friction exchange.
constexpr double kFloor = 1e-4;  // assumed (1e-5 to 1e-3)
// Density that lacks less than kOpening lies between particles that are in disorder, not in an
// opening, and closes within this time. Velocities that filled it at once would let a fluid at rest
// fall into it every step, and a squeezed one lose a tenth of its flux. Assumed (0.02 to 0.1; 0.2
// to 1 s; 0.05 s leaves squeezed plates 8 % short of pressure).
constexpr double kOpening = 0.05, kSettle_s = 0.3;
constexpr int kDensityCap = 150;  // iterations, assumed (100 to 300)
constexpr int kRateCap = 500;     // assumed (200 to 1000): a long gap of 150 spacings needs 200
// A pressure that passes as it is would never change: plane Poiseuille flow starts 3.6 % too slowly
// then, and 2.1 % with two or more. Places have no such memory: they may do without any.
constexpr int kLeastDensity = 0, kLeastRate = 2;
// A liquid does not dilate: it has tension instead. Without it a thick fluid that is drawn apart
// becomes thinner by gaps as readily as by flow: the front of 5 Pa.s that a tongue squeezes out
// lost a third of its density, and crumbled. So dilation is resisted like shear, with kHold times
// the viscosity. At a surface, too: that is a rate's stress, which does nothing to what stands
// still or turns. Assumed (10 to 50: 10 and 5 % of a stretch become gaps with 10 and 20).
constexpr double kHold = 20;
constexpr float kNoLimit_m2 = 1e25f;
}  // namespace

void Projection::resize(int n) {
  densityK_.assign(n, 0.0);
  rateK_.assign(n, 0.0);
}

void Projection::prepare(const Flow& f) {
  const Neighbours& nb = f.neighbours;
  const int n = f.count();
  for (auto* a : {&mobility_, &freedom_, &along_, &diagonal_, &bulk_m2s_, &source_, &room_,
                  &hold_m2_, &x_, &y_}) {
    a->resize(n + simd::kLanes);
    std::fill(a->begin() + n, a->end(), 0.f);
  }
  across_.resize(n);
  stress_.resize(n);
  force_.resize(3 * n);
  wall_.shape(n, simd::kLanes);
  acceleration_.shape(n, simd::kLanes);
  velocity_.shape(n, 1);
  for (std::size_t p = 0; p < nb.slot.size(); ++p)
    if (nb.slot[p] < 0) densityK_[p] = rateK_[p] = 0;
  f.sweep([&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      const WallSample& w = f.wall(i);
      const Vec3f g = kWallMirror * w.gradLambda.cast<float>();
      std::copy_n(g.data(), 3, wall_[i]);
      along_[i] = across_[i] = 0;
      if (const float square = g.squaredNorm(); square > 0) {
        const float lambda = std::clamp(static_cast<float>(w.lambda), 0.f, kMostLambda);
        along_[i] = lambda / (1 - lambda);
        across_[i] = along_[i] / square;
      }
      mobility_[i] = 1;
      x_[i] = static_cast<float>(rateK_[f.particle(i)]);
    }
  });
}

// In single precision: what is put in is taken out again, so that momentum does not feel it.
void Projection::pushByLastPressure(const Flow& f, double dt_s, std::vector<Vec3>& v, int begin,
                                    int end) {
  findAccelerations(pressureOf(f, x_), begin, end);
  for (int i = begin; i < end; ++i) v[f.particle(i)] += dt_s * acceleration_.at(i).cast<double>();
}

void Projection::brake(const Flow& f, const Friction& friction, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    if (!friction.wallDrag.empty())
      mobility_[i] = static_cast<float>(1 / (1 + friction.wallDrag[f.particle(i)]));
    bulk_m2s_[i] =
        friction.viscosity_Pas.empty()
            ? 0
            : static_cast<float>(kHold * friction.viscosity_Pas[i] / friction.density_kgm3);
    freedom_[i] = mobility_[i] * (1 + along_[i]);
  }
}

void Projection::takeLastPressureBack(const Flow& f, double dt_s, std::vector<Vec3>& v, int begin,
                                      int end) {
  const DiagonalSweep sweep{f.lists(), freedom_.data(), wall_.data(), diagonal_.data()};
  sweep.run(begin, end);
  for (int i = begin; i < end; ++i)
    v[f.particle(i)] -= dt_s * mobility_[i] * acceleration_.at(i).cast<double>();
  startAt(f, v, rateK_, begin, end);
}

void Projection::startFrom(const Flow& f, const std::vector<Vec3>& v, int begin, int end) {
  startAt(f, v, densityK_, begin, end);
}

void Projection::startAt(const Flow& f, const std::vector<Vec3>& v,
                         const std::vector<double>& warmK, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    const int p = f.particle(i);
    velocity_.set(i, v[p]);
    x_[i] = y_[i] = diagonal_[i] > 0 ? static_cast<float>(warmK[p]) : 0.f;
  }
}

PressureSweep Projection::pressureOf(const Flow& f, const std::vector<float>& k) {
  return {f.lists(), k.data(), mobility_.data(), wall_.data(), acceleration_.data()};
}

/// want(slot, rate of rho* in 1/s) into source_, room_ and hold_m2_; with `pushes`, what the first
/// pressure does, too.
template <class Source>
void Projection::findSource(const Flow& f, const std::vector<Vec3>& v, bool pushes,
                            Source&& source) {
  const RateSweep sweep{f.lists(), velocity_.data(), source_.data()};
  const PressureSweep pressure = pressureOf(f, y_);
  asked_.assign((f.count() + kSweepChunk - 1) / kSweepChunk, {});
  f.sweep([&](int begin, int end, int chunk) {
    sweep.run(begin, end);
    Asked asked;
    float* const out = source_.data();
    for (int i = begin; i < end; ++i) {
      float rate = out[i];
      if (f.beside[i])
        rate += static_cast<float>(v[f.particle(i)].dot(wall_.at(i).cast<double>()) -
                                   kWallMirror * f.wall(i).flux_s);
      const Want want = source(i, static_cast<double>(rate));
      out[i] = static_cast<float>(want.source);
      room_[i] = static_cast<float>(want.room);
      hold_m2_[i] = full ? kNoLimit_m2 : static_cast<float>(want.hold);
      asked.add(out[i], full);
    }
    asked_[chunk] = asked;
    if (pushes) findAccelerations(pressure, begin, end);
  });
  if (!full || f.count() == 0) return;
  // What compresses all of a full room alike has no solution and no meaning.
  double mean = 0;
  for (int i = 0; i < f.count(); ++i) mean += source_[i] / f.count();
  asked_.assign(1, {});
  for (int i = 0; i < f.count(); ++i) asked_[0].add(source_[i] -= static_cast<float>(mean), true);
}

// (-D a(k)) = source,  k >= 0.  source_ in 1/s^2. With `least` above 0 the first accelerations are
// there already.
//   `levelled`: k sums to zero instead, in a full room. Among disordered particles a pressure that
// is the same everywhere does push, but so little that against what compresses all alike it would
// have to rise without end, and stir: after 500 iterations a yielding fluid came out 5 % fast. The
// source that only such a level could meet is taken out as the solve finds it.
//   Places need that level: it evens out their disorder (the background pressure of Adami et al.
// 2013, J. Comput. Phys. 241:292), against pressures below zero, which feed it. Without it tubes
// with peristalsis lose 60 % of their flow; a level set to so many times the spread of pressures is
// too little in one tube and blows up in the next.
ProjectionReport Projection::project(const Flow& f, double dt_s, int least, int cap,
                                     double tolerance, bool levelled, std::vector<double>& warmK) {
  ProjectionReport report;
  const int n = f.count();
  if (n == 0) return report;
  const PressureSweep pressure = pressureOf(f, y_);
  bool careful = full;  // places' level in a full room is what these steps make of it
  StepSweep step{f.lists(),
                 acceleration_.data(),
                 wall_.data(),
                 source_.data(),
                 diagonal_.data(),
                 room_.data(),
                 hold_m2_.data(),
                 careful ? kCarefulRelaxation : kRelaxation,
                 0,
                 0,
                 x_.data(),
                 y_.data()};
  parts_.resize((n + kSweepChunk - 1) / kSweepChunk);
  Asked all;
  for (const Asked& part : asked_) all.add(part);
  const double share = dt_s * dt_s / n;
  const double worstLeft = kWorstLeft * std::min(1.0, dt_s / kCorrection_s);
  tolerance = std::clamp(tolerances.share * all.size * share, kFloor * tolerance, tolerance);
  if (least == 0 && all.over * share < tolerance && all.most * dt_s * dt_s < worstLeft) {
    report.meanError = all.over * share;  // no pressure at all is good enough
    warmK.assign(warmK.size(), 0.0);
    return report;
  }
  double perLevel_m2s2 = 0;  // how far a source of one moves all pressures together
  if (levelled)
    for (const float d : diagonal_)
      if (d > 0) perLevel_m2s2 += step.relax / d;
  double theta = 1, least_s2 = INFINITY;
  for (report.iterations = 1;; ++report.iterations) {
    const double next = (1 + std::sqrt(1 + 4 * theta * theta)) / 2;
    step.momentum = static_cast<float>((theta - 1) / next);
    step.lead = careful ? 0 : static_cast<float>(theta / next);
    theta = next;
    if (report.iterations > 1 || least == 0)
      f.sweep([&](int b, int e, int) { findAccelerations(pressure, b, e); });
    f.sweep([&](int b, int e, int c) { parts_[c] = step.run(b, e); });
    StepSweep::Sums left;
    for (const StepSweep::Sums& p : parts_) {
      left.residual += p.residual;
      left.ahead += p.ahead;
      left.moved += p.moved;
      left.most = std::max(left.most, p.most);
    }
    report.meanError = left.residual / n * dt_s * dt_s;
    if (report.iterations >= least && report.meanError < tolerance &&
        left.most * dt_s * dt_s < worstLeft)
      break;
    report.atCap = report.iterations >= cap;
    if (report.atCap) break;
    least_s2 = std::min(least_s2, left.residual);
    if (!careful && left.residual > kGrows * least_s2) {
      careful = true;
      step.relax = kCarefulRelaxation;
      theta = 1;
    }
    if (left.ahead < 0) theta = 1;
    if (levelled)
      for (int i = 0; i < n; ++i) source_[i] -= static_cast<float>(left.moved / perLevel_m2s2);
  }
  if (levelled) {
    double mean = 0;
    for (int i = 0; i < n; ++i) mean += x_[i] / n;
    for (int i = 0; i < n; ++i) x_[i] -= static_cast<float>(mean);
  }
  return report;
}

void Projection::findAccelerations(const PressureSweep& pressure, int begin, int end) {
  pressure.run(begin, end);
  for (int i = begin; i < end; ++i) {
    if (!stopped_.empty() && !stopped_[i].isZero(0)) {
      const Vec3f rest = -stopped_[i].dot(acceleration_.at(i)) * stopped_[i];
      for (int k = 0; k < 3; ++k) acceleration_[i][k] += rest[k];
      continue;
    }
    if (along_[i] == 0) continue;
    const Vec3f w = wall_.at(i), a = acceleration_.at(i);
    const Vec3f more = along_[i] * a - across_[i] * a.dot(w) * w;
    for (int k = 0; k < 3; ++k) acceleration_[i][k] += more[k];
  }
}

// v += dt a(x_), and x_ is where the next solve starts.
void Projection::accelerate(const Flow& f, double dt_s, std::vector<Vec3>& v, const Range& then) {
  const GradientSweep gradient{f.lists(), x_.data(), force_.data(), f.neighbours.r.data(),
                               stress_.data()};
  f.sweep([&](int begin, int end, int) {
    gradient.run(begin, end);
    for (int i = begin; i < end; ++i) {
      const Vec3 w = wall_.at(i).cast<double>();
      Vec3 a = -Vec3(&force_[3 * i]) - static_cast<double>(x_[i]) * w;
      if (along_[i] != 0) a += along_[i] * a - across_[i] * a.dot(w) * w;
      v[f.particle(i)] += dt_s * mobility_[i] * a;
      rateK_[f.particle(i)] = x_[i];
    }
    then(begin, end);
  });
}

ProjectionReport Projection::divergenceFree(const Flow& f, const std::vector<double>& density,
                                            double dt_s, std::vector<Vec3>& v, const Range& then) {
  // what is still below rest density may close up; nothing is pulled apart
  const double perStep = 1 / dt_s;
  findSource(f, v, kLeastRate > 0, [&, rho = density.data()](int i, double rate_s) {
    const int p = f.particle(i);
    const double room = std::max(0.0, 1 - rho[p]);
    const double open = full ? 0
                             : std::max(0.0, room - kOpening) * perStep +
                                   std::min(room, kOpening) * (1 / kSettle_s);
    return Want{(rate_s - open) * perStep, open * perStep, bulk_m2s_[i] * dt_s};
  });
  const ProjectionReport report =
      project(f, dt_s, kLeastRate, kRateCap, tolerances.rate, full, rateK_);
  accelerate(f, dt_s, v, then);
  return report;
}

ProjectionReport Projection::constantDensity(const Flow& f, const std::vector<double>& density,
                                             double dt_s, std::vector<Vec3>& v) {
  return correct(f, density, dt_s, densityK_, v);
}

ProjectionReport Projection::makeRoom(const Flow& f, const std::vector<double>& density,
                                      double dt_s, std::vector<Vec3f> stopped,
                                      std::vector<Vec3>& v) {
  std::vector<double> fromNothing(density.size(), 0.0);
  f.sweep([&](int begin, int end, int) { startAt(f, v, fromNothing, begin, end); });
  stopped_ = std::move(stopped);
  const ProjectionReport report = correct(f, density, dt_s, fromNothing, v);
  stopped_.clear();
  return report;
}

ProjectionReport Projection::correct(const Flow& f, const std::vector<double>& density, double dt_s,
                                     std::vector<double>& warmK, std::vector<Vec3>& v) {
  const double perStep = 1 / dt_s, perCorrection = 1 / std::max(dt_s, kCorrection_s);
  findSource(f, v, kLeastDensity > 0, [=, &f, rho = density.data()](int i, double rate_s) {
    return Want{(rate_s + (rho[f.particle(i)] - 1) * perCorrection) * perStep};
  });
  const ProjectionReport report =
      project(f, dt_s, kLeastDensity, kDensityCap, tolerances.density, false, warmK);
  if (report.iterations == 0) return report;
  // places have no momentum to be kept, single precision does
  f.sweep([&](int begin, int end, int) {
    findAccelerations(pressureOf(f, x_), begin, end);
    for (int i = begin; i < end; ++i) {
      v[f.particle(i)] += dt_s * acceleration_.at(i).cast<double>();
      warmK[f.particle(i)] = x_[i];
    }
  });
  return report;
}
}  // namespace swallowclip::bolus
