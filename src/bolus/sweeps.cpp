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
    for (int e = s.pairs.start[i]; e < s.pairs.start[i + 1]; e += kLanes) {
      const F8 k = own + gather(s.k, s.pairs.index + e);
      x += k * load(s.pairs.gx + e);
      y += k * load(s.pairs.gy + e);
      z += k * load(s.pairs.gz + e);
    }
    const float wall = s.k[i], m = -s.mobility[i];
    s.ax[i] = m * (sum(x) + wall * s.wallX[i]);
    s.ay[i] = m * (sum(y) + wall * s.wallY[i]);
    s.az[i] = m * (sum(z) + wall * s.wallZ[i]);
  }
}

SC_CLONES StepSweep::Sums step(const StepSweep& s, int begin, int end) {
  StepSweep::Sums sums;
  for (int i = begin; i < end; ++i) {
    if (s.diagonal[i] <= 0) {
      s.x[i] = s.y[i] = 0;
      continue;
    }
    const F8 x = all(s.ax[i]), y = all(s.ay[i]), z = all(s.az[i]);
    F8 rate = all(0);
    for (int e = s.pairs.start[i]; e < s.pairs.start[i + 1]; e += kLanes) {
      const int* at = s.pairs.index + e;
      rate += (x - gather(s.ax, at)) * load(s.pairs.gx + e) +
              (y - gather(s.ay, at)) * load(s.pairs.gy + e) +
              (z - gather(s.az, at)) * load(s.pairs.gz + e);
    }
    const float wall = s.ax[i] * s.wallX[i] + s.ay[i] * s.wallY[i] + s.az[i] * s.wallZ[i];
    const float residual = s.source[i] + (sum(rate) + wall);
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
    const F8 x = all(s.vx[i]), y = all(s.vy[i]), z = all(s.vz[i]);
    F8 ox = all(0), oy = all(0), oz = all(0);
    for (int e = s.pairs.start[i]; e < s.pairs.start[i + 1]; e += kLanes) {
      const int* at = s.pairs.index + e;
      const F8 c = load(s.c + e);
      ox += c * (x - gather(s.vx, at));
      oy += c * (y - gather(s.vy, at));
      oz += c * (z - gather(s.vz, at));
    }
    const float own = s.own[i];
    s.outX[i] = own * s.vx[i] + sum(ox);
    s.outY[i] = own * s.vy[i] + sum(oy);
    s.outZ[i] = own * s.vz[i] + sum(oz);
    product += static_cast<double>(s.vx[i]) * s.outX[i] + static_cast<double>(s.vy[i]) * s.outY[i] +
               static_cast<double>(s.vz[i]) * s.outZ[i];
  }
  return product;
}

SC_CLONES void diagonalOf(const DiagonalSweep& s, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    F8 x = all(0), y = all(0), z = all(0), squares = all(0);
    for (int e = s.pairs.start[i]; e < s.pairs.start[i + 1]; e += kLanes) {
      const F8 gx = load(s.pairs.gx + e), gy = load(s.pairs.gy + e), gz = load(s.pairs.gz + e);
      x += gx;
      y += gy;
      z += gz;
      squares += gather(s.mobility, s.pairs.index + e) * (gx * gx + gy * gy + gz * gz);
    }
    const float ox = sum(x) + s.wallX[i], oy = sum(y) + s.wallY[i], oz = sum(z) + s.wallZ[i];
    s.diagonal[i] = s.mobility[i] * (ox * ox + oy * oy + oz * oz) + sum(squares);
  }
}

SC_CLONES void rateOf(const RateSweep& s, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    const F8 x = all(s.vx[i]), y = all(s.vy[i]), z = all(s.vz[i]);
    F8 total = all(0);
    for (int e = s.pairs.start[i]; e < s.pairs.start[i + 1]; e += kLanes) {
      const int* at = s.pairs.index + e;
      total += (x - gather(s.vx, at)) * load(s.pairs.gx + e) +
               (y - gather(s.vy, at)) * load(s.pairs.gy + e) +
               (z - gather(s.vz, at)) * load(s.pairs.gz + e);
    }
    s.rate[i] = sum(total);
  }
}

SC_CLONES void gradient(const GradientSweep& s, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    const F8 own = all(s.k[i]);
    D8 x{}, y{}, z{};
    for (int e = s.pairs.start[i]; e < s.pairs.start[i + 1]; e += kLanes) {
      const F8 k = own + gather(s.k, s.pairs.index + e);
      x += wide(k * load(s.pairs.gx + e));
      y += wide(k * load(s.pairs.gy + e));
      z += wide(k * load(s.pairs.gz + e));
    }
    s.out[3 * i] = sum(x);
    s.out[3 * i + 1] = sum(y);
    s.out[3 * i + 2] = sum(z);
  }
}

SC_INLINE F8 steepness(const PairLists& p, int e) {
  const F8 x = load(p.gx + e), y = load(p.gy + e), z = load(p.gz + e);
  return root(x * x + y * y + z * z);
}

struct Tensor8 {
  F8 xx, yy, zz, xy, xz, yz;
};
SC_INLINE F8 twice(const Tensor8& t, F8 x, F8 y, F8 z) {  // n.T.n
  return x * x * t.xx + y * y * t.yy + z * z * t.zz +
         all(2) * (x * y * t.xy + x * z * t.xz + y * z * t.yz);
}

SC_CLONES void pairViscosity(const PairViscositySweep& s, int begin, int end) {
  const auto& b = s.evenness->of;
  for (int i = begin; i < end; ++i) {
    const F8 mu = all(s.viscosity[i]);
    const Tensor8 own{all(b[0][i]), all(b[1][i]), all(b[2][i]),
                      all(b[3][i]), all(b[4][i]), all(b[5][i])};
    F8 total = all(0);
    for (int e = s.pairs.start[i]; e < s.pairs.start[i + 1]; e += kLanes) {
      const int* at = s.pairs.index + e;
      const F8 other = gather(s.viscosity, at), r = load(s.r + e);
      const F8 x = load(s.pairs.gx + e), y = load(s.pairs.gy + e), z = load(s.pairs.gz + e);
      const F8 square = x * x + y * y + z * z;
      const Tensor8 both2{own.xx + gather(b[0].data(), at), own.yy + gather(b[1].data(), at),
                          own.zz + gather(b[2].data(), at), own.xy + gather(b[3].data(), at),
                          own.xz + gather(b[4].data(), at), own.yz + gather(b[5].data(), at)};
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

SC_CLONES void momentOf(const MomentSweep& s, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    Tensor8 t{all(0), all(0), all(0), all(0), all(0), all(0)};
    for (int e = s.pairs.start[i]; e < s.pairs.start[i + 1]; e += kLanes) {
      const F8 x = load(s.pairs.gx + e), y = load(s.pairs.gy + e), z = load(s.pairs.gz + e);
      const F8 w = load(s.r + e) / largest(root(x * x + y * y + z * z), all(1e-30f));
      t.xx += w * x * x;
      t.yy += w * y * y;
      t.zz += w * z * z;
      t.xy += w * x * y;
      t.xz += w * x * z;
      t.yz += w * y * z;
    }
    auto& m = s.moment->of;
    m[0][i] += sum(t.xx);
    m[1][i] += sum(t.yy);
    m[2][i] += sum(t.zz);
    m[3][i] += sum(t.xy);
    m[4][i] += sum(t.xz);
    m[5][i] += sum(t.yz);
  }
}

SC_CLONES void stress(const StressSweep& s, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    const F8 own = all(s.k[i]);
    F8 total = all(0);
    for (int e = s.pairs.start[i]; e < s.pairs.start[i + 1]; e += kLanes)
      total += (own + gather(s.k, s.pairs.index + e)) * steepness(s.pairs, e) * load(s.r + e);
    s.out[i] = sum(total) / 6;
  }
}

SC_CLONES void drag(const DragSweep& s, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    const F8 vx = all(s.vx[i]), vy = all(s.vy[i]), vz = all(s.vz[i]);
    D8 x{}, y{}, z{};
    for (int e = s.pairs.start[i]; e < s.pairs.start[i + 1]; e += kLanes) {
      const int* at = s.pairs.index + e;
      const F8 c = load(s.c + e);
      x += wide(c * (vx - gather(s.vx, at)));
      y += wide(c * (vy - gather(s.vy, at)));
      z += wide(c * (vz - gather(s.vz, at)));
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
void MomentSweep::run(int begin, int end) const {
  momentOf(*this, begin, end);
}
void StressSweep::run(int begin, int end) const {
  stress(*this, begin, end);
}
void DragSweep::run(int begin, int end) const {
  drag(*this, begin, end);
}
}  // namespace swallowclip::bolus
