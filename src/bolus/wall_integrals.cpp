// SPDX-License-Identifier: MIT
#include "bolus/wall_integrals.h"

#include <algorithm>
#include <cmath>

#include "bolus/cubic_spline.h"
#include "core/simd.h"
#include "core/vec.h"

namespace swallowclip::bolus {
using namespace simd;

void PieceArrays::resize(std::size_t n) {
  for (auto& f : field) f.assign(n + kLanes, 0.f);
  std::fill(field[kReach].begin(), field[kReach].end(), -1.f);
}

namespace {
// Triangle rules of degree 2 and 5 (Strang & Fix 1973; Cowper 1973).
struct Point {
  float a, b, c, weight;
};
constexpr float kA = 0.059715871789769820f, kB = 0.470142064105115090f;
constexpr float kC = 0.797426985353087322f, kD = 0.101286507323456339f;
constexpr float kW1 = 0.132394152788506181f, kW2 = 0.125939180544827153f;
constexpr Point kRule3[] = {{2.f / 3, 1.f / 6, 1.f / 6, 1.f / 3},
                            {1.f / 6, 2.f / 3, 1.f / 6, 1.f / 3},
                            {1.f / 6, 1.f / 6, 2.f / 3, 1.f / 3}};
constexpr Point kRule1[] = {{1.f / 3, 1.f / 3, 1.f / 3, 1.f}};
constexpr Point kRule7[] = {{1.f / 3, 1.f / 3, 1.f / 3, 0.225f},
                            {kA, kB, kB, kW1},
                            {kB, kA, kB, kW1},
                            {kB, kB, kA, kW1},
                            {kC, kD, kD, kW2},
                            {kD, kC, kD, kW2},
                            {kD, kD, kC, kW2}};
struct Rule {
  const Point* points;
  int count;
};
constexpr Rule kRules[] = {{kRule1, 1}, {kRule3, 3}, {kRule7, 7}};
// From this many radii (and a spacing) on the solid angle is left to the quadrature as well; within
// 0.1 % of lambda (wall_field_test).
constexpr float kFarRadii = 2.5f;
constexpr float kPif = static_cast<float>(kPi);

// atan2 to 2e-7: octant reduction, then an odd polynomial (coefficients of Cephes' atanf, Moshier).
SC_INLINE F8 arcTangent(F8 y, F8 x) {
  const F8 ax = magnitude(x), ay = magnitude(y);
  const F8 high = largest(ax, ay), low = smallest(ax, ay);
  F8 t = low / largest(high, all(1e-37f));
  const I8 steep = t > all(0.4142135623730950f);
  t = select(steep, (t - all(1)) / (t + all(1)), t);
  const F8 z = t * t;
  F8 angle =
      (((all(8.05374449538e-2f) * z - all(1.38776856032e-1f)) * z + all(1.99777106478e-1f)) * z -
       all(3.33329491539e-1f)) *
          z * t +
      t;
  angle += select(steep, all(kPif / 4), all(0));
  angle = select(ay > ax, all(kPif / 2) - angle, angle);
  angle = select(x < all(0), all(kPif) - angle, angle);
  return select(y < all(0), -angle, angle);
}

struct V {
  F8 x, y, z;
};
SC_INLINE F8 dot(const V& a, const V& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

SC_CLONES void integrate(const WallQuadrature& q, float px, float py, float pz, int begin, int end,
                         WallSums& sums) {
  using P = PieceArrays;
  const PieceArrays& p = *q.pieces;
  const F8 ox = all(px), oy = all(py), oz = all(pz), zero = all(0);
  F8 lambda = zero, shape = zero, flux = zero, friction = zero, area = zero, speed = zero;
  V grad{zero, zero, zero}, drag{zero, zero, zero};
  const I8 lanes{0, 1, 2, 3, 4, 5, 6, 7};
  F8 nearest2 = all(1e30f);
  I8 nearest = allInt(-1);
  for (int k = begin; k < end; k += kLanes) {
    const F8 cx = load(p.at(P::kCx) + k) - ox, cy = load(p.at(P::kCy) + k) - oy,
             cz = load(p.at(P::kCz) + k) - oz, reach = load(p.at(P::kReach) + k);
    const F8 away2 = cx * cx + cy * cy + cz * cz;
    const I8 near = (away2 < reach * reach) & (reach > zero) & (lanes + allInt(k) < allInt(end));
    if (!any(near)) continue;
    const I8 nearer = near & (away2 < nearest2);
    nearest2 = select(nearer, away2, nearest2);
    nearest = nearer ? lanes + allInt(k) : nearest;
    speed = largest(speed, select(near, load(p.at(P::kSpeed) + k), zero));
    const V a{load(p.at(P::kAx) + k) - ox, load(p.at(P::kAy) + k) - oy,
              load(p.at(P::kAz) + k) - oz};
    const V b{load(p.at(P::kBx) + k) - ox, load(p.at(P::kBy) + k) - oy,
              load(p.at(P::kBz) + k) - oz};
    const V c{load(p.at(P::kGx) + k) - ox, load(p.at(P::kGy) + k) - oy,
              load(p.at(P::kGz) + k) - oz};
    const V n{load(p.at(P::kNx) + k), load(p.at(P::kNy) + k), load(p.at(P::kNz) + k)};
    const V v{load(p.at(P::kVx) + k), load(p.at(P::kVy) + k), load(p.at(P::kVz) + k)};
    const F8 pieceArea = select(near, load(p.at(P::kArea) + k), zero);
    const F8 offset = dot(a, n);  // r . n, the same all over the piece
    const F8 radius = all(kFarRadii) * (reach - all(q.support_m));
    const I8 close = near & (away2 < largest(radius * radius, all(q.spacing_m * q.spacing_m)));
    if (any(close)) {
      // solid angle (van Oosterom & Strackee 1983), positive from the inner side: twice the area
      // times the distance of the plane is the triple product, without cancellation
      const F8 la = root(dot(a, a)), lb = root(dot(b, b)), lc = root(dot(c, c));
      const F8 triple = all(2) * pieceArea * offset;
      const F8 below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
      lambda += select(close, all(1 / (2 * kPif)) * arcTangent(triple, below), zero);
    }
    const F8 singular = select(close, zero, all(1 / (4 * kPif)));
    F8 inside = zero, shear = zero;  // of W and W / distance over the piece
    const F8 kind = load(p.at(P::kRule) + k);
    for (int m = 0; m < 3; ++m) {
      const I8 mine = near & (kind == all(static_cast<float>(m)));
      if (!any(mine)) continue;
      const F8 ruleArea = select(mine, pieceArea, zero);
      for (int g = 0; g < kRules[m].count; ++g) {
        const Point& at = kRules[m].points[g];
        const F8 u = all(at.a), t = all(at.b), w = all(at.c);
        const V x{u * a.x + t * b.x + w * c.x, u * a.y + t * b.y + w * c.y,
                  u * a.z + t * b.z + w * c.z};
        const F8 r = root(dot(x, x));
        const F8 inverse = all(1) / largest(r, all(1e-10f));
        const F8 dA = all(at.weight) * ruleArea;
        F8 value, f;  // W, F / r
        if (q.cubicSpline) {
          const F8 perH = r * all(q.perHalfSupport);
          value = all(q.w0) * cubic::w(perH);
          f = all(q.w0) * cubic::fPerR(perH, inverse * all(1 / q.perHalfSupport));
        } else {
          const F8 nodes = r * all(q.nodesPerMetre);
          const I8 outside = nodes >= all(static_cast<float>(KernelTable::kIntervals));
          const F8 clipped = select(outside, zero, nodes);
          const I8 node = __builtin_convertvector(clipped, I8);
          const F8 part = clipped - __builtin_convertvector(node, F8);
          F8 w0, w1, f0, f1;
          for (int lane = 0; lane < kLanes; ++lane) {
            const KernelTable::Wall& e = q.table[node[lane]];
            w0[lane] = e.w;
            w1[lane] = e.wStep;
            f0[lane] = e.f;
            f1[lane] = e.fStep;
          }
          value = select(outside, zero, w0 + part * w1);
          f = select(outside, all(1 / (4 * kPif)) / (r * r * r), f0 + part * f1);
        }
        lambda += dA * offset * (singular * inverse * inverse * inverse - f);
        const F8 wA = dA * value;
        shape += wA * offset;
        inside += wA;
        // 0.25 r: pieces seen edge-on have no shear distance of their own
        shear += wA / largest(largest(offset, all(0.25f) * r), all(q.leastShear_m));
      }
    }
    grad.x += inside * n.x;
    grad.y += inside * n.y;
    grad.z += inside * n.z;
    flux += inside * dot(v, n);
    // a wall seen from behind does not rub
    const I8 front = offset > zero;
    shear = select(front, shear, zero);
    friction += shear;
    drag.x += shear * v.x;
    drag.y += shear * v.y;
    drag.z += shear * v.z;
    area += select(front, inside, zero);
  }
  sums.lambda += sum(lambda);
  sums.shape += sum(shape);
  sums.flux += sum(flux);
  sums.friction += sum(friction);
  sums.area += sum(area);
  sums.gradLambda[0] += sum(grad.x);
  sums.gradLambda[1] += sum(grad.y);
  sums.gradLambda[2] += sum(grad.z);
  sums.frictionVelocity[0] += sum(drag.x);
  sums.frictionVelocity[1] += sum(drag.y);
  sums.frictionVelocity[2] += sum(drag.z);
  for (int lane = 0; lane < kLanes; ++lane) {
    sums.normalSpeed = std::max(sums.normalSpeed, static_cast<float>(speed[lane]));
    if (nearest[lane] < 0 || (sums.nearest >= 0 && nearest2[lane] >= sums.nearest2)) continue;
    sums.nearest2 = nearest2[lane];
    sums.nearest = nearest[lane];
  }
}

SC_CLONES int candidates(const PieceArrays& p, float px, float py, float pz, float reach,
                         float support, int begin, int end, int* out) {
  using P = PieceArrays;
  int found = 0;
  const F8 ox = all(px), oy = all(py), oz = all(pz);
  for (int k = begin; k < end; k += kLanes) {
    const F8 cx = load(p.at(P::kCx) + k) - ox, cy = load(p.at(P::kCy) + k) - oy,
             cz = load(p.at(P::kCz) + k) - oz;
    // a piece's reach is its radius plus the kernel support
    const F8 most = load(p.at(P::kReach) + k) - all(support - reach);
    const F8 plane =
        cx * load(p.at(P::kNx) + k) + cy * load(p.at(P::kNy) + k) + cz * load(p.at(P::kNz) + k);
    const I8 near = (cx * cx + cy * cy + cz * cz <= most * most) & (most > all(0)) &
                    (magnitude(plane) <= all(reach));
    if (!any(near)) continue;
    for (int lane = 0; lane < kLanes && k + lane < end; ++lane) {
      out[found] = k + lane;
      found -= near[lane];  // true is -1
    }
  }
  return found;
}
}  // namespace

void WallQuadrature::add(float x, float y, float z, int begin, int end, WallSums& sums) const {
  integrate(*this, x, y, z, begin, end, sums);
}

int nearPieces(const PieceArrays& pieces, float x, float y, float z, float reach_m, float support_m,
               int begin, int end, int* out) {
  return candidates(pieces, x, y, z, reach_m, support_m, begin, end, out);
}
}  // namespace swallowclip::bolus
