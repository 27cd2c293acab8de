// SPDX-License-Identifier: MIT
#include "bolus/wall_field.h"

#include <algorithm>
#include <cmath>

namespace swallowclip::bolus {
namespace {
// Quadrature points by a piece's longest edge in spacings: the same relative error at every
// resolution (wall_field_test). Longer triangles are cut.
constexpr double kOnePoint = 0.35, kThreePoints = 1.5, kLongestEdge = 2;
constexpr int kMaxCuts = 6;              // a triangle becomes at most 4^6 pieces
constexpr double kEmptyArea_m2 = 1e-16;  // slivers without a usable normal
// Pieces are known this much farther than the kernel reaches, in spacings: nobody has to ask again
// for some steps who is clear of them by that much. Assumed (0.5 to 2).
constexpr double kClearBeyond = 1.5;
// Nearer than this the wall shear no longer grows: 0.3 spacings, assumed (0.2 to 0.5), the order
// of the distance at which particles rest.
constexpr double kLeastShearDistance = 0.3;

double cornerAngle(const Vec3& at, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - at, v = c - at;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}
}  // namespace

namespace {
struct Search {
  Vec3 p;
  std::span<const Vec3> x;
  std::span<const Triangle> triangles;
  NearestPoint best;
  double best2 = INFINITY;

  void look(int k) {
    const Triangle& t = triangles[k];
    const Vec3 &a = x[t[0]], &b = x[t[1]], &c = x[t[2]];
    // No point of abc is nearer than its corner a less the longer of its two edges there, and
    // (d + e)^2 is at most 2 (d^2 + e^2).
    const double edge2 = std::max((b - a).squaredNorm(), (c - a).squaredNorm());
    if ((p - a).squaredNorm() > 2 * (best2 + edge2)) return;
    const Vec3 bary = closestBarycentric(p, a, b, c);
    const Vec3 q = a * bary[0] + b * bary[1] + c * bary[2];
    const double d2 = (p - q).squaredNorm();
    if (d2 > best2 || (d2 == best2 && k >= best.triangle)) return;
    best2 = d2;
    best = {k, bary, q, std::sqrt(d2)};
  }
};
}  // namespace

NearestPoint nearestPoint(const Vec3& p, std::span<const Vec3> x,
                          std::span<const Triangle> triangles, int guess) {
  Search search{p, x, triangles, {}};
  if (guess >= 0) search.look(guess);
  for (int k = 0; k < static_cast<int>(triangles.size()); ++k) search.look(k);
  return search.best;
}

void TriangleRuns::build(std::span<const Vec3> x, std::span<const Triangle> triangles) {
  const int n = static_cast<int>(triangles.size());
  spheres_.clear();
  for (int first = 0; first < n; first += kRun) {
    const auto run = triangles.subspan(first, std::min(kRun, n - first));
    Vec3 low = Vec3::Constant(INFINITY), high = -low;
    for (const Triangle& t : run)
      for (const int v : t) {
        low = low.cwiseMin(x[v]);
        high = high.cwiseMax(x[v]);
      }
    Sphere s{(low + high) / 2, 0};
    for (const Triangle& t : run)
      for (const int v : t) s.radius_m = std::max(s.radius_m, (x[v] - s.centre).norm());
    spheres_.push_back(s);
  }
}

NearestPoint TriangleRuns::nearest(const Vec3& p, std::span<const Vec3> x,
                                   std::span<const Triangle> triangles, int guess) const {
  constexpr double kRounding = 1 + 1e-9;
  Search search{p, x, triangles, {}};
  if (guess >= 0) search.look(guess);
  for (std::size_t r = 0; r < spheres_.size(); ++r) {
    const Sphere& s = spheres_[r];
    const double reach_m = (std::sqrt(search.best2) + s.radius_m) * kRounding;
    if ((p - s.centre).squaredNorm() > reach_m * reach_m) continue;
    const int first = static_cast<int>(r) * kRun;
    const int end = std::min(first + kRun, static_cast<int>(triangles.size()));
    for (int k = first; k < end; ++k) search.look(k);
  }
  return search.best;
}

WallField::WallField(const KernelTable& table, double spacing_m)
    : table_(&table), spacing_m_(spacing_m), longestEdge_m_(kLongestEdge * spacing_m) {}

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
}

// Walls that stand still keep their pieces, as long as the fluid stays in the box they were made
// for.
bool WallField::sameWalls(std::span<const Triangle> triangles, std::span<const Vec3> x,
                          std::span<const Vec3> v, const Vec3& low, const Vec3& high,
                          std::span<const std::uint8_t> skip, bool stood) {
  const auto same = [](const auto& a, const auto& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
  };
  if (built_.triangles == triangles.size() && (low.array() >= built_.low.array()).all() &&
      (high.array() <= built_.high.array()).all() && same(built_.skip, skip) &&
      (stood || (same(built_.positions, x) && same(built_.velocities, v))))
    return true;
  return false;
}

void WallField::build(std::span<const Triangle> triangles, std::span<const Vec3> x,
                      std::span<const Vec3> v, const Vec3& low, const Vec3& high,
                      std::span<const std::uint8_t> skip, bool stood) {
  if (sameWalls(triangles, x, v, low, high, skip, stood)) return;
  const Vec3 room = Vec3::Constant(spacing_m_);
  rebuild(triangles, x, v, {low - room, high + room}, skip);
}

void WallField::rebuild(std::span<const Triangle> triangles, std::span<const Vec3> x,
                        std::span<const Vec3> v, const Box& box,
                        std::span<const std::uint8_t> skip) {
  built_ = {{x.begin(), x.end()},
            {v.begin(), v.end()},
            {skip.begin(), skip.end()},
            triangles.size(),
            box.low,
            box.high};
  pieces_.clear();
  centroids_.clear();
  largestRadius_m_ = 0;
  const double reach = table_->support_m() + kClearBeyond * spacing_m_;
  const Vec3 boxLow = built_.low.array() - reach, boxHigh = built_.high.array() + reach;
  for (int k = 0; k < static_cast<int>(triangles.size()); ++k) {
    if (!skip.empty() && skip[k]) continue;
    const Triangle& t = triangles[k];
    const Vec3 &a = x[t[0]], &b = x[t[1]], &c = x[t[2]];
    const Vec3 lowest = a.cwiseMin(b).cwiseMin(c), highest = a.cwiseMax(b).cwiseMax(c);
    if ((lowest.array() > boxHigh.array()).any() || (highest.array() < boxLow.array()).any())
      continue;
    addPiece(makePiece(a, b, c, v[t[0]], v[t[1]], v[t[2]], k), 0);
  }
  low_ = built_.low;
  grid_.build(centroids_, {}, table_->support_m() + largestRadius_m_);
  sortPieces();
}

void WallField::follow(const WallField& other, std::span<const Triangle> triangles,
                       std::span<const Vec3> x, std::span<const Vec3> v,
                       std::span<const std::uint8_t> skip) {
  const Box box = other.box();
  if (built_.low == box.low && built_.high == box.high &&
      sameWalls(triangles, x, v, box.low, box.high, skip))
    return;
  rebuild(triangles, x, v, box, skip);
}

void WallField::sortPieces() {
  std::vector<Piece> sorted;
  sorted.reserve(pieces_.size());
  for (int k : grid_.order()) sorted.push_back(pieces_[k]);
  pieces_.swap(sorted);
  arrays_.resize(static_cast<int>(pieces_.size()));
  const auto put = [&](PieceArrays::Field first, std::size_t k, const Vec3& value) {
    for (int a = 0; a < 3; ++a) arrays_.field[first + a][k] = static_cast<float>(value[a]);
  };
  using P = PieceArrays;
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    const Piece& t = pieces_[k];
    put(P::kCx, k, t.centroid - low_);
    put(P::kNx, k, t.normal);
    // one velocity a piece: what it varies within one is of second order
    const Vec3 record[] = {t.a - low_, t.b - low_, t.c - low_, t.normal, (t.va + t.vb + t.vc) / 3};
    float* to = arrays_.record(static_cast<int>(k));
    for (int e = 0; e < 15; ++e) to[e] = static_cast<float>(record[e / 3][e % 3]);
    to[15] = static_cast<float>(t.area);
    arrays_.field[P::kReach][k] = static_cast<float>(table_->support_m() + t.radius);
    const double edge = std::max({(t.b - t.a).norm(), (t.c - t.b).norm(), (t.a - t.c).norm()});
    arrays_.rule[k] = edge < kOnePoint * spacing_m_ ? 0 : edge < kThreePoints * spacing_m_ ? 1 : 2;
    arrays_.field[P::kSpeed][k] = static_cast<float>(t.normalSpeed);
    arrays_.field[P::kClose2][k] =
        P::close2(arrays_.rule[k], static_cast<float>(t.radius), static_cast<float>(spacing_m_),
                  static_cast<float>(table_->support_m()));
  }
}

WallSample WallField::sample(const Vec3& p) const {
  WallSample out;
  const Vec3f at = (p - low_).cast<float>();
  const WallQuadrature quadrature{&arrays_,
                                  table_->walls(),
                                  table_->nodesPerMetre(),
                                  static_cast<float>(kLeastShearDistance * spacing_m_),
                                  static_cast<float>(2 / table_->support_m()),
                                  static_cast<float>(table_->selfW()),
                                  static_cast<float>(table_->support_m()),
                                  static_cast<float>(spacing_m_),
                                  table_->isCubicSpline()};
  WallSums sums;
  thread_local NearPieces near;
  near.clear();
  grid_.rowsAround(p, table_->support_m() + largestRadius_m_,
                   [&](int first, int last) { near.add(first, last); });
  quadrature.look(at.x(), at.y(), at.z(), near, sums);
  out.clear_m = table_->support_m();
  if (sums.nearest < 0) {
    out.clear_m = std::max(out.clear_m, clearOf_m(p));
    return out;
  }
  quadrature.integrate(at.x(), at.y(), at.z(), near, sums);
  out.lambda = sums.lambda;
  out.lambdaSlope = sums.lambda + sums.shape / 3;
  out.flux_s = sums.flux;
  out.gradLambda = Vec3(sums.gradLambda.data());
  out.friction = sums.friction;
  out.frictionVelocity = Vec3(sums.frictionVelocity.data());
  out.area = sums.area;
  out.bend = sums.bend;
  out.normalSpeed_ms = sums.normalSpeed;
  out.clear_m = std::min<double>(out.clear_m, sums.clear_m);
  out.nearestTriangle = pieces_[sums.nearest].triangle;
  return out;
}

double WallField::clearOf_m(const Vec3& p) const {
  const double most_m = table_->support_m() + kClearBeyond * spacing_m_;
  const Vec3f at = (p - low_).cast<float>();
  const float *x = arrays_.at(PieceArrays::kCx), *y = arrays_.at(PieceArrays::kCy),
              *z = arrays_.at(PieceArrays::kCz);
  float least2 = static_cast<float>((most_m + largestRadius_m_) * (most_m + largestRadius_m_));
  grid_.rowsAround(p, most_m + largestRadius_m_, [&](int first, int last) {
    for (int k = first; k < last; ++k) {
      const float dx = x[k] - at.x(), dy = y[k] - at.y(), dz = z[k] - at.z();
      least2 = std::min(least2, dx * dx + dy * dy + dz * dz);
    }
  });
  return std::sqrt(static_cast<double>(least2)) - largestRadius_m_ - 1e-4 * spacing_m_;
}

WallSample WallField::nearTo(const WallSample& s, const Vec3& moved_m, double since_s) const {
  WallSample out = s;
  const double steep = s.gradLambda.norm();
  if (steep == 0) return out;
  Vec3 away = moved_m;  // from the wall as it is now
  if (s.friction > 0) away -= since_s / s.friction * s.frictionVelocity;
  const auto& b = s.bend;
  const Vec3 more(b[0] * away.x() + b[3] * away.y() + b[4] * away.z(),
                  b[3] * away.x() + b[1] * away.y() + b[5] * away.z(),
                  b[4] * away.x() + b[5] * away.y() + b[2] * away.z());
  out.gradLambda += more;
  out.lambda += moved_m.dot(s.gradLambda) - since_s * s.flux_s + away.dot(more) / 2;
  out.lambda = std::max(0.0, out.lambda);
  const double shape = s.lambdaSlope - s.lambda, wider = out.gradLambda.norm() / steep;
  double nearer = 1;
  if (s.friction > 0 && s.area > 0) {
    const double was_m = s.area / s.friction, least_m = kLeastShearDistance * spacing_m_;
    nearer = was_m / std::max(least_m, was_m - away.dot(s.gradLambda) / steep);
    out.flux_s += more.dot(s.frictionVelocity) / s.friction;
    out.area *= wider;
    out.friction *= wider * nearer;
    out.frictionVelocity *= wider * nearer;
  }
  out.lambdaSlope = out.lambda + shape * wider / nearer;
  return out;
}

// In single precision who is near and which way; in double what is nearest and what comes out.
void WallField::contacts(const Vec3& p, double radius_m, std::vector<Contact>& out) const {
  out.clear();
  // a hair more for the single precision of the choice
  const float reach = static_cast<float>(radius_m + 1e-4 * spacing_m_);
  const float support = static_cast<float>(table_->support_m());
  const Vec3f at = (p - low_).cast<float>();
  thread_local NearPoints near;
  near.clear();
  grid_.rowsAround(p, reach + largestRadius_m_, [&](int first, int last) {
    lookForPoints(arrays_, at.x(), at.y(), at.z(), reach, support, first, last, near);
  });
  if (near.candidateCount == 0) return;
  findPoints(arrays_, at.x(), at.y(), at.z(), reach, near);
  if (near.count == 0) return;
  struct Hit {
    double d2 = INFINITY;
    int piece = -1;
    Vec3 bary = Vec3::Zero(), point = Vec3::Zero();
  };
  const auto hitOn = [&](int piece) {
    const Piece& t = pieces_[piece];
    Hit h{0, piece, closestBarycentric(p, t.a, t.b, t.c), Vec3::Zero()};
    h.point = t.a * h.bary[0] + t.b * h.bary[1] + t.c * h.bary[2];
    h.d2 = (p - h.point).squaredNorm();
    return h;
  };
  const double same = 1e-6 * spacing_m_;
  // What might be the nearest, or share its point, for all that single precision knows.
  thread_local std::vector<Hit> hits;
  hits.clear();
  const float least = std::sqrt(*std::min_element(&near.away2[0], &near.away2[0] + near.count)) +
                      static_cast<float>(1e-4 * spacing_m_);
  Hit h;
  for (int k = 0; k < near.count; ++k) {
    if (near.away2[k] > least * least) continue;
    hits.push_back(hitOn(near.piece[k]));
    const Hit& o = hits.back();
    if (o.d2 < h.d2 || (o.d2 == h.d2 && o.piece < h.piece)) h = o;
  }
  if (!(h.d2 < radius_m * radius_m)) return;
  // Which side: the angle-weighted normal of all pieces that share the nearest point (Baerentzen &
  // Aanaes 2005), right at edges and corners too.
  Vec3 normal = Vec3::Zero();
  for (const Hit& o : hits) {
    if ((o.point - h.point).squaredNorm() > same * same) continue;
    const Piece& t = pieces_[o.piece];
    double weight = 1;
    if (o.bary[0] == 1) weight = cornerAngle(t.a, t.b, t.c);
    if (o.bary[1] == 1) weight = cornerAngle(t.b, t.c, t.a);
    if (o.bary[2] == 1) weight = cornerAngle(t.c, t.a, t.b);
    normal += weight * t.normal;
  }
  const double side = (p - h.point).dot(normal) > 0 ? -1 : 1;
  const double first_m = std::sqrt(h.d2);
  Vec3 inward = first_m > same ? Vec3(side * (p - h.point) / first_m) : Vec3(-normal.normalized());
  for (double distance_m = side * first_m;;) {
    const Piece& t = pieces_[h.piece];
    out.push_back({h.point, inward, t.va * h.bary[0] + t.vb * h.bary[1] + t.vc * h.bary[2],
                   distance_m, t.triangle});
    if (side < 0 || static_cast<int>(out.size()) == kMaxContacts) return;
    // Of the others none that lies the same way, nor one seen from behind: other tissue in between.
    const Vec3f in = inward.cast<float>();
    keepOthers(near, static_cast<float>(same), {in.x(), in.y(), in.z()});
    if (near.count == 0) return;
    h = hitOn(
        near.piece[std::min_element(&near.away2[0], &near.away2[0] + near.count) - &near.away2[0]]);
    if (!(h.d2 < radius_m * radius_m)) return;
    distance_m = std::sqrt(h.d2);
    inward = (p - h.point) / distance_m;
  }
}
}  // namespace swallowclip::bolus
