// SPDX-License-Identifier: MIT
// Where the walls are, which particles they hold, stop or give back to the fluid.
#include <algorithm>
#include <array>
#include <cmath>

#include "bolus/solver_impl.h"

namespace swallowclip::bolus {
namespace {
constexpr int kWallChunk = 16;  // particles per work item of wall work
// Farther than this from where walls were last integrated, or contacts looked for, it is done
// again: spacings, assumed (0.05 to 0.15; with 0.2 columns at rest are 0.25 % worse). Walls that
// move may turn and stretch as well, so theirs is less (0.01 to 0.1).
constexpr double kHeldMove = 0.1, kHeldMoveOfWalls = 0.03;
// More than contacts reach, for rounding and walls that speed up; spacings, assumed (0.05 to 0.2).
constexpr double kClearMargin = 0.1;
constexpr double kFilmGap = 0.3;  // spacings, DESIGN 5 (0.6 invents residue)
// The same in a fold or cusp, where no contact faces the nearest: a slit of that width leaves a
// fifth of the kernel. At most 1 where sheets do not cross.
constexpr double kFilmLambda = 0.8;
// Less than sheets may cross: between crossed sheets it must not lie beyond the other one.
// Spacings, assumed (0.1 to 0.45).
constexpr double kFilmReach = 0.2;
constexpr double kTakeUpReach = 1.2;  // spacings, assumed (1 to 1.5)
constexpr int kTakeUpCount = 3;       // fluid particles that near take a film up, assumed (2 to 5)
constexpr double kTakeUpDensity = 1.03;   // of rho0 where a film is taken up, assumed (1 to 1.05)
constexpr double kCrowdedDensity = 1.08;  // and at most what it makes of others', assumed
// Steps that a neighbour list shall serve for, and must at least, to reach farther than the kernel;
// and the least and most that it reaches farther, in spacings. Assumed (4 to 16, 2 to 4, 0.02 to
// 0.1, 0.3 to 0.6): they change speed and the order of sums only.
constexpr double kListSteps = 8, kLeastListSteps = 2, kLeastSkin = 0.05, kMostSkin = 0.5;
// Who is denser than this and is pushed against a wall gets room made by others; and what walls
// take from a step that counts, in spacings. Assumed (1.03 to 1.1; 1e-4 to 1e-2).
constexpr double kTooDense = 1.05, kStopped = 1e-3;
constexpr double kNearEnd_m = 15e-3;  // this near the UES plane s is looked up every step, assumed
}  // namespace

void Solver::Impl::evaluateWalls(double t_s) {
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (std::size_t i = 0; i < particles.positions.size(); ++i) {
    if (isGone(particles.state[i])) continue;
    low = low.cwiseMin(particles.positions[i]);
    high = high.cwiseMax(particles.positions[i]);
  }
  const bool stood = fastestWall_ms == 0;
  if (!wallsStood || !(motion->standsStill || (frozen && t_s == wallsAt_s))) lookAtWalls(t_s);
  shutBranches(t_s);
  field.build(wallTriangles, wallPositions, wallVelocities, low, high, skipped,
              stood && wallsStood);
}

void Solver::Impl::lookAtWalls(double t_s) {
  wallsAt_s = t_s;
  motion->at(t_s, wallPositions, wallVelocities);
  if (frozen) std::fill(wallVelocities.begin(), wallVelocities.end(), Vec3::Zero());
  fastestWall_ms = 0;
  for (const Vec3& v : wallVelocities) fastestWall_ms = std::max(fastestWall_ms, v.squaredNorm());
  fastestWall_ms = std::sqrt(fastestWall_ms);
  const bool samePlaces = wallPositions == wallsBefore;
  wallsStood = fastestWall_ms == 0 && samePlaces;
  if (!samePlaces) wallsBefore = wallPositions;
}

// What was integrated was other walls.
void Solver::Impl::forgetWalls() {
  for (HeldWalls& h : held) h.time_s = -INFINITY;
  if (!tension) return;
  for (HeldWalls& h : tension->held()) h.time_s = -INFINITY;
}

// A branch shut lip to lip and empty is no wall: the tube goes, a cap closes the slit it leaves.
void Solver::Impl::shutBranches(double t_s) {
  if (wallTriangles.empty()) wallTriangles = motion->triangles;
  if (!motion->sealed || motion->branch.empty()) return;
  std::array<bool, 3> shut{};
  for (int b : {1, 2}) {
    shut[b] = motion->sealed(t_s, b);
    for (std::size_t i = 0; shut[b] && i < particles.branch.size(); ++i)
      shut[b] = isGone(particles.state[i]) || particles.branch[i] != b;
  }
  if (shut == shutBefore) return;
  shutBefore = shut;
  forgetWalls();
  const std::size_t own = motion->triangles.size();
  const auto markTubes = [&](auto&& taken) {
    for (std::size_t k = 0; k < own; ++k)
      for (int v : motion->triangles[k])
        if (const int b = motion->branch[v]; b != 0 && taken((b - 1) % 2 + 1)) skipped[k] = 1;
  };
  for (int b : {1, 2})
    if (shut[b] && caps[b].first == caps[b].second) {
      skipped.assign(own, 0);
      markTubes([&](int branch) { return branch == b; });
      const std::vector<Triangle> cap = capHoles(motion->triangles, skipped, wallPositions);
      caps[b].first = static_cast<int>(wallTriangles.size());
      wallTriangles.insert(wallTriangles.end(), cap.begin(), cap.end());
      caps[b].second = static_cast<int>(wallTriangles.size());
    }
  skipped.assign(wallTriangles.size(), 0);
  markTubes([&](int branch) { return shut[branch]; });
  for (int b : {1, 2})
    if (!shut[b]) std::fill(&skipped[0] + caps[b].first, &skipped[0] + caps[b].second, 1);
}

// Then what the walls do to those that take part.
int Solver::Impl::pushInside() {
  const int n = static_cast<int>(particles.positions.size());
  caught.resize(n);
  return static_cast<int>(pool.sumChunks(n, kWallChunk, [&](int begin, int end) {
    double rescued = 0;
    for (int i = begin; i < end; ++i)
      if (!isGone(particles.state[i])) {
        held[i].fastestWall_ms = std::max(held[i].fastestWall_ms, fastestWall_ms);
        if (!isClear(i)) rescued += followContacts(i) ? 0.0 : findContacts(i);
        gap_m[i] = localGap_m(contacts[i]);
        keepOutOfSlits(i);
        keepOnWall(i);
        if (active[i]) sampleWallsOf(i);
        caught[i] = isCaught(i);
      }
    return rescued;
  }));
}

// A gap too narrow for particles counts as shut: walls may close on a particle (film), but none
// flows in from a wider place. Instead it stays before the slit's mouth, moving with the wall
// there.
void Solver::Impl::keepOutOfSlits(int i) {
  const double shut_m = kFilmGap * def.spacing_m;
  if (carried.empty() || particles.state[i] != State::fluid || gap_m[i] >= shut_m) return;
  std::vector<Contact> before;
  Vec3 place = carried[i].first;
  projectInside(field, def.spacing_m, pushLimit_m(), false, place, before);
  const double wide_m = localGap_m(before);
  if (before.empty() || before[0].distance_m < 0 || wide_m < shut_m) return;
  gap_m[i] = wide_m;
  particles.positions[i] = place;
  particles.velocities[i] = carried[i].second;
  contacts[i] = std::move(before);
}

// A solve for places takes walls for soft: in a fold that closes it sends the layer before the wall
// through it, contacts take that back, and nobody else moves. There it is done again with who was
// stopped. Returns how many iterations that took.
int Solver::Impl::makeRoom(const Flow& flow, double dt_s) {
  const auto tooDense = [&](int p) {
    return particles.densityRatio[p] > kTooDense && !contacts[p].empty();
  };
  if (frozen || std::ranges::none_of(neighbours.id, tooDense)) return 0;
  const double least_ms = kStopped * def.spacing_m / dt_s;
  std::vector<Vec3f> stopped(flow.count(), Vec3f::Zero());
  std::vector<Vec3> left = moving;
  bool needed = false;
  for (int i = 0; i < flow.count(); ++i) {
    const int p = flow.particle(i);
    if (contacts[p].empty()) continue;
    clampVelocity(contacts[p], gap_m[p], def.spacing_m, dt_s, left[p]);
    const Vec3 taken = moving[p] - left[p];
    const double taken_ms = taken.norm();
    if (taken_ms < least_ms) continue;
    stopped[i] = (taken / taken_ms).cast<float>();
    needed = needed || tooDense(p);
  }
  if (!needed) return 0;
  moving = std::move(left);
  return projection.makeRoom(flow, particles.densityRatio, dt_s, std::move(stopped), moving)
      .iterations;
}

// Film by the width of the lumen alone, never by density. When the walls part again a film stays on
// the nearer one and drains, until fluid comes by and takes it up.
void Solver::Impl::updateStates() {
  takenUp.clear();
  for (std::size_t i = 0; i < active.size(); ++i) {
    State& s = particles.state[i];
    if (!isGone(s)) {
      const bool wasFilm = s == State::film;
      s = caught[i] || staysFilm(i) ? State::film : State::fluid;
      if (wasFilm && s == State::fluid) takenUp.push_back(static_cast<int>(i));
    }
    if (s != State::fluid) {
      walls[i] = held[i].sample = {};
      held[i].time_s = -INFINITY;
    }
    active[i] = s == State::fluid;
  }
  for (const int i : takenUp) sampleWallsOf(i);
  for (std::size_t i = 0; i < active.size(); ++i)
    if (!active[i]) particles.densityRatio[i] = 1;
}

bool Solver::Impl::isCaught(int i) const {
  const bool betweenCrossed = !contacts[i].empty() && contacts[i][0].distance_m < 0;
  return betweenCrossed || gap_m[i] < kFilmGap * def.spacing_m || walls[i].lambda > kFilmLambda;
}

bool Solver::Impl::staysFilm(std::size_t i) const {
  if (particles.state[i] != State::film) return false;
  const Vec3& x = particles.positions[i];
  neighbours.around(x, nearFilm);
  const double reach_m = kTakeUpReach * def.spacing_m;
  const auto close = [&](const auto& n) { return n.away_m < reach_m; };
  if (!contacts[i].empty() && std::ranges::count_if(nearFilm, close) < kTakeUpCount) return true;
  // fluid that is there already makes room first
  for (const int j : takenUp) nearFilm.push_back({j, (particles.positions[j] - x).norm()});
  double sum = kernel.w(0);
  for (const auto& [j, away_m] : nearFilm) {
    const double share = volume_m3 * kernel.w(away_m);
    if (share > 0 && particles.densityRatio[j] + share > kCrowdedDensity) return true;
    sum += kernel.w(away_m);
  }
  return volume_m3 * sum + field.sample(x).lambda > kTakeUpDensity;
}

Vec3 Solver::Impl::filmVelocity_ms(int i) const {
  const std::vector<Contact>& c = contacts[i];
  if (c.empty()) return particles.velocities[i];  // let go by a wall, on its way into the fluid
  if (gap_m[i] < kFilmGap * def.spacing_m)        // held by two sheets
    return (c[0].velocity + c[facingContact(c)].velocity) / 2;
  const Vec3 along = def.gravity_ms2 - def.gravity_ms2.dot(c[0].inward) * c[0].inward;
  return c[0].velocity + (frozen ? 0.0 : filmDrainage_s) * along;
}

void Solver::Impl::keepOnWall(int i) {
  if (particles.state[i] != State::film || contacts[i].empty()) return;
  const Contact& c = contacts[i][0];
  const double farthest_m = kFilmReach * def.spacing_m;
  if (c.distance_m > farthest_m) particles.positions[i] = c.point + farthest_m * c.inward;
}

void Solver::Impl::sampleWallsOf(int i) {
  if (!followWalls(i)) walls[i] = held[i].sample = field.sample(particles.positions[i]);
  if (def.slip) walls[i].friction = walls[i].area = 0;
  walls[i].gap_m = gap_m[i];
}

double Solver::Impl::pushLimit_m() const {
  const double dt_s = lastStep_s > 0 ? lastStep_s : INFINITY;  // before the first step: all the way
  return longestPush_m(def.spacing_m, dt_s, fastestWall_ms * lastStep_s);
}

bool Solver::Impl::findContacts(int i) {
  Vec3& x = particles.positions[i];
  const bool film = particles.state[i] == State::film;
  const bool wasOutside = projectInside(field, def.spacing_m, pushLimit_m(), film, x, contacts[i]);
  contactsAt[i] = x;
  return wasOutside;
}

// How far a particle and the walls may have moved since its walls were last integrated.
double Solver::Impl::movedSinceHeld_m(int i) const {
  return held[i].moved_m(particles.positions[i], time_s);
}

// Where the walls' integrals saw no wall near there are no contacts to look for.
bool Solver::Impl::isClear(int i) {
  const double reach_m = (kContactReach + kClearMargin) * def.spacing_m;
  if (!(held[i].sample.clear_m - movedSinceHeld_m(i) > reach_m)) return false;
  contacts[i].clear();
  contactsAt[i] = Vec3::Constant(INFINITY);
  return true;
}

// Before walls that stand still a small move changes distances, but no wall points worth looking
// for.
bool Solver::Impl::followContacts(int i) {
  const double most_m = kHeldMove * def.spacing_m;
  if (fastestWall_ms > 0 || !wallsStood ||
      (particles.positions[i] - contactsAt[i]).squaredNorm() > most_m * most_m)
    return false;
  if (!measureAgain(contacts[i], particles.positions[i])) return false;
  keepDistance(contacts[i], def.spacing_m, particles.positions[i]);
  return measureAgain(contacts[i], particles.positions[i]);
}

// While walls and particles hardly move, in wcsph's short steps or where walls stand still, most of
// the time would go into the same integrals again. The last ones serve on, with their slopes; no
// longer than walls as fast as the fastest since then take to move. Of walls that are out of reach
// nothing is felt until they, or the particle, can have come within it.
bool Solver::Impl::followWalls(int i) {
  HeldWalls& h = held[i];
  const Vec3 moved = particles.positions[i] - h.place;
  const double since_s = time_s - h.time_s;
  const double most = h.fastestWall_ms > 0 ? kHeldMoveOfWalls : kHeldMove;
  const double moved_m = movedSinceHeld_m(i);
  if (moved_m < most * def.spacing_m || h.sample.clear_m - moved_m > kernel.support_m()) {
    walls[i] = field.nearTo(h.sample, moved, since_s);
    return true;
  }
  h.place = particles.positions[i];
  h.time_s = time_s;
  h.fastestWall_ms = fastestWall_ms;
  return false;
}

// s and branch of the nearest skin triangle: from the contacts or the wall integrals where a wall
// is within reach, else by a full search near the UES plane and at the ends of frames.
void Solver::Impl::updatePath(bool all) {
  const WallMotion& m = *motion;
  if (m.s_m.empty() && m.branch.empty()) return;
  const double nearEnd = def.swallowedAt_s_m - kNearEnd_m;
  const auto isFar = [&](std::size_t i) {  // from all walls, and has to know its s
    return !isGone(particles.state[i]) && contacts[i].empty() && walls[i].nearestTriangle < 0 &&
           (all || particles.s_m[i] >= nearEnd);
  };
  for (std::size_t i = 0; i < active.size(); ++i)
    if (isFar(i)) {
      runs.build(wallPositions, m.triangles);
      break;
    }
  pool.forChunks(static_cast<int>(active.size()), kWallChunk, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      if (isGone(particles.state[i])) continue;
      int k = contacts[i].empty() ? walls[i].nearestTriangle : contacts[i][0].triangle;
      const Vec3& p = particles.positions[i];
      if (k < 0 && !all && particles.s_m[i] < nearEnd) continue;
      if (k < 0) k = runs.nearest(p, wallPositions, m.triangles, lastNearest[i]).triangle;
      if (k < static_cast<int>(m.triangles.size())) lastNearest[i] = k;
      const Triangle& t = wallTriangles[k];
      const Vec3 bary =
          closestBarycentric(p, wallPositions[t[0]], wallPositions[t[1]], wallPositions[t[2]]);
      if (!m.s_m.empty()) particles.s_m[i] = Vec3(m.s_m[t[0]], m.s_m[t[1]], m.s_m[t[2]]).dot(bary);
      int corner = 0;
      bary.maxCoeff(&corner);
      if (!m.branch.empty()) particles.branch[i] = m.branch[t[corner]];
    }
  });
  if (m.s_m.empty() || frozen) return;
  for (std::size_t i = 0; i < active.size(); ++i) {
    const bool insideLumen = contacts[i].empty() || contacts[i][0].distance_m >= 0;
    if (isGone(particles.state[i]) || !insideLumen) continue;
    if (particles.s_m[i] < def.swallowedAt_s_m || particles.branch[i] != 0) continue;
    particles.state[i] = State::swallowed;
    particles.velocities[i].setZero();
    particles.densityRatio[i] = 1;
    active[i] = 0;
    contacts[i].clear();
  }
}

// A list is worth its longer reach when it serves for a few steps.
void Solver::Impl::findNeighbours() {
  double fastest2 = 0;
  for (std::size_t i = 0; i < active.size(); ++i)
    if (active[i]) fastest2 = std::max(fastest2, particles.velocities[i].squaredNorm());
  const double longest_m = kMostSkin * def.spacing_m, step_m = 2 * std::sqrt(fastest2) * lastStep_s;
  double skin_m = std::clamp(kListSteps * step_m, kLeastSkin * def.spacing_m, longest_m);
  if (kLeastListSteps * step_m > longest_m) skin_m = 0;
  neighbours.build(particles.positions, active, table, volume_m3, def.period_m, skin_m, pool,
                   findDensities());
}

Neighbours::Range Solver::Impl::findDensities() {
  beside.resize(active.size());
  return [this](int begin, int end) {
    for (int s = begin; s < end; ++s) {
      const int i = neighbours.id[s];
      particles.densityRatio[i] = neighbours.sumW[s] + walls[i].lambda;
      beside[s] = walls[i].nearestTriangle >= 0;
    }
  };
}

void Solver::Impl::wrapPeriods() {
  for (int a = 0; a < 3; ++a) {
    const double length = def.period_m[a];
    if (length <= 0) continue;
    for (Vec3& x : particles.positions) x[a] -= length * std::floor(x[a] / length);
  }
}

int Solver::Impl::meetWalls(double t_s) {
  time_s = t_s;
  wrapPeriods();
  evaluateWalls(t_s);
  const int rescued = pushInside();
  updateStates();
  updatePath(false);
  if (!neighbours.follow(particles.positions, active, table, volume_m3, pool, findDensities()))
    findNeighbours();
  return rescued;
}
}  // namespace swallowclip::bolus
