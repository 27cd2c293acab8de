// SPDX-License-Identifier: MIT
#include "bolus/wall_field.h"

#include <algorithm>
#include <cmath>

namespace swallowclip::bolus {
namespace {
// Triangle rules of degree 2 and 5 (Strang & Fix 1973; Cowper 1973).
const std::array<Vec3, 3> kRule3{
    {{2. / 3, 1. / 6, 1. / 6}, {1. / 6, 2. / 3, 1. / 6}, {1. / 6, 1. / 6, 2. / 3}}};
constexpr std::array<double, 3> kWeight3{1. / 3, 1. / 3, 1. / 3};
constexpr double kA = 0.059715871789769820, kB = 0.470142064105115090;
constexpr double kC = 0.797426985353087322, kD = 0.101286507323456339;
const std::array<Vec3, 7> kRule7{{{1. / 3, 1. / 3, 1. / 3},
                                  {kA, kB, kB},
                                  {kB, kA, kB},
                                  {kB, kB, kA},
                                  {kC, kD, kD},
                                  {kD, kC, kD},
                                  {kD, kD, kC}}};
constexpr double kW1 = 0.132394152788506181, kW2 = 0.125939180544827153;
constexpr std::array<double, 7> kWeight7{0.225, kW1, kW1, kW1, kW2, kW2, kW2};

constexpr double kFineSpacing_m = 1.5e-3;  // below: 7 points (DESIGN 5: 3 at 2 mm, 7 at 1 mm)
constexpr int kMaxCuts = 6;                // a triangle becomes at most 4^6 pieces
constexpr double kEmptyArea_m2 = 1e-16;    // slivers without a usable normal
// Nearer than this the wall shear no longer grows: 0.3 spacings, assumed (0.2 to 0.5), the order
// of the distance at which particles rest.
constexpr double kLeastShearDistance = 0.3;
constexpr double kSameDirection = 0.95;  // cosine above which two contacts say the same

// Solid angle of abc seen from the origin, positive from the inner side.
double solidAngle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)),
                        la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}
double cornerAngle(const Vec3& at, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - at, v = c - at;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}
}  // namespace

NearestPoint nearestPoint(const Vec3& p, std::span<const Vec3> x,
                          std::span<const Triangle> triangles) {
  NearestPoint best;
  double best2 = INFINITY, bestDistance = INFINITY;
  for (int k = 0; k < static_cast<int>(triangles.size()); ++k) {
    const Triangle& t = triangles[k];
    const Vec3 &a = x[t[0]], &b = x[t[1]], &c = x[t[2]];
    // no point of abc is nearer than its corner a less the longer of its two edges there
    const double bound =
        bestDistance + std::sqrt(std::max((b - a).squaredNorm(), (c - a).squaredNorm()));
    if ((p - a).squaredNorm() > bound * bound) continue;
    const Vec3 bary = closestBarycentric(p, a, b, c);
    const Vec3 q = a * bary[0] + b * bary[1] + c * bary[2];
    const double d2 = (p - q).squaredNorm();
    if (d2 >= best2) continue;
    best2 = d2;
    bestDistance = std::sqrt(d2);
    best = {k, bary, q, bestDistance};
  }
  return best;
}

WallField::WallField(const KernelTable& table, double spacing_m)
    : table_(&table), spacing_m_(spacing_m) {
  const bool fine = spacing_m < kFineSpacing_m;
  rule_ = fine ? std::span<const Vec3>(kRule7) : std::span<const Vec3>(kRule3);
  ruleWeight_ = fine ? std::span<const double>(kWeight7) : std::span<const double>(kWeight3);
  longestEdge_m_ = (fine ? 2.0 : 1.25) * spacing_m;
}

WallField::Piece WallField::makePiece(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& va,
                                      const Vec3& vb, const Vec3& vc, int triangle) const {
  Piece t{a, b, c, va, vb, vc, Vec3::Zero(), (a + b + c) / 3, 0, 0, 0, triangle};
  const Vec3 cross = (b - a).cross(c - a);
  const double twice = cross.norm();
  t.area = twice / 2;
  if (twice > 0) t.normal = cross / twice;
  t.radius = std::sqrt(std::max({(a - t.centroid).squaredNorm(), (b - t.centroid).squaredNorm(),
                                 (c - t.centroid).squaredNorm()}));
  t.normalSpeed = std::max(
      {std::abs(va.dot(t.normal)), std::abs(vb.dot(t.normal)), std::abs(vc.dot(t.normal))});
  return t;
}

// Quadrature wants pieces small against H; a large triangle is cut in four at its edge middles.
void WallField::addPiece(const Piece& t, int depth) {
  const double longest2 =
      std::max({(t.b - t.a).squaredNorm(), (t.c - t.b).squaredNorm(), (t.a - t.c).squaredNorm()});
  if (depth < kMaxCuts && longest2 > longestEdge_m_ * longestEdge_m_) {
    const Vec3 ab = (t.a + t.b) / 2, bc = (t.b + t.c) / 2, ca = (t.c + t.a) / 2;
    const Vec3 vab = (t.va + t.vb) / 2, vbc = (t.vb + t.vc) / 2, vca = (t.vc + t.va) / 2;
    addPiece(makePiece(t.a, ab, ca, t.va, vab, vca, t.triangle), depth + 1);
    addPiece(makePiece(ab, t.b, bc, vab, t.vb, vbc, t.triangle), depth + 1);
    addPiece(makePiece(ca, bc, t.c, vca, vbc, t.vc, t.triangle), depth + 1);
    addPiece(makePiece(ab, bc, ca, vab, vbc, vca, t.triangle), depth + 1);
    return;
  }
  if (t.area < kEmptyArea_m2) return;
  pieces_.push_back(t);
  centroids_.push_back(t.centroid);
  largestRadius_m_ = std::max(largestRadius_m_, t.radius);
  for (const Vec3& w : rule_) {
    quadPoints_.push_back(t.a * w[0] + t.b * w[1] + t.c * w[2]);
    quadVelocities_.push_back(t.va * w[0] + t.vb * w[1] + t.vc * w[2]);
  }
}

void WallField::build(std::span<const Triangle> triangles, std::span<const Vec3> x,
                      std::span<const Vec3> v, const Vec3& low, const Vec3& high,
                      std::span<const std::uint8_t> skip) {
  pieces_.clear();
  centroids_.clear();
  quadPoints_.clear();
  quadVelocities_.clear();
  largestRadius_m_ = 0;
  const double reach = table_->support_m() + 0.5 * spacing_m_;
  const Vec3 boxLow = low.array() - reach, boxHigh = high.array() + reach;
  for (int k = 0; k < static_cast<int>(triangles.size()); ++k) {
    if (!skip.empty() && skip[k]) continue;
    const Triangle& t = triangles[k];
    const Vec3 &a = x[t[0]], &b = x[t[1]], &c = x[t[2]];
    const Vec3 lowest = a.cwiseMin(b).cwiseMin(c), highest = a.cwiseMax(b).cwiseMax(c);
    if ((lowest.array() > boxHigh.array()).any() || (highest.array() < boxLow.array()).any())
      continue;
    addPiece(makePiece(a, b, c, v[t[0]], v[t[1]], v[t[2]], k), 0);
  }
  grid_.build(centroids_, {}, table_->support_m() + largestRadius_m_);
}

void WallField::addIntegrals(const Piece& t, const Vec3& p, WallSample& out) const {
  const std::size_t points = rule_.size();
  const std::size_t first = (&t - pieces_.data()) * points;
  // Far from a small piece G is smooth itself, and the arc tangent can be spared.
  const double away2 = (t.centroid - p).squaredNorm();
  const bool exact = away2 < std::max(9 * t.radius * t.radius, spacing_m_ * spacing_m_);
  if (exact) out.lambda += solidAngle(t.a - p, t.b - p, t.c - p) / (4 * kPi);
  const double offset = (t.a - p).dot(t.normal);  // r . n, the same all over the piece
  for (std::size_t q = 0; q < points; ++q) {
    const double r = (quadPoints_[first + q] - p).norm();
    const KernelTable::Entry e = table_->at(r);
    const double dA = ruleWeight_[q] * t.area;
    if (r > 0) {
      const double g = exact ? -e.f : 1 / (4 * kPi * r * r) - e.f;
      out.lambda += dA * g * offset / r;
    }
    if (e.w == 0) continue;
    const Vec3& v = quadVelocities_[first + q];
    const double wA = dA * e.w;
    out.gradLambda += wA * t.normal;
    out.flux_s += wA * v.dot(t.normal);
    if (offset <= 0) continue;  // a wall seen from behind does not rub
    // 0.25 r: pieces seen edge-on have no shear distance of their own
    const double shear = wA / std::max({offset, 0.25 * r, kLeastShearDistance * spacing_m_});
    out.friction += shear;
    out.frictionVelocity += shear * v;
    out.area += wA;
  }
  out.normalSpeed_ms = std::max(out.normalSpeed_ms, t.normalSpeed);
}

WallSample WallField::sample(const Vec3& p) const {
  WallSample out;
  double nearest2 = INFINITY;
  grid_.around(p, [&](int k) {
    const Piece& t = pieces_[k];
    const double reach = table_->support_m() + t.radius, d2 = (t.centroid - p).squaredNorm();
    if (d2 >= reach * reach) return;
    addIntegrals(t, p, out);
    if (d2 >= nearest2) return;
    nearest2 = d2;
    out.nearestTriangle = t.triangle;
  });
  return out;
}

void WallField::contacts(const Vec3& p, double radius_m, std::vector<Contact>& out) const {
  out.clear();
  struct Hit {
    double d2;
    int piece;
    Vec3 bary, point;
  };
  thread_local std::vector<Hit> hits;
  hits.clear();
  grid_.around(p, [&](int k) {
    const Piece& t = pieces_[k];
    const double reach = radius_m + t.radius;
    if ((t.centroid - p).squaredNorm() > reach * reach) return;
    const Vec3 bary = closestBarycentric(p, t.a, t.b, t.c);
    const Vec3 q = t.a * bary[0] + t.b * bary[1] + t.c * bary[2];
    const double d2 = (p - q).squaredNorm();
    if (d2 < radius_m * radius_m) hits.push_back({d2, k, bary, q});
  });
  if (hits.empty()) return;
  std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) {
    return a.d2 != b.d2 ? a.d2 < b.d2 : a.piece < b.piece;
  });
  // Which side: the angle-weighted normal of all pieces that share the nearest point (Baerentzen &
  // Aanaes 2005), right at edges and corners too.
  Vec3 normal = Vec3::Zero();
  const double same = 1e-6 * spacing_m_;
  for (const Hit& h : hits) {
    if ((h.point - hits[0].point).squaredNorm() > same * same) continue;
    const Piece& t = pieces_[h.piece];
    double weight = 1;
    if (h.bary[0] == 1) weight = cornerAngle(t.a, t.b, t.c);
    if (h.bary[1] == 1) weight = cornerAngle(t.b, t.c, t.a);
    if (h.bary[2] == 1) weight = cornerAngle(t.c, t.a, t.b);
    normal += weight * t.normal;
  }
  const double side = (p - hits[0].point).dot(normal) > 0 ? -1 : 1;
  for (const Hit& h : hits) {
    const Piece& t = pieces_[h.piece];
    const bool first = out.empty();
    const double d = std::sqrt(h.d2);
    Vec3 inward = -normal.normalized();
    if (d > same)
      inward = (first ? side : 1.0) * (p - h.point) / d;
    else if (!first)
      continue;
    if (!first) {
      if (inward.dot(t.normal) > 1e-9) continue;  // seen from behind: other tissue in between
      bool known = false;
      for (const Contact& c : out) known = known || c.inward.dot(inward) > kSameDirection;
      if (known) continue;
    }
    out.push_back({h.point, inward, t.va * h.bary[0] + t.vb * h.bary[1] + t.vc * h.bary[2],
                   first ? side * d : d, t.triangle});
    if (side < 0 || static_cast<int>(out.size()) == kMaxContacts) return;
  }
}
}  // namespace swallowclip::bolus
