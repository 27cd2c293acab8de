// SPDX-License-Identifier: MIT
#include "bolus/sweeps.h"

#include <algorithm>
#include <cmath>

#include "core/simd.h"

namespace swallowclip::bolus {
using namespace simd;

// The bodies are free functions, for only such can be compiled once per instruction set.
namespace {
SC_CLONES void pressure(const PressureSweep& s, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    const F8 own = all(s.k[i]);
    F8 x = all(0), y = all(0), z = all(0);
    for (int e = s.pairs.start[i]; e < s.pairs.stop[i]; e += kLanes) {
      const F8 k = own + gather(s.k, s.pairs.index + e);
      x += k * load(s.pairs.gx + e);
      y += k * load(s.pairs.gy + e);
      z += k * load(s.pairs.gz + e);
    }
    const float k = s.k[i], m = -s.mobility[i];
    const float* wall = s.wall + 4 * i;
    float* a = s.a + 4 * i;
    a[0] = m * (sum(x) + k * wall[0]);
    a[1] = m * (sum(y) + k * wall[1]);
    a[2] = m * (sum(z) + k * wall[2]);
  }
}

/// sum (v_i - v_j).g_ij
SC_INLINE float rateAt(const PairLists& p, const float* v, int i) {
  const F8 x = all(v[4 * i]), y = all(v[4 * i + 1]), z = all(v[4 * i + 2]);
  F8 total = all(0);
  for (int e = p.start[i]; e < p.stop[i]; e += kLanes) {
    const F8x3 o = gather3(v, p.index + e);
    total += (x - o.x) * load(p.gx + e) + (y - o.y) * load(p.gy + e) + (z - o.z) * load(p.gz + e);
  }
  return sum(total);
}

SC_CLONES StepSweep::Sums step(const StepSweep& s, int begin, int end) {
  StepSweep::Sums sums;
  for (int i = begin; i < end; ++i) {
    if (s.diagonal[i] <= 0) {
      s.x[i] = s.y[i] = 0;
      continue;
    }
    const float *a = s.a + 4 * i, *w = s.wall + 4 * i;
    const float wall = a[0] * w[0] + a[1] * w[1] + a[2] * w[2];
    const float residual = s.source[i] + (rateAt(s.pairs, s.a, i) + wall);
    const float next = std::max(s.least, s.y[i] + s.relax * residual / s.diagonal[i]);
    // too much pressure is as wrong as too little, unless it is zero already
    const double left = std::abs(next - s.y[i]) * s.diagonal[i] / s.relax;
    sums.residual += left;
    sums.most = std::max(sums.most, left);
    sums.ahead += static_cast<double>(next - s.y[i]) * (next - s.x[i]);
    s.y[i] = std::max(s.least, next + s.momentum * (next - s.x[i]));
    s.x[i] = next;
  }
  return sums;
}

SC_CLONES double viscosity(const ViscositySweep& s, int begin, int end) {
  double product = 0;
  for (int i = begin; i < end; ++i) {
    const float* v = s.v + 4 * i;
    const F8 x = all(v[0]), y = all(v[1]), z = all(v[2]);
    F8 ox = all(0), oy = all(0), oz = all(0);
    for (int e = s.pairs.start[i]; e < s.pairs.stop[i]; e += kLanes) {
      const F8x3 o = gather3(s.v, s.pairs.index + e);
      const F8 c = load(s.c + e);
      ox += c * (x - o.x);
      oy += c * (y - o.y);
      oz += c * (z - o.z);
    }
    float* out = s.out + 4 * i;
    out[0] = s.own[i] * v[0] + sum(ox);
    out[1] = s.own[i] * v[1] + sum(oy);
    out[2] = s.own[i] * v[2] + sum(oz);
    for (int a = 0; a < 3; ++a) product += static_cast<double>(v[a]) * out[a];
  }
  return product;
}

SC_CLONES void diagonalOf(const DiagonalSweep& s, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    F8 x = all(0), y = all(0), z = all(0), squares = all(0);
    for (int e = s.pairs.start[i]; e < s.pairs.stop[i]; e += kLanes) {
      const F8 gx = load(s.pairs.gx + e), gy = load(s.pairs.gy + e), gz = load(s.pairs.gz + e);
      x += gx;
      y += gy;
      z += gz;
      squares += gather(s.mobility, s.pairs.index + e) * (gx * gx + gy * gy + gz * gz);
    }
    const float* wall = s.wall + 4 * i;
    const float ox = sum(x) + wall[0], oy = sum(y) + wall[1], oz = sum(z) + wall[2];
    s.diagonal[i] = s.mobility[i] * (ox * ox + oy * oy + oz * oz) + sum(squares);
  }
}

SC_CLONES void rateOf(const RateSweep& s, int begin, int end) {
  for (int i = begin; i < end; ++i) s.rate[i] = rateAt(s.pairs, s.v, i);
}

SC_CLONES void gradient(const GradientSweep& s, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    const F8 own = all(s.k[i]);
    D8 x, y, z;
    F8 stress = all(0);
    for (int e = s.pairs.start[i]; e < s.pairs.stop[i]; e += kLanes) {
      const F8 k = own + gather(s.k, s.pairs.index + e);
      const F8 gx = load(s.pairs.gx + e), gy = load(s.pairs.gy + e), gz = load(s.pairs.gz + e);
      x.add(k * gx);
      y.add(k * gy);
      z.add(k * gz);
      if (s.stress) stress += k * root(gx * gx + gy * gy + gz * gz) * load(s.r + e);
    }
    s.out[3 * i] = sum(x);
    s.out[3 * i + 1] = sum(y);
    s.out[3 * i + 2] = sum(z);
    if (s.stress) s.stress[i] = sum(stress) / 6;
  }
}

SC_CLONES void slope(const SlopeSweep& s, int i, float* out) {
  const F8 vx = all(s.v[4 * i]), vy = all(s.v[4 * i + 1]), vz = all(s.v[4 * i + 2]);
  F8 t[9] = {};
  for (int e = s.pairs.start[i]; e < s.pairs.stop[i]; e += kLanes) {
    const F8x3 o = gather3(s.v, s.pairs.index + e);
    const F8 d[3] = {o.x - vx, o.y - vy, o.z - vz};
    const F8 g[3] = {load(s.pairs.gx + e), load(s.pairs.gy + e), load(s.pairs.gz + e)};
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) t[3 * a + b] += d[a] * g[b];
  }
  for (int k = 0; k < 9; ++k) out[k] = sum(t[k]);
}

SC_CLONES void least(const LeastSweep& s, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    F8 l = all(s.value[i]);
    for (int e = s.pairs.start[i]; e < s.pairs.stop[i]; e += kLanes)
      l = smallest(l, gather(s.value, s.pairs.index + e));
    float one = l[0];
    for (int k = 1; k < kLanes; ++k) one = std::min(one, static_cast<float>(l[k]));
    s.out[i] = one;
  }
}

struct Tensor8 {
  F8 xx, yy, zz, xy, xz, yz;
};
SC_INLINE F8 twice(const Tensor8& t, F8 x, F8 y, F8 z) {  // n.T.n
  return x * x * t.xx + y * y * t.yy + z * z * t.zz +
         all(2) * (x * y * t.xy + x * z * t.xz + y * z * t.yz);
}

SC_CLONES void pairViscosity(const PairViscositySweep& s, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    const F8 mu = all(s.viscosity[i]);
    const float* b = s.evenness + 8 * i;
    const Tensor8 own{all(b[0]), all(b[1]), all(b[2]), all(b[4]), all(b[5]), all(b[6])};
    F8 total = all(0);
    for (int e = s.pairs.start[i]; e < s.pairs.stop[i]; e += kLanes) {
      const int* at = s.pairs.index + e;
      const F8 other = gather(s.viscosity, at), r = load(s.r + e);
      const F8 x = load(s.pairs.gx + e), y = load(s.pairs.gy + e), z = load(s.pairs.gz + e);
      const F8 square = x * x + y * y + z * z;
      const F8x3 straight = gather3<8>(s.evenness, at), mixed = gather3<8>(s.evenness + 4, at);
      const Tensor8 both2{own.xx + straight.x, own.yy + straight.y, own.zz + straight.z,
                          own.xy + mixed.x,    own.xz + mixed.y,    own.yz + mixed.z};
      const F8 even =
          largest(all(2 * s.leastEven), twice(both2, x, y, z) / largest(square, all(1e-30f)));
      // harmonic: the thinner of two layers decides the stress (Cleary & Monaghan 1999)
      const F8 both = largest(all(s.leastPair), all(2) * mu * other / (mu + other));
      const F8 c = all(s.scale) * both * even * root(square) * r / (r * r + all(s.eta2));
      store(s.c + e, c);
      total += c;
    }
    s.diagonal[i] = sum(total);
  }
}

SC_CLONES void drag(const DragSweep& s, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    const float* v = s.v + 4 * i;
    const F8 vx = all(v[0]), vy = all(v[1]), vz = all(v[2]);
    D8 x, y, z;
    for (int e = s.pairs.start[i]; e < s.pairs.stop[i]; e += kLanes) {
      const F8x3 o = gather3(s.v, s.pairs.index + e);
      const F8 c = load(s.c + e);
      x.add(c * (vx - o.x));
      y.add(c * (vy - o.y));
      z.add(c * (vz - o.z));
    }
    s.out[3 * i] = sum(x);
    s.out[3 * i + 1] = sum(y);
    s.out[3 * i + 2] = sum(z);
  }
}
}  // namespace

void PressureSweep::run(int begin, int end) const {
  pressure(*this, begin, end);
}
StepSweep::Sums StepSweep::run(int begin, int end) const {
  return step(*this, begin, end);
}
double ViscositySweep::run(int begin, int end) const {
  return viscosity(*this, begin, end);
}
void DiagonalSweep::run(int begin, int end) const {
  diagonalOf(*this, begin, end);
}
void RateSweep::run(int begin, int end) const {
  rateOf(*this, begin, end);
}
void GradientSweep::run(int begin, int end) const {
  gradient(*this, begin, end);
}
void PairViscositySweep::run(int begin, int end) const {
  pairViscosity(*this, begin, end);
}
void SlopeSweep::run(int slot, float* out9) const {
  slope(*this, slot, out9);
}
void LeastSweep::run(int begin, int end) const {
  least(*this, begin, end);
}
void DragSweep::run(int begin, int end) const {
  drag(*this, begin, end);
}
}  // namespace swallowclip::bolus
