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
    sums.residual += std::abs(next - s.y[i]) * s.diagonal[i] / s.relax;
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
}  // namespace swallowclip::bolus
