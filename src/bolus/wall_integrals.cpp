// SPDX-License-Identifier: MIT
#include "bolus/wall_integrals.h"

#include <algorithm>
#include <cmath>

#include "bolus/cubic_spline.h"
#include "core/simd.h"
#include "core/vec.h"

namespace swallowclip::bolus {
using namespace simd;

void PieceArrays::resize(int n) {
  count = n;
  for (auto& f : field) f.assign(n + kLanes, 0.f);
  std::fill(field[kReach].begin(), field[kReach].end(), -1.f);
  rule.assign(n + kLanes, 0);
  records.assign(static_cast<std::size_t>(kRecord) * (n + 1), 0.f);
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
// From this many radii (and a spacing, but for seven points) on the solid angle is left to the
// quadrature as well, and beyond the kernel anyway: what remains of G is smoother than F. Within
// 0.1 % of lambda (wall_field_test).
constexpr float kFarRadii[] = {2.5f, 2.5f, 1.8f};
constexpr float kFarSpacings[] = {1, 1, 0};
// Beyond this many supports the kernel is small on all of a piece, and three points do for seven:
// grad lambda within 3e-4 over a spacing instead of 1.2e-4 (triangles of 1.9 spacings).
constexpr float kFewPoints = 1.05f;
constexpr float kSameDirection = 0.95f;   // cosine above which two contacts say the same
constexpr float kSeenFromBehind = 1e-6f;  // cosine, rounding of what lies in the plane of a piece
constexpr float kPif = static_cast<float>(kPi);
}  // namespace

float PieceArrays::close2(int rule, float radius_m, float spacing_m, float support_m) {
  const float away = std::max(kFarRadii[rule] * radius_m, kFarSpacings[rule] * spacing_m);
  const float close = std::min(away, kFewPoints * support_m);
  return close * close;
}

namespace {
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

/// Eight pieces, their corners from o.
struct Records {
  V a, b, c, normal, velocity;
  F8 area;
};
SC_INLINE Records recordsFrom(const PieceArrays& p, const int* at, const F8 (&o)[3]) {
  F8 first[8], second[8];
  gather8<PieceArrays::kRecord>(p.records.data(), at, first);
  gather8<PieceArrays::kRecord>(p.records.data() + 8, at, second);
  return {{first[0] - o[0], first[1] - o[1], first[2] - o[2]},
          {first[3] - o[0], first[4] - o[1], first[5] - o[2]},
          {first[6] - o[0], first[7] - o[1], second[0] - o[2]},
          {second[1], second[2], second[3]},
          {second[4], second[5], second[6]},
          second[7]};
}

SC_CLONES int lookThrough(const PieceArrays& p, float px, float py, float pz, float support,
                          NearPieces& pieces, WallSums& sums) {
  using P = PieceArrays;
  const F8 ox = all(px), oy = all(py), oz = all(pz), zero = all(0);
  F8 speed = zero, nearest2 = all(sums.nearest2);
  I8 nearest = allInt(sums.nearest);
  const float support2 = support * support, few2 = kFewPoints * kFewPoints * support2;
  int found = 0;
  int *const out = pieces.all.data(), *const lists = pieces.lists.data();
  for (const auto& [begin, end] : pieces.rows)
    for (int k = begin; k < end; k += kLanes) {
      const F8 cx = load(p.at(P::kCx) + k) - ox, cy = load(p.at(P::kCy) + k) - oy,
               cz = load(p.at(P::kCz) + k) - oz, reach = load(p.at(P::kReach) + k);
      const F8 away2 = cx * cx + cy * cy + cz * cz;
      const I8 near = (away2 < reach * reach) & (reach > zero) & (kCount < allInt(end - k));
      if (!any(near)) continue;
      const I8 nearer = near & (away2 < nearest2);
      nearest2 = select(nearer, away2, nearest2);
      nearest = nearer ? kCount + allInt(k) : nearest;
      speed = largest(speed, select(near, load(p.at(P::kSpeed) + k), zero));
      // of its plane the kernel reaches a disc, if anything
      const F8 offset =
          cx * load(p.at(P::kNx) + k) + cy * load(p.at(P::kNy) + k) + cz * load(p.at(P::kNz) + k);
      const F8 disc2 = all(support2) - offset * offset;
      const F8 along = root(largest(disc2, zero)) + (reach - all(support));
      const I8 reached = near & (disc2 > zero) & (away2 - offset * offset < along * along);
      const I8 rule = loadInt(p.rule.data() + k);
      const I8 few = (away2 > all(few2)) & (rule > allInt(1));
      const I8 close = away2 < load(p.at(P::kClose2) + k);
      putValues(reached, rule + few - allInt(NearPieces::kRules) * close,
                lists + found);  // true: -1
      found += putLanes(reached, k, out + found);
    }
  for (int lane = 0; lane < kLanes; ++lane) {
    sums.normalSpeed = std::max(sums.normalSpeed, static_cast<float>(speed[lane]));
    if (nearest2[lane] >= sums.nearest2) continue;
    sums.nearest2 = nearest2[lane];
    sums.nearest = nearest[lane];
  }
  return found;
}

SC_CLONES void integrateAll(const WallQuadrature& q, float px, float py, float pz,
                            const NearPieces& pieces, WallSums& sums) {
  using P = PieceArrays;
  const PieceArrays& p = *q.pieces;
  const F8 zero = all(0), o[3] = {all(px), all(py), all(pz)};
  F8 lambda = zero, shape = zero, flux = zero, friction = zero, area = zero;
  V grad{zero, zero, zero}, drag{zero, zero, zero};
  F8 xx = zero, yy = zero, zz = zero, xy = zero, xz = zero, yz = zero;
  F8 clear = all(sums.clear_m);
  const F8 halfSupport = all(q.support_m / 2);
  const float w0PerH2 = q.w0 * q.perHalfSupport * q.perHalfSupport;
  for (int list = 0; list < NearPieces::kLists; ++list)
    for (int k = 0; k < pieces.count[list]; k += kLanes) {
      const bool close = list >= NearPieces::kRules;
      const Rule& rule = kRules[list % NearPieces::kRules];
      const int* at = &pieces.of[list][k];
      const auto [a, b, c, n, v, pieceArea] = recordsFrom(p, at, o);
      const F8 third = all(1.f / 3);
      const V centre{(a.x + b.x + c.x) * third, (a.y + b.y + c.y) * third,
                     (a.z + b.z + c.z) * third};
      const F8 offset = dot(a, n);  // r . n, the same all over the piece
      const F8 radius = gather(p.at(P::kReach), at) - all(q.support_m);
      // a piece is no nearer than its plane, nor than its centroid less its radius
      clear = smallest(clear, largest(magnitude(offset), root(dot(centre, centre)) - radius));
      if (close) {
        // solid angle (van Oosterom & Strackee 1983), positive from the inner side: twice the area
        // times the distance of the plane is the triple product, without cancellation
        const F8 la = root(dot(a, a)), lb = root(dot(b, b)), lc = root(dot(c, c));
        const F8 triple = all(2) * pieceArea * offset;
        const F8 below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
        lambda += all(1 / (2 * kPif)) * arcTangent(triple, below);
      }
      const F8 singular = all(close ? 0 : 1 / (4 * kPif));
      F8 inside = zero, shear = zero, solid = zero;  // of W, W / distance, r-hat . n over the piece
      V steep{zero, zero, zero};                     // of W' r-hat
      const F8 perOffset = all(1) / largest(offset, all(q.leastShear_m));
      for (int g = 0; g < rule.count; ++g) {
        const Point& point = rule.points[g];
        const F8 u = all(point.a), t = all(point.b), w = all(point.c);
        const V x{u * a.x + t * b.x + w * c.x, u * a.y + t * b.y + w * c.y,
                  u * a.z + t * b.z + w * c.z};
        const F8 r = root(dot(x, x));
        const F8 inverse = all(1) / largest(r, all(1e-10f));
        F8 value, f, slope;  // W, F / r, W' / r
        if (q.cubicSpline) {
          const F8 perH = r * all(q.perHalfSupport);
          value = all(q.w0) * cubic::w(perH);
          slope = all(w0PerH2) * cubic::slopePerQ(perH);
          f = all(q.w0) * cubic::fPerR(perH, inverse * halfSupport);
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
          slope = select(outside, zero, all(q.nodesPerMetre) * w1 * inverse);
          f = select(outside, all(1 / (4 * kPif)) / (r * r * r), f0 + part * f1);
        }
        const F8 weight = all(point.weight), share = weight * value;
        solid += weight * (singular * inverse * inverse * inverse - f);
        inside += share;
        const F8 fall = weight * slope;
        steep.x += fall * x.x;
        steep.y += fall * x.y;
        steep.z += fall * x.z;
        // by the distance of the plane or a quarter of r, whichever is more: pieces seen edge-on
        // have no shear distance of their own
        shear += share * smallest(perOffset, all(4) * inverse);
      }
      lambda += pieceArea * offset * solid;
      inside *= pieceArea;
      shape += inside * offset;
      grad.x += inside * n.x;
      grad.y += inside * n.y;
      grad.z += inside * n.z;
      const V turn{pieceArea * n.x, pieceArea * n.y, pieceArea * n.z};
      xx -= steep.x * turn.x;
      yy -= steep.y * turn.y;
      zz -= steep.z * turn.z;
      xy -= steep.x * turn.y;
      xz -= steep.x * turn.z;
      yz -= steep.y * turn.z;
      flux += inside * dot(v, n);
      // a wall seen from behind does not rub
      const I8 front = offset > zero;
      shear = select(front, shear * pieceArea, zero);
      friction += shear;
      drag.x += shear * v.x;
      drag.y += shear * v.y;
      drag.z += shear * v.z;
      area += select(front, inside, zero);
    }
  for (int lane = 0; lane < kLanes; ++lane)
    sums.clear_m = std::min(sums.clear_m, static_cast<float>(clear[lane]));
  sums.lambda = sum(lambda);
  sums.shape = sum(shape);
  sums.flux = sum(flux);
  sums.friction = sum(friction);
  sums.area = sum(area);
  sums.gradLambda = {sum(grad.x), sum(grad.y), sum(grad.z)};
  sums.frictionVelocity = {sum(drag.x), sum(drag.y), sum(drag.z)};
  sums.bend = {sum(xx), sum(yy), sum(zz), sum(xy), sum(xz), sum(yz)};
}

/// The point of a + t e, 0 <= t <= 1, that is nearest to the origin.
SC_INLINE V onEdge(const V& a, const V& e) {
  const F8 t =
      smallest(largest(all(0) - dot(a, e) / largest(dot(e, e), all(1e-30f)), all(0)), all(1));
  return {a.x + t * e.x, a.y + t * e.y, a.z + t * e.z};
}
SC_INLINE V minus(const V& a, const V& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
/// (e x n).a: not above zero where the origin, in the plane with normal n, is inside of edge e.
SC_INLINE F8 outside(const V& e, const V& n, const V& a) {
  return all(0) - ((e.y * n.z - e.z * n.y) * a.x + (e.z * n.x - e.x * n.z) * a.y +
                   (e.x * n.y - e.y * n.x) * a.z);
}

SC_CLONES void nearestPoints(const PieceArrays& p, float px, float py, float pz, float reach2,
                             NearPoints& out) {
  const F8 o[3] = {all(px), all(py), all(pz)}, zero = all(0);
  int found = 0;
  for (int k = 0; k < out.candidateCount; k += kLanes) {
    const int* at = &out.candidates[k];
    const auto [a, b, c, n, v, area] = recordsFrom(p, at, o);
    const V ab = minus(b, a), bc = minus(c, b), ca = minus(a, c);
    const F8 offset = dot(a, n);
    V q{n.x * offset, n.y * offset, n.z * offset};
    const I8 within =
        (outside(ab, n, a) <= zero) & (outside(bc, n, b) <= zero) & (outside(ca, n, c) <= zero);
    F8 away2 = select(within, dot(q, q), all(1e30f));
    for (const V& edge : {onEdge(a, ab), onEdge(b, bc), onEdge(c, ca)}) {
      const F8 edge2 = dot(edge, edge);
      const I8 nearer = edge2 < away2;
      q = {select(nearer, edge.x, q.x), select(nearer, edge.y, q.y), select(nearer, edge.z, q.z)};
      away2 = select(nearer, edge2, away2);
    }
    const I8 near = (away2 < all(reach2)) & (kCount < allInt(out.candidateCount - k));
    if (!any(near)) continue;
    putValues(near, loadInt(at), &out.piece[found]);
    putValues(near, q.x, &out.x[found]);
    putValues(near, q.y, &out.y[found]);
    putValues(near, q.z, &out.z[found]);
    putValues(near, all(0) - dot(q, n), &out.plane[found]);
    found += putValues(near, away2, &out.away2[found]);
  }
  out.count = found;
}

SC_CLONES int othersOf(NearPoints& p, float least, float ix, float iy, float iz) {
  int left = 0;
  for (int k = 0; k < p.count; k += kLanes) {
    const F8 x = load(&p.x[k]), y = load(&p.y[k]), z = load(&p.z[k]), plane = load(&p.plane[k]);
    const F8 away2 = load(&p.away2[k]), away = root(away2);
    const F8 same = all(0) - (x * all(ix) + y * all(iy) + z * all(iz));
    const I8 other = (away > all(least)) & (plane <= all(kSeenFromBehind) * away) &
                     (same <= all(kSameDirection) * away) & (kCount < allInt(p.count - k));
    const I8 piece = loadInt(&p.piece[k]);
    putValues(other, piece, &p.piece[left]);
    putValues(other, x, &p.x[left]);
    putValues(other, y, &p.y[left]);
    putValues(other, z, &p.z[left]);
    putValues(other, plane, &p.plane[left]);
    left += putValues(other, away2, &p.away2[left]);
  }
  return left;
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
                    (magnitude(plane) <= all(reach)) & (kCount < allInt(end - k));
    found += putLanes(near, k, out + found);
  }
  return found;
}
}  // namespace

void WallQuadrature::look(float x, float y, float z, NearPieces& near, WallSums& sums) const {
  const std::size_t room = near.pieces + kLanes;
  if (near.all.size() < room)
    for (auto* list : {&near.all, &near.lists}) list->resize(2 * room);
  const int found = lookThrough(*pieces, x, y, z, support_m, near, sums);
  const std::size_t most = found + kLanes;
  for (auto& list : near.of)
    if (list.size() < most) list.resize(2 * most);
  for (int k = 0; k < found; ++k) {
    const int list = near.lists[k];
    near.of[list][near.count[list]++] = near.all[k];
  }
}

void WallQuadrature::integrate(float x, float y, float z, NearPieces& near, WallSums& sums) const {
  for (int list = 0; list < NearPieces::kLists; ++list)
    if (near.count[list] > 0)
      std::fill_n(&near.of[list][near.count[list]], kLanes - 1, pieces->count);  // no piece
  integrateAll(*this, x, y, z, near, sums);
}

void lookForPoints(const PieceArrays& pieces, float x, float y, float z, float reach_m,
                   float support_m, int begin, int end, NearPoints& near) {
  const std::size_t most = near.candidateCount + end - begin + kLanes;
  if (near.candidates.size() < most) near.candidates.resize(2 * most);
  near.candidateCount += candidates(pieces, x, y, z, reach_m, support_m, begin, end,
                                    near.candidates.data() + near.candidateCount);
}

void findPoints(const PieceArrays& pieces, float x, float y, float z, float reach_m,
                NearPoints& near) {
  const std::size_t most = near.candidateCount + kLanes;
  if (near.piece.size() < most) {
    near.piece.resize(2 * most);
    for (auto* a : {&near.x, &near.y, &near.z, &near.away2, &near.plane}) a->resize(2 * most);
  }
  std::fill_n(near.candidates.begin() + near.candidateCount, kLanes - 1, pieces.count);  // no piece
  nearestPoints(pieces, x, y, z, reach_m * reach_m, near);
}

void keepOthers(NearPoints& near, float least_m, const std::array<float, 3>& inward) {
  near.count = othersOf(near, least_m, inward[0], inward[1], inward[2]);
}
}  // namespace swallowclip::bolus
