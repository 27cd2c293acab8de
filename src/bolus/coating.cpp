// SPDX-License-Identifier: MIT
#include "bolus/coating.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "bolus/solver_impl.h"

namespace swallowclip::bolus {
namespace {
// A wall is wet with fluid this near to a triangle's centre, and dry again with none that near, in
// spacings. In a full room the farthest is 0.9 away (half a spacing from the wall, 0.7 along it),
// so that no wall in touch with a body of fluid counts as dry. Assumed (0.9 to 1.2, 1.3 to 1.7).
constexpr double kWet = 1.0, kDry = 1.5;
constexpr double kLends = 2.0;  // spacings, what Neighbours::around is sure to find
// A film thicker than this is a layer of particles, in spacings; assumed (0.3 to 0.8).
constexpr double kThickest = 0.5;
// Where a gap is narrower, in spacings, no film is left: the width in which fluid finds no way out
// (substep.cpp). Assumed (0.6 to 0.8).
constexpr double kShut = 0.75;
constexpr double kCrossing = 0.25;  // spacings that sheets may cross by (0.5 mm of 2, solver.cpp)
// A closing wall is seen when the middle of its triangle is at most this much farther away than the
// gap, in spacings: that of triangles two spacings long, as skins have them.
constexpr double kFaceRadius = 1.0;
constexpr double kEvery =
    0.2;  // spacings that anything moves between updates, assumed (0.1 to 0.5)
constexpr double kReturnsAt = 0.5;       // spacings from the wall, as in a full room
constexpr double kRoomDensity = 1.03;    // of rho0 where a particle returns, as for films
constexpr double kRoom = 0.7;            // and spacings to the next one, assumed (0.6 to 0.8)
constexpr int kPlacesTried = 200;        // for each, assumed (50 to 1000)
constexpr double kLandauLevich = 0.944;  // Landau & Levich 1942
constexpr double kBretherton = 1.34, kThickening = 3.35;  // Aussillous & Quere 2000, eq. 2
constexpr int kRateSteps = 40;  // of the fixed point; it contracts by 2/3 or better
constexpr int kChunk = 64;      // triangles per work item

Vec3 nearestImage(Vec3 d, const Vec3& period_m) {
  for (int a = 0; a < 3; ++a)
    if (period_m[a] > 0) d[a] -= period_m[a] * std::round(d[a] / period_m[a]);
  return d;
}

/// Distance from p along a unit direction to a triangle (Moeller & Trumbore 1997), or infinity.
double alongRay(const Vec3& p, const Vec3& along, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, cross = along.cross(ac);
  const double det = ab.dot(cross);
  if (det == 0) return INFINITY;
  const Vec3 ap = p - a, q = ap.cross(ab);
  const double u = ap.dot(cross) / det, v = along.dot(q) / det;
  return u < 0 || v < 0 || u + v > 1 ? INFINITY : ac.dot(q) / det;
}
}  // namespace

double filmThickness_m(const Fluid& fluid, double gravity_ms2, double speed_ms,
                       double halfWidth_m) {
  if (!(speed_ms > 0)) return 0;
  const double weight = fluid.density_kgm3 * gravity_ms2;
  const double capillary_m = weight > 0 ? std::sqrt(fluid.coatingTension_Nm / weight) : INFINITY;
  const auto thickness = [&](double eta_Pas) {
    const double ca = std::pow(eta_Pas * speed_ms / fluid.coatingTension_Nm, 2.0 / 3);
    return std::min(kLandauLevich * capillary_m * ca,
                    halfWidth_m * kBretherton * ca / (1 + kThickening * ca));
  };
  double h = thickness(apparentViscosity_Pas(fluid, 1.0));
  if (fluid.model == RheologyModel::newtonian || !std::isfinite(h)) return h;
  for (int k = 0; k < kRateSteps; ++k) h = thickness(apparentViscosity_Pas(fluid, speed_ms / h));
  return h;
}

Coating::Coating(const Fluid& fluid, double gravity_ms2, double spacing_m)
    : fluid_(fluid),
      gravity_ms2_(gravity_ms2),
      spacing_m_(spacing_m),
      particle_m3_(std::pow(spacing_m, 3)) {}

void Coating::start(std::size_t triangles, std::size_t particles) {
  if (!on()) return;
  volume_m3_.assign(triangles, 0.0);
  speed_ms_.assign(triangles, 0.0);
  wetness_.assign(triangles, Wetness::never);
  lent_m3_.assign(particles, 0.0);
  waiting_.clear();
  sinceUpdate_m_ = 0;
  away_.assign(particles, 0);
}

Coating::Face Coating::face(const Scene& s, int k) const {
  const Triangle& t = s.triangles[k];
  const Vec3 &a = s.wallPlaces[t[0]], &b = s.wallPlaces[t[1]], &c = s.wallPlaces[t[2]];
  const Vec3 cross = (b - a).cross(c - a);
  Face f;
  f.centre = (a + b + c) / 3;
  f.area_m2 = cross.norm() / 2;
  f.inward = f.area_m2 > 0 ? Vec3(-cross / (2 * f.area_m2)) : Vec3::Zero();
  f.velocity = (s.wallVelocities[t[0]] + s.wallVelocities[t[1]] + s.wallVelocities[t[2]]) / 3;
  return f;
}

/// Fluid before this face, not what lies behind the tissue, with its distance.
void Coating::fluidNear(const Scene& s, const Face& f, std::vector<Neighbours::Near>& out) const {
  s.neighbours.around(f.centre, out);
  std::erase_if(out, [&](Neighbours::Near& n) {
    const Vec3 d = nearestImage(s.places[n.particle] - f.centre, s.period_m);
    n.away_m = d.norm();
    return n.away_m > kLends * spacing_m_ || d.dot(f.inward) <= 0;
  });
}

void Coating::findNearest(const Scene& s) {
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (std::size_t i = 0; i < s.places.size(); ++i)
    if (s.active[i]) low = low.cwiseMin(s.places[i]), high = high.cwiseMax(s.places[i]);
  low.array() -= kLends * spacing_m_;
  high.array() += kLends * spacing_m_;
  for (int a = 0; a < 3; ++a)  // walls go on beyond a period, but those are the same ones again
    if (s.period_m[a] > 0) low[a] = 0, high[a] = s.period_m[a];
  const int n = static_cast<int>(volume_m3_.size());
  nearest_m_.assign(n, INFINITY);
  s.pool.forChunks(n, kChunk, [&](int begin, int end, int) {
    std::vector<Neighbours::Near> near;
    for (int k = begin; k < end; ++k) {
      const Face f = face(s, k);
      if ((f.centre.array() < low.array()).any() || (f.centre.array() >= high.array()).any())
        continue;
      fluidNear(s, f, near);
      for (const auto& found : near)
        nearest_m_[k] = std::min(nearest_m_[k], static_cast<float>(found.away_m));
    }
  });
}

/// Along a face's normal to a triangle that faces it; below zero where sheets cross.
double Coating::acrossTo(const Scene& s, const Face& f, int k) const {
  if (!s.skipped.empty() && s.skipped[k]) return INFINITY;
  const Triangle& t = s.triangles[k];
  const Vec3 &a = s.wallPlaces[t[0]], &b = s.wallPlaces[t[1]], &c = s.wallPlaces[t[2]];
  if ((b - a).cross(c - a).dot(f.inward) <= 0) return INFINITY;
  const double d = alongRay(f.centre, f.inward, a, b, c);
  return d > -kCrossing * spacing_m_ ? d : INFINITY;
}

/// Across the lumen to the next wall.
double Coating::gap_m(const Scene& s, const Face& f) const {
  double least = INFINITY;
  for (int k = 0; k < static_cast<int>(s.triangles.size()); ++k)
    least = std::min(least, acrossTo(s, f, k));
  return least;
}

/// The same where it is narrow, infinite elsewhere.
double Coating::narrowGap_m(const Scene& s, const Face& f) const {
  double least = INFINITY;
  const double reach_m = (kShut + kFaceRadius) * spacing_m_, aside_m = kFaceRadius * spacing_m_;
  faces_.rowsAround(f.centre, reach_m, [&](int first, int last) {
    for (int e = first; e < last; ++e) {
      const Vec3 d = centres_[e] - f.centre;
      const double along = d.dot(f.inward), all = d.squaredNorm();
      if (all > reach_m * reach_m || all - along * along > aside_m * aside_m) continue;
      least = std::min(least, acrossTo(s, f, faces_.order()[e]));
    }
  });
  return least < kShut * spacing_m_ ? least : INFINITY;
}

// The contact line goes as fast as the fluid that has just left. Those who have lent most already
// lend first: few are then less than whole, and the others exactly so.
void Coating::deposit(const Scene& s, int k, std::vector<int>& left) {
  const Face f = face(s, k);
  fluidNear(s, f, near_);
  Vec3 mean_ms = Vec3::Zero();
  for (const auto& n : near_) mean_ms += s.velocities[n.particle] - f.velocity;
  speed_ms_[k] = near_.empty() ? 0 : mean_ms.norm() / static_cast<double>(near_.size());
  const double gap = gap_m(s, f);
  if (near_.empty() || gap < kShut * spacing_m_) return;
  const double h = std::min({filmThickness_m(fluid_, gravity_ms2_, speed_ms_[k], gap / 2), gap / 2,
                             kThickest * spacing_m_});
  double wanted_m3 = h * f.area_m2 - volume_m3_[k];
  std::ranges::sort(near_, [&](const auto& a, const auto& b) {
    const double la = lent_m3_[a.particle], lb = lent_m3_[b.particle];
    return la != lb ? la > lb : a.particle < b.particle;
  });
  for (const auto& [i, away_m] : near_) {
    if (!(wanted_m3 > 0)) return;
    const double given_m3 = std::min(wanted_m3, particle_m3_ - lent_m3_[i]);
    if (!(given_m3 > 0)) continue;
    lent_m3_[i] += given_m3;
    volume_m3_[k] += given_m3;
    wanted_m3 -= given_m3;
    if (lent_m3_[i] < particle_m3_) continue;
    away_[i] = 1;
    left.push_back(i);
  }
}

/// The particle away from the fluid that has least left to get back; -1 when none is away.
int Coating::nextBack() const {
  int best = -1;
  for (int i = 0; i < static_cast<int>(lent_m3_.size()); ++i)
    if (away_[i] && lent_m3_[i] > 0 && (best < 0 || lent_m3_[i] < lent_m3_[best])) best = i;
  return best;
}

// First to those near by who have lent, then to one that is away; it comes back, here or as
// near as there is room, when it is whole. What nobody has lent (its lenders are swallowed) stays
// on the wall.
void Coating::takeUp(const Scene& s, int k, bool revives) {
  const Face f = face(s, k);
  fluidNear(s, f, near_);
  std::erase_if(near_, [&](const auto& n) { return away_[n.particle]; });
  std::ranges::sort(near_, [](const auto& a, const auto& b) {
    return a.away_m != b.away_m ? a.away_m < b.away_m : a.particle < b.particle;
  });
  const auto give = [&](int i) {
    const double given_m3 = std::min(volume_m3_[k], lent_m3_[i]);
    lent_m3_[i] -= given_m3;
    volume_m3_[k] -= given_m3;
  };
  for (const auto& n : near_) give(n.particle);
  while (revives && volume_m3_[k] > 0) {
    const int i = nextBack();
    if (i < 0) return;
    give(i);
    if (lent_m3_[i] > 0) return;
    waiting_.push_back({i, k});
  }
}

// Walls that close squeeze out what is thicker than half their gap, and what is thicker than any
// film spreads: into fluid that is there, else along the skin to where there is most room, which
// is ahead of the wave that shuts the walls.
void Coating::squeeze(const Scene& s, int k) {
  const auto over_m = [&](int at) {  // thicker than may be; below zero: room
    if (std::isnan(narrow_m_[at])) narrow_m_[at] = narrowGap_m(s, face(s, at));
    const double area_m2 = face(s, at).area_m2;
    const double most_m = std::min(kThickest * spacing_m_, std::max(0.0, narrow_m_[at] / 2));
    return area_m2 > 0 ? volume_m3_[at] / area_m2 - most_m : INFINITY;
  };
  double over = over_m(k);
  if (!(over > 0)) return;
  if (nearest_m_[k] < kLends * spacing_m_) takeUp(s, k, false), over = over_m(k);
  int roomiest = -1;
  double least = over;
  for (const int j : beside_[k]) {
    if (j < 0 || (!s.skipped.empty() && s.skipped[j])) continue;
    if (const double there = over_m(j); there < least) least = there, roomiest = j;
  }
  if (roomiest < 0 || !(over > 0)) return;
  // no more than what makes both alike
  const double area_m2 = face(s, k).area_m2, there_m2 = face(s, roomiest).area_m2;
  const double whole =
      std::isfinite(over)
          ? std::min(over * area_m2, (over - least) * area_m2 * there_m2 / (area_m2 + there_m2))
          : volume_m3_[k];
  const double moved_m3 = std::min(volume_m3_[k], whole);
  volume_m3_[k] -= moved_m3;
  volume_m3_[roomiest] += moved_m3;
}

void Coating::findGaps(const Scene& s) {
  std::vector<Vec3> centres;
  for (const Triangle& t : s.triangles)
    centres.push_back((s.wallPlaces[t[0]] + s.wallPlaces[t[1]] + s.wallPlaces[t[2]]) / 3);
  faces_.build(centres, {}, (kShut + kFaceRadius) * spacing_m_);
  centres_.clear();
  for (const int k : faces_.order()) centres_.push_back(centres[k]);
  const int n = static_cast<int>(volume_m3_.size());
  narrow_m_.assign(n, NAN);
  s.pool.forChunks(n, kChunk, [&](int begin, int end, int) {
    for (int k = begin; k < end; ++k)
      if (volume_m3_[k] > 0) narrow_m_[k] = narrowGap_m(s, face(s, k));
  });
}

/// Which triangle lies beyond each edge.
void Coating::findBeside(const Scene& s) {
  beside_.assign(volume_m3_.size(), {-1, -1, -1});
  std::map<std::pair<int, int>, std::pair<int, int>> edges;  // [from, to] triangle and its edge
  for (int k = 0; k < static_cast<int>(beside_.size()); ++k)
    for (int e = 0; e < 3; ++e) edges[{s.triangles[k][e], s.triangles[k][(e + 1) % 3]}] = {k, e};
  for (const auto& [ends, at] : edges)
    if (const auto other = edges.find({ends.second, ends.first}); other != edges.end())
      beside_[at.first][at.second] = other->second.first;
}

bool Coating::isDue(double moved_m) {
  sinceUpdate_m_ += moved_m;
  if (sinceUpdate_m_ < kEvery * spacing_m_) return false;
  sinceUpdate_m_ = 0;
  return true;
}

std::vector<int> Coating::update(const Scene& s) {
  std::vector<int> left;
  if (beside_.empty()) findBeside(s);
  findNearest(s);
  findGaps(s);
  for (int k = 0; k < static_cast<int>(volume_m3_.size()); ++k) {
    if (!s.skipped.empty() && s.skipped[k]) continue;
    const double away = nearest_m_[k] / spacing_m_;
    const bool wasWet = wetness_[k] == Wetness::wet;
    if (away < kWet) wetness_[k] = Wetness::wet;
    if (wasWet && away > kDry) {
      wetness_[k] = Wetness::left;
      deposit(s, k, left);
    }
    if (!(volume_m3_[k] > 0)) continue;
    if (wetness_[k] == Wetness::wet)
      takeUp(s, k, true);
    else
      squeeze(s, k);
  }
  return left;
}

// Places at the wall where fluid is, those next to where the particle became whole first.
std::vector<Vec3> Coating::placesFor(const Scene& s, const Waiting& w) const {
  std::vector<std::pair<double, int>> order;
  const Vec3 home = face(s, w.triangle).centre;
  for (int k = 0; k < static_cast<int>(wetness_.size()); ++k)
    if (wetness_[k] == Wetness::wet && (s.skipped.empty() || !s.skipped[k]))
      order.emplace_back(
          nearestImage(s.wallPlaces[s.triangles[k][0]] - home, s.period_m).squaredNorm(), k);
  const auto most = std::min<std::size_t>(order.size(), kPlacesTried);
  std::ranges::partial_sort(order, order.begin() + static_cast<long>(most));
  std::vector<Vec3> places;
  for (std::size_t e = 0; e < most; ++e) {
    const Face f = face(s, order[e].second);
    places.push_back(f.centre + kReturnsAt * spacing_m_ * f.inward);
  }
  return places;
}

void Coating::cameBack(int particle) {
  away_[particle] = 0;
  std::erase_if(waiting_, [&](const Waiting& w) { return w.particle == particle; });
}

// After the walls of a step are met: what they take from the fluid and give back to it.
void Solver::Impl::coatWalls(const Substep& step) {
  if (!coating.on() || frozen) return;
  if (!coating.isDue(step.length_s * std::max(step.maxSpeed_ms, fastestWall_ms))) return;
  const Coating::Scene scene{
      neighbours, particles.positions, particles.velocities, active,       wallTriangles,
      skipped,    wallPositions,       wallVelocities,       def.period_m, pool};
  for (const int i : coating.update(scene)) {
    particles.state[i] = State::coating;
    particles.velocities[i].setZero();
    particles.densityRatio[i] = 1;
    contacts[i].clear();
    active[i] = 0;
    walls[i] = held[i].sample = {};
    held[i].time_s = -INFINITY;
    findNeighbours();
  }
  for (const Coating::Waiting w : std::vector(coating.waiting()))
    for (const Vec3& place : coating.placesFor(scene, w))
      if (joins(w.particle, place)) break;
}

/// Puts a particle that lay on the walls into the fluid, if there is room.
bool Solver::Impl::joins(int i, const Vec3& place) {
  neighbours.around(place, nearFilm);
  double sum = kernel.w(0);
  const Neighbours::Near* nearest = nullptr;
  for (const Neighbours::Near& n : nearFilm) {
    sum += kernel.w(n.away_m);
    if (!nearest || n.away_m < nearest->away_m) nearest = &n;
  }
  if (!nearest || nearest->away_m < kRoom * def.spacing_m ||
      volume_m3 * sum + field.sample(place).lambda > kRoomDensity)
    return false;
  particles.state[i] = State::fluid;
  particles.positions[i] = place;
  particles.velocities[i] = particles.velocities[nearest->particle];
  active[i] = 1;
  findContacts(i);
  gap_m[i] = localGap_m(contacts[i]);
  sampleWallsOf(i);
  coating.cameBack(i);
  findNeighbours();
  return true;
}
}  // namespace swallowclip::bolus
