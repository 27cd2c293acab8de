// SPDX-License-Identifier: MIT
#include "bolus/sweeps.h"

#include <algorithm>
#include <cmath>

#include "bolus/cubic_spline.h"
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
    store4(s.a + 4 * i, m * (sum3(x, y, z) + k * load4(s.wall + 4 * i)));
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

/// Eight particles at a time: what follows the sums of one waits for them, that of eight does not.
SC_CLONES StepSweep::Sums step(const StepSweep& s, int begin, int end) {
  D8 residual, ahead, moved;
  F8 most = all(0);
  for (int i = begin; i < end; i += kLanes) {
    const int lanes = std::min(kLanes, end - i);
    float rates[kLanes] = {};
    for (int k = 0; k < lanes; ++k) rates[k] = rateAt(s.pairs, s.a, i + k);
    const I8 slots = kCount + allInt(i);
    int at[kLanes];
    std::memcpy(at, &slots, sizeof at);
    const F8x3 a = gather3(s.a, at), w = gather3(s.wall, at);
    const F8 left = load(s.source + i) + (load(rates) + (a.x * w.x + a.y * w.y + a.z * w.z));
    const F8 diagonal = load(s.diagonal + i), x = load(s.x + i), y = load(s.y + i);
    const I8 part = (kCount < allInt(lanes)) & (diagonal > all(0));
    const F8 scale = largest(diagonal, all(1e-30f)) / all(s.relax);
    const F8 hold = load(s.hold + i), held = scale * hold;
    const F8 pulled = (y * scale + left + load(s.room + i)) * hold / (held + all(1));
    const F8 next = largest(all(0), y + left / scale) + smallest(all(0), pulled);
    // too much pressure is as wrong as too little, unless it is zero already
    const F8 way = select(part, next - y, all(0)), size = magnitude(way) * scale;
    residual.add(size);
    moved.add(way);
    most = largest(most, size);
    ahead.add(way * select(part, next - x, all(0)));
    const F8 onward = next + all(s.momentum) * (next - x) + all(s.lead) * way;
    const F8 on = select(hold > all(0), onward, largest(all(0), onward));
    const F8 newX = select(part, next, all(0)), newY = select(part, on, all(0));
    if (lanes == kLanes) {
      store(s.x + i, newX);
      store(s.y + i, newY);
      continue;
    }
    for (int k = 0; k < lanes; ++k) s.x[i + k] = newX[k], s.y[i + k] = newY[k];
  }
  StepSweep::Sums sums{.residual = sum(residual), .moved = sum(moved), .ahead = sum(ahead)};
  for (int k = 0; k < kLanes; ++k) sums.most = std::max<double>(sums.most, most[k]);
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
    const F4 own = load4(v), out = s.own[i] * own + sum3(ox, oy, oz), both = own * out;
    store4(s.out + 4 * i, out);
    product += static_cast<double>(both[0] + both[1] + both[2]);
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
      stress += k * root(gx * gx + gy * gy + gz * gz) * load(s.r + e);
    }
    s.out[3 * i] = sum(x);
    s.out[3 * i + 1] = sum(y);
    s.out[3 * i + 2] = sum(z);
    s.stress[i] = sum(stress) / 6;
  }
}

SC_CLONES void attraction(const AttractionSweep& s, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    const float* own = s.lists.places + 4 * static_cast<long>(s.lists.self[i]);
    D8 x, y, z;
    F8 stress = all(0);
    for (int e = s.lists.start[i]; e < s.lists.start[i + 1]; e += kLanes) {
      const F8x3 o = gather3(s.lists.places, s.lists.candidates + e);
      const F8 dx = all(own[0]) - o.x, dy = all(own[1]) - o.y, dz = all(own[2]) - o.z;
      const F8 square = dx * dx + dy * dy + dz * dz;
      const F8 slope = all(s.factor) * cubic::slopePerQ(root(square) * all(s.perHalfSupport));
      x.add(slope * dx);
      y.add(slope * dy);
      z.add(slope * dz);
      stress -= slope * square;
    }
    s.out[3 * i] = sum(x);
    s.out[3 * i + 1] = sum(y);
    s.out[3 * i + 2] = sum(z);
    s.stress[i] = sum(stress) / 6;
  }
}

// One name for each sum: an array of them would live in memory.
SC_CLONES void slope(const SlopeSweep& s, int i, float* out) {
  const F8 vx = all(s.v[4 * i]), vy = all(s.v[4 * i + 1]), vz = all(s.v[4 * i + 2]), none = all(0);
  F8 xx = none, xy = none, xz = none, yx = none, yy = none, yz = none, zx = none, zy = none,
     zz = none;
  for (int e = s.pairs.start[i]; e < s.pairs.stop[i]; e += kLanes) {
    const F8x3 o = gather3(s.v, s.pairs.index + e);
    const F8 x = o.x - vx, y = o.y - vy, z = o.z - vz;
    const F8 gx = load(s.pairs.gx + e), gy = load(s.pairs.gy + e), gz = load(s.pairs.gz + e);
    xx += x * gx;
    xy += x * gy;
    xz += x * gz;
    yx += y * gx;
    yy += y * gy;
    yz += y * gz;
    zx += z * gx;
    zy += z * gy;
    zz += z * gz;
  }
  const F4 rows[3] = {sum3(xx, xy, xz), sum3(yx, yy, yz), sum3(zx, zy, zz)};
  for (int k = 0; k < 9; ++k) out[k] = rows[k / 3][k % 3];
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

/// Row r of the gradient half way between i and its neighbours, n along the pair. Across it the
/// mean of both, which are smooth over the kernel; along it what is half way in the cubic through
/// both ends' velocities and slopes, 3/2 of the difference less half of the mean slope.
SC_INLINE F8x3 midRow(const PairViscositySweep& s, int r, int i, const int* at, const F8x3& n,
                      F8 perMetre) {
  const float* own = s.field + 12 * static_cast<long>(i) + 4 * r;
  const F8x4 o = gather4<12>(s.field + 4 * r, at);
  const F8 half = all(0.5f);
  const F8 x = half * (all(own[0]) + o.x), y = half * (all(own[1]) + o.y),
           z = half * (all(own[2]) + o.z);
  const F8 lacks = all(1.5f) * ((all(own[3]) - o.w) * perMetre - (x * n.x + y * n.y + z * n.z));
  return {x + lacks * n.x, y + lacks * n.y, z + lacks * n.z};
}

SC_INLINE F8 tableAt(const ViscosityTable& t, F8 square) {
  constexpr int kPart = ViscosityTable::kPartBits;
  // in this order what is no number becomes the least
  const F8 within =
      smallest(largest(square, all(ViscosityTable::kLeast)), all(ViscosityTable::kMost));
  I8 word;
  std::memcpy(&word, &within, sizeof word);
  const I8 node = (word >> kPart) - allInt(t.first);
  const F8 part =
      __builtin_convertvector(word & allInt((1 << kPart) - 1), F8) * all(1.f / (1 << kPart));
  F8 value, step;
  for (int lane = 0; lane < kLanes; ++lane) {
    const ViscosityTable::Node& at = t.nodes[node[lane]];
    value[lane] = at.value_Pas;
    step[lane] = at.step_Pas;
  }
  return value + part * step;
}

SC_INLINE F8 pairViscosityAt(const PairViscositySweep& s, int i, const int* at, const F8x3& g,
                             F8 size, F8 r) {
  if (s.constant > 0) return all(s.constant);
  const F8 scale = all(-1) / largest(size, all(1e-30f)), perMetre = all(1) / r;
  const F8x3 n{scale * g.x, scale * g.y, scale * g.z};
  const F8x3 x = midRow(s, 0, i, at, n, perMetre), y = midRow(s, 1, i, at, n, perMetre),
             z = midRow(s, 2, i, at, n, perMetre);
  const F8 xy = x.y + y.x, xz = x.z + z.x, yz = y.z + z.y;
  return tableAt(*s.table,
                 all(2) * (x.x * x.x + y.y * y.y + z.z * z.z) + xy * xy + xz * xz + yz * yz);
}

struct PairWeights {
  F8 c, way;  ///< way times g is -c x / 2
};
/// Of eight pairs from e on; `even` the neighbours' PairTensors::even, turned into columns.
SC_INLINE PairWeights pairWeights(const PairViscositySweep& s, const Tensor8& own, int i, int e,
                                  const F8 (&even)[8]) {
  const F8 r = load(s.r + e);
  const F8x3 g{load(s.pairs.gx + e), load(s.pairs.gy + e), load(s.pairs.gz + e)};
  const F8 square = g.x * g.x + g.y * g.y + g.z * g.z, size = root(square);
  const Tensor8 both2{own.xx + even[0], own.yy + even[1], own.zz + even[2],
                      own.xy + even[4], own.xz + even[5], own.yz + even[6]};
  const F8 share =
      largest(all(2 * s.leastEven), twice(both2, g.x, g.y, g.z) / largest(square, all(1e-30f)));
  const F8 mu = largest(all(s.leastPair), pairViscosityAt(s, i, s.pairs.index + e, g, size, r));
  const F8 weight = all(s.scale) * mu * share * r / (r * r + all(s.eta2));
  return {weight * size, all(0.5f) * weight * r};
}

SC_CLONES void pairViscosity(const PairViscositySweep& s, int begin, int end) {
  constexpr int kRecord = sizeof(PairTensors) / sizeof(float);
  for (int i = begin; i < end; ++i) {
    const PairTensors& t = s.tensors[i];
    const Tensor8 own{all(t.even[0]), all(t.even[1]), all(t.even[2]),
                      all(t.even[4]), all(t.even[5]), all(t.even[6])};
    F8 total = all(0), even[8], slope[8];
    D8 x, y, z;
    for (int e = s.pairs.start[i]; e < s.pairs.stop[i]; e += kLanes) {
      const int* at = s.pairs.index + e;
      gather8<kRecord>(s.tensors->even, at, even);
      const PairWeights w = pairWeights(s, own, i, e, even);
      store(s.c + e, w.c);
      total += w.c;
      if (!s.withSlopes) continue;
      gather8<kRecord>(s.tensors->slope, at, slope);
      const F8 gx = w.way * load(s.pairs.gx + e), gy = w.way * load(s.pairs.gy + e),
               gz = w.way * load(s.pairs.gz + e);
      x.add((all(t.slope[0]) + slope[0]) * gx + (all(t.slope[1]) + slope[1]) * gy +
            (all(t.slope[2]) + slope[2]) * gz);
      y.add((all(t.slope[3]) + slope[3]) * gx + (all(t.slope[4]) + slope[4]) * gy +
            (all(t.slope[5]) + slope[5]) * gz);
      z.add((all(t.slope[6]) + slope[6]) * gx + (all(t.slope[7]) + slope[7]) * gy +
            (all(t.even[3]) + even[3]) * gz);
    }
    s.diagonal[i] = sum(total);
    if (!s.withSlopes) continue;
    s.transposed[3 * i] = sum(x);
    s.transposed[3 * i + 1] = sum(y);
    s.transposed[3 * i + 2] = sum(z);
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
void AttractionSweep::run(int begin, int end) const {
  attraction(*this, begin, end);
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
