// SPDX-License-Identifier: MIT
#include "bolus/viscosity.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "bolus/velocity_gradient.h"
#include "core/simd.h"

namespace swallowclip::bolus {
namespace {
constexpr double kWallFactor = 2;    // Ferrand et al. 2013, eq. 38: 2 nu |grad gamma| u / distance
constexpr double kSoftening = 1e-4;  // eta^2 / (H/2)^2 against division by zero (Monaghan 2005)
// The Laplacian of |x|^2 is 6, so the weights of a full neighbourhood, walls included, sum to 3:
// what they really sum to scales them. Not below this, assumed (0.5 to 0.9): at a free surface
// there is nothing to be completed.
constexpr float kLeastEvenness = 0.8f;
constexpr float kIsotropic = 2.5f;       // see evenOut
constexpr double kLeastPairShare = 0.2;  // of a pair's own weight, keeps it positive, assumed
constexpr int kCap = 300;                // iterations, assumed (100 to 500)
constexpr double kTolerance = 1e-4;      // residual over right side, assumed (1e-5 to 1e-3)
// Eq. 4.26 (Morris et al. 1997) is dt = 0.125 h^2 / nu; half of it, to be clear of the edge.
constexpr double kExplicitShare = 0.0625;
// Where neighbours exchange no more than this share x of their velocities in a step, one sweep
// does: it makes 1 - x of a difference, the solve 1 / (1 + x), and x^2 / 2 is what either is off
// exp(-x). Assumed (0.01 to 0.05: peaks of density and labels of thin swallows are alike).
constexpr float kLittleExchange = 0.03f;
// And while it stays that little, in one step for up to this many. Assumed (2 to 8).
constexpr int kMostSteps = 4;
// Share of the kernel beyond walls, counted at most, assumed (0.4 to 0.6): an edge has 0.4.
constexpr double kMostLambda = 0.5;
constexpr double kSmallSpeed_ms = 1e-6;  // residual speed nobody sees, assumed
}  // namespace

// The second moment M of the weights, identity when full, becomes what evens it out. With fourth
// moments as of isotropic neighbours, weights changed by n.B.n have the moment (tr B + 2 B) / 5
// times theirs: B = (1 - 5/2 deviator of M) over a third of its trace.
void Viscosity::evenOut(const WallSample& w, const float* moment, float* even) {
  using simd::F4;
  F4 straight = simd::load4(moment), mixed = simd::load4(moment + 4);
  if (const double steep2 = w.gradLambda.squaredNorm(); steep2 > 0) {
    // beyond the wall: lambda all round and the rest along its normal (by parts)
    const Vec3f g = w.gradLambda.cast<float>();
    const float rest = static_cast<float>(3 * (w.lambdaSlope - w.lambda) / steep2);
    straight += rest * F4{g.x() * g.x(), g.y() * g.y(), g.z() * g.z(), 0};
    straight += static_cast<float>(w.lambda) * F4{1, 1, 1, 0};
    mixed += rest * F4{g.x() * g.y(), g.x() * g.z(), g.y() * g.z(), 0};
  }
  const float third = (straight[0] + straight[1] + straight[2]) / 3;
  const float scale = 1 / std::max(kLeastEvenness, third);
  const F4 one = F4{1, 1, 1, 0};
  simd::store4(even, scale * (one - kIsotropic * scale * (straight - third * one)));
  simd::store4(even + 4, -kIsotropic * scale * scale * mixed);
}

void Viscosity::begin(Step& s) {
  const Flow& f = s.flow;
  const int n = f.count();
  wallDrag_.assign(s.velocities.size(), 0.0);
  drag_ms2_.resize(s.velocities.size(), Vec3::Zero());
  if (s.scheme.override_Pas > 0)
    s.constant_Pas = s.scheme.override_Pas;
  else if (s.fluid.model == RheologyModel::newtonian)
    s.constant_Pas = s.fluid.viscosity_Pas;
  if (s.constant_Pas == 0) {
    if (shear_.own_s.size() != s.velocities.size()) shear_.forget(s.velocities.size());
    table_.make(s.fluid);
    findRates(f, s.velocities);
  }
  waiting_.since_s += s.dt_s;
  ++waiting_.steps;
  s.pairs_s = canWait(s) ? 0 : waiting_.since_s;
  for (auto* a : {&viscosity_, &inertia_}) a->resize(n);
  force_.resize(3 * n);
  right_.resize(n);
  inverse_.resize(n);
  own_.resize(n + 1);
  own_[n] = 1;
  tensors_.resize(n + std::size_t{1});
  tensors_[n] = {};
  if (waiting_.rate_s == 0 && knowsTransposed(s)) findSlopes(f, s.velocities);
  transposed_ = s.pairs_s > 0 && knowsTransposed(s) && !slopes_s_.empty();
  field_.assign(s.pairs_s > 0 && s.constant_Pas == 0 ? 12 * (n + std::size_t{1}) : 0, 0.f);
  for (auto* a : {&v_, &residual_, &direction_, &product_}) a->shape(n, 1);
}

// Whether even after one more step it would be little.
bool Viscosity::canWait(const Step& s) const {
  return !s.scheme.explicitWhereStable && waiting_.steps < kMostSteps && waiting_.rate_s > 0 &&
         waiting_.rate_s * (waiting_.since_s + s.dt_s) < kLittleExchange;
}

// All that a slot has to itself.
void Viscosity::prepare(const Step& s, int begin, int end) {
  const auto viscosityAt = [&](const std::vector<double>& rate_s, int p) {
    return s.constant_Pas > 0 ? s.constant_Pas : apparentViscosity_Pas(s.fluid, rate_s[p]);
  };
  for (int i = begin; i < end; ++i) {
    const int p = s.flow.particle(i);
    const WallSample& w = s.flow.wall(i);
    viscosity_[i] = viscosityAt(shear_.own_s, p);
    if (!field_.empty())
      std::copy_n(shear_.field[p].data(), 12, &field_[12 * static_cast<std::size_t>(i)]);
    if (s.pairs_s > 0) evenOut(w, s.flow.neighbours.moment[i], tensors_[i].even);
    inertia_[i] = s.scheme.slip ? 1 : 1 - std::min(w.lambda, kMostLambda);
    right_[i] = s.velocities[p];
    if (w.friction > 0) {
      // Across a slit with no room for a second particle the profile is not resolved: there the
      // walls brake at least as in plane Poiseuille flow, 12 nu / gap^2.
      const double slit = viscosity_[i] * 12 / (w.gap_m * w.gap_m);
      const double shear = viscosityAt(shear_.wall_s, p) * kWallFactor * w.friction / inertia_[i];
      wallDrag_[p] = s.dt_s / s.fluid.density_kgm3 * std::max(shear, slit);
      right_[i] += wallDrag_[p] / w.friction * w.frictionVelocity;
    }
    if (transposed_)
      for (int k = 0; k < 9; ++k)
        tensors_[i].setTransposed(k / 3, k % 3, slopes_s_[p](k % 3, k / 3));
    own_[i] = static_cast<float>(inertia_[i] * (1 + wallDrag_[p]));
    v_.set(i, right_[i] / (1 + wallDrag_[p]));
    right_[i] *= inertia_[i];
  }
}

// Weights of pairs, and their sums in inverse_; what follows from the last steps' slopes goes to
// the right side.
float Viscosity::weighPairs(const Step& s) {
  const Flow& f = s.flow;
  pair_.resize(f.neighbours.index.size());
  const PairViscositySweep sweep{
      f.lists(),
      f.neighbours.r.data(),
      tensors_.data(),
      static_cast<float>(s.constant_Pas),
      &table_,
      field_.data(),
      static_cast<float>(s.pairs_s / s.fluid.density_kgm3),  // 2, and half of two evennesses
      static_cast<float>(s.scheme.leastPair_Pas),
      static_cast<float>(kSoftening * s.support_m * s.support_m / 4),
      static_cast<float>(kLeastPairShare),
      pair_.data(),
      inverse_.data(),
      transposed_,
      force_.data()};
  std::vector<float> most((f.count() + kSweepChunk - 1) / kSweepChunk);
  f.sweep([&](int begin, int end, int chunk) {
    sweep.run(begin, end);
    if (transposed_) addTransposed(s, begin, end);
    for (int i = begin; i < end; ++i) most[chunk] = std::max(most[chunk], inverse_[i]);
  });
  return most.empty() ? 0 : std::ranges::max(most);
}

// What pairs give is in force_.
void Viscosity::addTransposed(const Step& s, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    Vec3 push(&force_[3 * i]);
    if (s.flow.beside[i] && !s.scheme.slip) {
      const Vec3f g = s.flow.wall(i).gradLambda.cast<float>();
      const double weight = 2 * s.pairs_s / s.fluid.density_kgm3 * viscosity_[i];
      const PairTensors& t = tensors_[i];
      for (int a = 0; a < 3; ++a)
        push[a] +=
            weight * Vec3f(t.transposed(a, 0), t.transposed(a, 1), t.transposed(a, 2)).dot(g);
    }
    right_[i] += push;
  }
}

// Conjugate gradients, preconditioned by the diagonal, all three components at once.
Viscosity::Report Viscosity::solve(const Step& s) {
  const Flow& f = s.flow;
  const int n = f.count();
  const auto sweep = [&](const Floats3& of) {
    return ViscositySweep{f.lists(), pair_.data(), own_.data(), of.data(), product_.data()};
  };
  struct Sums {
    double right2 = 0, rz = 0, rr = 0;
    void add(float m, const float* v) {
      double square = 0;
      for (int a = 0; a < 3; ++a) square += static_cast<double>(v[a]) * v[a];
      rr += square;
      rz += m * square;
    }
  };
  const ViscositySweep first = sweep(v_), step = sweep(direction_);
  std::vector<Sums> parts((n + kSweepChunk - 1) / kSweepChunk);
  const auto total = [&] {
    Sums all;
    for (const Sums& p : parts) {
      all.right2 += p.right2;
      all.rz += p.rz;
      all.rr += p.rr;
    }
    return all;
  };
  // what viscosity did last time it will nearly do again
  f.sweep([&](int b, int e, int) {
    for (int i = b; i < e; ++i) {
      const int p = f.particle(i);
      v_.set(i, s.velocities[p] + s.dt_s * drag_ms2_[p]);
      inverse_[i] = 1 / (own_[i] + inverse_[i]);
    }
  });
  f.sweep([&](int b, int e, int c) {
    first.run(b, e);
    Sums part;
    for (int i = b; i < e; ++i) {
      part.right2 += right_[i].squaredNorm();
      for (int a = 0; a < 3; ++a) {
        residual_[i][a] = static_cast<float>(right_[i][a]) - product_[i][a];
        direction_[i][a] = inverse_[i] * residual_[i][a];
      }
      part.add(inverse_[i], residual_[i]);
    }
    parts[c] = part;
  });
  Sums now = total();
  const double goal2 =
      std::max(kTolerance * kTolerance * now.right2, kSmallSpeed_ms * kSmallSpeed_ms * n);
  Report report;
  while (now.rr > goal2) {
    report.atCap = report.iterations >= kCap;
    if (report.atCap) break;
    ++report.iterations;
    const double curvature = f.pool.sumChunks(
        n, kSweepChunk, [&](int b, int e) { return step.run(b, e); }, kSweepAlone);
    const float alpha = static_cast<float>(now.rz / curvature);
    f.sweep([&](int b, int e, int c) {
      Sums part;
      for (int i = b; i < e; ++i) {
        for (int a = 0; a < 3; ++a) {
          v_[i][a] += alpha * direction_[i][a];
          residual_[i][a] -= alpha * product_[i][a];
        }
        part.add(inverse_[i], residual_[i]);
      }
      parts[c] = part;
    });
    const Sums next = total();
    const float keep = static_cast<float>(next.rz / now.rz);
    now = next;
    f.sweep([&](int b, int e, int) {
      for (int i = b; i < e; ++i)
        for (int a = 0; a < 3; ++a)
          direction_[i][a] = inverse_[i] * residual_[i][a] + keep * direction_[i][a];
    });
  }
  return report;
}

bool Viscosity::knowsTransposed(const Step& s) {
  return s.scheme.override_Pas == 0 && !s.scheme.explicitWhereStable &&
         !(s.scheme.full && s.constant_Pas > 0);
}

bool Viscosity::isStableExplicitly(const Step& s) const {
  if (!s.scheme.explicitWhereStable) return false;
  double most = s.scheme.leastPair_Pas;
  for (double mu : viscosity_) most = std::max(most, mu);
  return s.dt_s * most / s.fluid.density_kgm3 <= kExplicitShare * s.support_m * s.support_m / 4;
}

void Viscosity::Shear::forget(std::size_t particles) {
  own_s.assign(particles, NAN);
  wall_s.assign(particles, NAN);
}

void Viscosity::look(const Flow& f, const std::vector<Vec3>& v) {
  v_.shape(f.count(), 1);
  f.sweep([&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) v_.set(i, v[f.particle(i)]);
  });
}

// Those that are not known yet.
void Viscosity::findRates(const Flow& f, const std::vector<Vec3>& v) {
  look(f, v);
  shear_.field.resize(v.size());
  const SlopeSweep slopes{f.lists(), v_.data()};
  f.sweep([&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      const int p = f.particle(i);
      if (!std::isnan(shear_.own_s[p])) continue;
      const Mat3 gradient = velocityGradient_s(f, slopes, v[p], i);
      shear_.field[p] << gradient.cast<float>(), v[p].cast<float>();
      shear_.own_s[p] = shearRate_s(gradient);
      shear_.wall_s[p] = shearRate_s(gradientBeforeWall_s(f.wall(i), v[p], gradient));
    }
  });
}

void Viscosity::findSlopes(const Flow& f, const std::vector<Vec3>& v) {
  look(f, v);
  const SlopeSweep slopes{f.lists(), v_.data()};
  slopes_s_.assign(v.size(), Mat3f::Zero());
  f.sweep([&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      const int p = f.particle(i);
      slopes_s_[p] = velocityGradient_s(f, slopes, v[p], i).cast<float>();
    }
  });
}

Viscosity::Report Viscosity::exchange(const Step& s) {
  const bool remembers = s.pairs_s > 0 && knowsTransposed(s);
  endSlopes_s_.resize(remembers ? s.flow.count() : 0);
  if (s.pairs_s == 0) return {};
  const float most = weighPairs(s);
  waiting_ = {.rate_s = most / s.pairs_s};
  if (most < kLittleExchange || isStableExplicitly(s)) return {};
  return solve(s);
}

// The solution enters only through the antisymmetric pair terms, so that momentum is kept to double
// precision however far the solve went.
void Viscosity::rub(const Step& s, int begin, int end) {
  if (s.pairs_s > 0)
    DragSweep{s.flow.lists(), pair_.data(), v_.data(), force_.data()}.run(begin, end);
  else
    std::fill(&force_[0] + 3 * begin, &force_[0] + 3 * end, 0.0);
  for (int i = begin; i < end; ++i) {
    const int p = s.flow.particle(i);
    const Vec3 next = (right_[i] - Vec3(&force_[3 * i])) / (inertia_[i] * (1 + wallDrag_[p]));
    drag_ms2_[p] = (next - s.velocities[p]) / s.dt_s;
    s.velocities[p] = next;
  }
}

// The next step's viscosities follow from this field, before pressure has its say: what it does to
// single particles is noise, which would thin a fluid that ought to be stiff.
void Viscosity::end(const Step& s) {
  if (s.constant_Pas > 0) {
    shear_ = {};
    return;
  }
  shear_.forget(s.velocities.size());
  findRates(s.flow, s.velocities);
}

void Viscosity::accept(const Flow& f) {
  if (endSlopes_s_.empty()) return;
  slopes_s_.resize(f.walls.size(), Mat3f::Zero());
  for (std::size_t p = 0; p < slopes_s_.size(); ++p)
    if (f.neighbours.slot[p] < 0) slopes_s_[p].setZero();
  f.sweep([&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      Mat3f& slope = slopes_s_[f.particle(i)];
      slope = slope.isZero(0) ? endSlopes_s_[i] : Mat3f(0.5f * (slope + endSlopes_s_[i]));
    }
  });
}

Viscosity::Report Viscosity::apply(const Flow& f, const Fluid& fluid, const Scheme& scheme,
                                   double dt_s, double support_m, std::vector<Vec3>& v) {
  Step step{f, fluid, scheme, dt_s, support_m, v};
  begin(step);
  f.sweep([&](int begin, int end, int) { prepare(step, begin, end); });
  const Report report = exchange(step);
  f.sweep([&](int begin, int end, int) { rub(step, begin, end); });
  end(step);
  return report;
}
}  // namespace swallowclip::bolus
