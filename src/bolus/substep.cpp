// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include "bolus/solver_impl.h"

namespace swallowclip::bolus {
namespace {
constexpr int kWallChunk = 16;            // particles per work item of wall work
constexpr double kShortestStep_s = 5e-6;  // assumed: below it nothing moves any more
constexpr double kWallCourant = 0.05;     // spacings per step at the fastest wall, DESIGN 5
constexpr double kLongestMove = 0.5;      // spacings per step, assumed; contacts reach 0.9
// Pressure and viscosity act one after the other, which leaves compression behind where a thick
// fluid is squeezed: 5 Pa.s at 2 mm, 2.8 / 0.5 / 0.2 per mille on average at 0.6 / 0.25 / 0.125 ms.
// So a step that leaves more than this shortens the next one, and quiet ones lengthen it again.
constexpr double kMeanError = 1.5e-3, kPeakError = 0.07;  // assumed (half of what is allowed)
constexpr double kShorten = 0.7, kLengthen = 1.04;        // assumed
constexpr double kLeastShare = 1.0 / 16;                  // of the step otherwise chosen, assumed
constexpr double kHeldMove = 0.03;  // spacings, assumed (0.01 to 0.05): lambda within 5e-4
constexpr double kFilmGap = 0.3;    // spacings, DESIGN 5 (0.6 invents residue)
// The same in a fold or cusp, where no contact faces the nearest: a slit of that width leaves a
// fifth of the kernel. At most 1 where sheets do not cross.
constexpr double kFilmLambda = 0.8;
constexpr double kFilmThickness = 0.1;  // spacings, assumed (0.05 to 0.3): how thick a film drains
constexpr double kFilmReach = 0.45;     // spacings: just above a particle's rest distance
constexpr double kTakeUpReach = 1.2;    // spacings, assumed (1 to 1.5)
constexpr int kTakeUpCount = 3;  // fluid particles that near take a film up, assumed (2 to 5)
constexpr double kTakeUpDensity = 1.03;  // of rho0 where a film is taken up, assumed (1 to 1.05)
constexpr double kNearEnd_m = 15e-3;  // this near the UES plane s is looked up every step, assumed

// Nusselt (1916): mean speed of a film of thickness h down a wall is rho g h^2 / (3 eta); here per
// unit of acceleration. The apparent viscosity is that of the film's own wall shear.
double drainagePerAcceleration_s(const Fluid& fluid, double thickness_m, double acceleration_ms2) {
  double eta = apparentViscosity_Pas(fluid, 1.0);
  for (int k = 0; k < 20; ++k)
    eta = apparentViscosity_Pas(fluid, fluid.density_kgm3 * acceleration_ms2 * thickness_m / eta);
  return fluid.density_kgm3 * thickness_m * thickness_m / (3 * eta);
}
}  // namespace

Solver::Impl::Impl(const BolusDef& d, const WallMotion& m, int threads)
    : def(d),
      motion(&m),
      pool(std::max(1, threads)),
      kernel(d.kernel, supportPerSpacing(d.kernel) * d.spacing_m),
      table(kernel),
      field(table, d.spacing_m),
      volume_m3(std::pow(d.spacing_m, 3) / kernel.latticeSum(d.spacing_m)),
      filmDrainage_s(
          drainagePerAcceleration_s(d.fluid, kFilmThickness * d.spacing_m, d.gravity_ms2.norm())) {}

void Solver::Impl::start(double t_s, std::vector<Vec3> places, std::vector<Vec3> velocities) {
  const std::size_t n = places.size();
  particles.positions = std::move(places);
  particles.velocities = std::move(velocities);
  particles.velocities.resize(n, Vec3::Zero());
  particles.pressure_Pa.assign(n, 0.0);
  particles.densityRatio.assign(n, 1.0);
  particles.state.assign(n, State::fluid);
  particles.s_m.assign(n, 0.0);
  particles.branch.assign(n, 0);
  contacts.assign(n, {});
  walls.assign(n, {});
  held.assign(n, {});
  contactsAt.assign(n, Vec3::Constant(INFINITY));
  active.assign(n, 1);
  projection.resize(static_cast<int>(n));
  wcsph.start();
  lastStep_s = 0;
  projection.tolerances = {def.densityTolerance, def.rateTolerance};
  projection.full = def.full;
  stats = {};
  errorSum = errorCount = aboveTenCount = infeasible_s = 0;
  stepShare = 1;
  meetWalls(t_s);
  finishFrame();
}

void Solver::Impl::evaluateWalls(double t_s) {
  motion->at(t_s, wallPositions, wallVelocities);
  if (frozen) std::fill(wallVelocities.begin(), wallVelocities.end(), Vec3::Zero());
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (std::size_t i = 0; i < particles.positions.size(); ++i) {
    if (particles.state[i] == State::swallowed) continue;
    low = low.cwiseMin(particles.positions[i]);
    high = high.cwiseMax(particles.positions[i]);
  }
  fastestWall_ms = 0;
  for (const Vec3& v : wallVelocities) fastestWall_ms = std::max(fastestWall_ms, v.squaredNorm());
  fastestWall_ms = std::sqrt(fastestWall_ms);
  wallsStood = fastestWall_ms == 0 && wallPositions == wallsBefore;
  wallsBefore = wallPositions;
  shutBranches(t_s);
  field.build(wallTriangles, wallPositions, wallVelocities, low, high, skipped);
}

// A branch shut lip to lip and empty is no wall: the tube goes, a cap closes the slit it leaves.
void Solver::Impl::shutBranches(double t_s) {
  if (wallTriangles.empty()) wallTriangles = motion->triangles;
  if (!motion->sealed || motion->branch.empty()) return;
  std::array<bool, 3> shut{};
  for (int b : {1, 2}) {
    shut[b] = motion->sealed(t_s, b);
    for (std::size_t i = 0; shut[b] && i < particles.branch.size(); ++i)
      shut[b] = particles.state[i] == State::swallowed || particles.branch[i] != b;
  }
  if (shut == shutBefore) return;
  shutBefore = shut;
  for (Held& h : held) h.time_s = -INFINITY;
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

int Solver::Impl::pushInside() {
  const int n = static_cast<int>(particles.positions.size());
  return static_cast<int>(pool.sumChunks(n, kWallChunk, [&](int begin, int end) {
    double rescued = 0;
    for (int i = begin; i < end; ++i)
      if (particles.state[i] != State::swallowed) {
        rescued += followContacts(i) ? 0.0 : findContacts(i);
        keepOutOfSlits(i);
        keepOnWall(i);
      }
    return rescued;
  }));
}

// A gap too narrow for particles counts as shut: walls may close on a particle (film), but none
// flows in from a wider place. Instead it stays before the slit's mouth, moving with the wall
// there.
void Solver::Impl::keepOutOfSlits(int i) {
  const double shut_m = kFilmGap * def.spacing_m;
  if (carried.empty() || particles.state[i] != State::fluid || localGap_m(contacts[i]) >= shut_m)
    return;
  std::vector<Contact> before;
  Vec3 place = carried[i].first;
  projectInside(field, def.spacing_m, place, before);
  if (before.empty() || before[0].distance_m < 0 || localGap_m(before) < shut_m) return;
  particles.positions[i] = place;
  particles.velocities[i] = carried[i].second;
  contacts[i] = std::move(before);
}

// Film by the width of the lumen alone, never by density. When the walls part again a film stays on
// the nearer one and drains, until fluid comes by and takes it up.
void Solver::Impl::updateStates() {
  takenUp.clear();
  for (std::size_t i = 0; i < active.size(); ++i) {
    State& s = particles.state[i];
    if (s != State::swallowed) {
      const bool wasFilm = s == State::film;
      s = localGap_m(contacts[i]) < kFilmGap * def.spacing_m || walls[i].lambda > kFilmLambda ||
                  staysFilm(i)
              ? State::film
              : State::fluid;
      if (wasFilm && s == State::fluid) takenUp.push_back(static_cast<int>(i));
    }
    if (s != State::fluid) {
      walls[i] = held[i].sample = {};
      held[i].time_s = -INFINITY;
    }
    active[i] = s == State::fluid;
  }
  for (const int i : takenUp) sampleWallsOf(i);
}

bool Solver::Impl::staysFilm(std::size_t i) const {
  if (particles.state[i] != State::film || contacts[i].empty()) return false;
  const Vec3& x = particles.positions[i];
  if (neighbours.countWithin(x, kTakeUpReach * def.spacing_m) < kTakeUpCount) return true;
  // fluid that is there already makes room first
  double sum = neighbours.sumWAt(x, kernel) + kernel.w(0);
  for (const int j : takenUp) sum += kernel.w((particles.positions[j] - x).norm());
  return volume_m3 * sum + field.sample(x).lambda > kTakeUpDensity;
}

Vec3 Solver::Impl::filmVelocity_ms(int i) const {
  const std::vector<Contact>& c = contacts[i];
  if (localGap_m(c) < kFilmGap * def.spacing_m)  // held by two sheets
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

void Solver::Impl::sampleWalls() {
  pool.forChunks(static_cast<int>(active.size()), kWallChunk, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i)
      if (active[i]) sampleWallsOf(i);
  });
}

void Solver::Impl::sampleWallsOf(int i) {
  if (!followWalls(i)) walls[i] = held[i].sample = field.sample(particles.positions[i]);
  if (def.slip) walls[i].friction = walls[i].area = 0;
  walls[i].gap_m = localGap_m(contacts[i]);
}

// Between the short steps of wcsph walls and particles hardly move: half of its time would go into
// the same integrals again. The last ones serve on, lambda along its own gradient and rate.
bool Solver::Impl::findContacts(int i) {
  Vec3& x = particles.positions[i];
  const bool wasOutside = projectInside(field, def.spacing_m, x, contacts[i]);
  contactsAt[i] = x;
  return wasOutside;
}

// Before walls that stand still a small move changes distances, but no wall points worth looking
// for.
bool Solver::Impl::followContacts(int i) {
  const double most_m = kHeldMove * def.spacing_m;
  if (fastestWall_ms > 0 || !wallsStood ||
      (particles.positions[i] - contactsAt[i]).squaredNorm() > most_m * most_m)
    return false;
  for (Contact& c : contacts[i]) {
    c.distance_m = (particles.positions[i] - c.point).dot(c.inward);
    if (c.distance_m < 0) return false;
  }
  keepDistance(contacts[i], def.spacing_m, particles.positions[i]);
  for (Contact& c : contacts[i]) {
    c.distance_m = (particles.positions[i] - c.point).dot(c.inward);
    if (c.distance_m < 0) return false;
  }
  return true;
}

bool Solver::Impl::followWalls(int i) {
  Held& h = held[i];
  const Vec3 moved = particles.positions[i] - h.place;
  const double since_s = time_s - h.time_s;
  if (moved.norm() + since_s * fastestWall_ms < kHeldMove * def.spacing_m) {
    walls[i] = h.sample;
    walls[i].lambda =
        std::max(0.0, h.sample.lambda + moved.dot(h.sample.gradLambda) - since_s * h.sample.flux_s);
    return true;
  }
  h.place = particles.positions[i];
  h.time_s = time_s;
  return false;
}

// s and branch of the nearest skin triangle: from the contacts or the wall integrals where a wall
// is within reach, else by a full search near the UES plane and at the ends of frames.
void Solver::Impl::updatePath(bool all) {
  const WallMotion& m = *motion;
  if (m.s_m.empty() && m.branch.empty()) return;
  const double nearEnd = def.swallowedAt_s_m - kNearEnd_m;
  pool.forChunks(static_cast<int>(active.size()), kWallChunk, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      if (particles.state[i] == State::swallowed) continue;
      int k = contacts[i].empty() ? walls[i].nearestTriangle : contacts[i][0].triangle;
      const Vec3& p = particles.positions[i];
      if (k < 0 && !all && particles.s_m[i] < nearEnd) continue;
      if (k < 0) k = nearestPoint(p, wallPositions, m.triangles).triangle;
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
    if (particles.state[i] == State::swallowed || !insideLumen) continue;
    if (particles.s_m[i] < def.swallowedAt_s_m || particles.branch[i] != 0) continue;
    particles.state[i] = State::swallowed;
    particles.velocities[i].setZero();
    particles.densityRatio[i] = 1;
    active[i] = 0;
    contacts[i].clear();
  }
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
  sampleWalls();
  updateStates();
  updatePath(false);
  neighbours.build(particles.positions, active, table, volume_m3, def.period_m, pool);
  for (std::size_t i = 0; i < active.size(); ++i)
    particles.densityRatio[i] =
        active[i] ? neighbours.sumW[neighbours.slot[i]] + walls[i].lambda : 1.0;
  return rescued;
}

double Solver::Impl::chooseStep_s(double longest_s) {
  double fastest = 0, wall = 0;
  for (std::size_t i = 0; i < active.size(); ++i) {
    if (particles.state[i] == State::swallowed) continue;
    fastest = std::max(fastest, particles.velocities[i].norm());
    if (active[i]) wall = std::max(wall, walls[i].normalSpeed_ms);
  }
  double dt = def.longestStep_s;
  if (compressible() && neighbours.count > 0) {
    chooseSound(std::max(fastest, wall));
    dt = std::min(dt, wcsph.longestStep_s(kernel.support_m() / 2));
  }
  fastest += dt * def.gravity_ms2.norm();
  dt = std::min(dt, def.courant * def.spacing_m / fastest);
  if (wall > 0) dt = std::min(dt, kWallCourant * def.spacing_m / wall);
  dt = std::max(dt * stepShare, kShortestStep_s);
  return lastStep_s = longest_s / std::ceil(longest_s / dt - 1e-9);  // equal steps, no sliver
}

void Solver::Impl::chooseSound(double speed_ms) {
  Wcsph::Scales s{.speed_ms = speed_ms,
                  .bodyForce_ms2 = def.gravity_ms2.norm(),
                  .viscosity_m2s = apparentViscosity_Pas(def.fluid, speed_ms / def.spacing_m) /
                                   def.fluid.density_kgm3,
                  .spacing_m = def.spacing_m};
  double low = INFINITY, high = -INFINITY;
  for (std::size_t i = 0; i < active.size(); ++i) {
    if (!active[i] || s.bodyForce_ms2 == 0) continue;
    const double h = particles.positions[i].dot(def.gravity_ms2) / s.bodyForce_ms2;
    low = std::min(low, h);
    high = std::max(high, h);
  }
  s.depth_m = std::max(0.0, high - low) + def.spacing_m;
  wcsph.chooseSound(s, lastStep_s);
}

// A particle must not outrun the contacts it knows.
int Solver::Impl::clampSpeeds(double dt_s) {
  const double limit = kLongestMove * def.spacing_m / dt_s;
  int clamped = 0;
  for (Vec3& v : particles.velocities) {
    const double speed = v.norm();
    if (speed <= limit) continue;
    v *= limit / speed;
    ++clamped;
  }
  return clamped;
}

// The projections of DFSPH, with gravity and viscosity between them.
void Solver::Impl::project(double dt_s, Substep& report) {
  std::vector<Vec3>& v = particles.velocities;
  const Flow flow{neighbours, walls, pool};
  projection.prepare(flow, {});
  report.rate = projection.divergenceFree(flow, particles.densityRatio, dt_s, v);
  for (std::size_t i = 0; i < v.size(); ++i)
    if (active[i]) v[i] += dt_s * def.gravity_ms2;
  // Friction acts on gravity and the last pressure together (incremental projection, Guermond et
  // al. 2006, sec. 3.2). On gravity alone walls would carry a share of it every step and pressure
  // only the rest: 6 % too little in a 10 mm wide column of 1 Pa.s at steps of 1 ms, half or less
  // in a squeezed gap with 12 nu dt / h^2 = 1.
  // Not in full rooms: their pressures flicker with every layer that slides over another, and
  // friction would spread that (power law between plates: 2 % without, 11 % with it).
  if (!def.full) projection.pushByLastPressure(flow, dt_s, v);
  report.viscosityIterations = viscosity
                                   .apply(flow, def.fluid, {.override_Pas = settlingViscosity_Pas},
                                          dt_s, kernel.support_m(), v)
                                   .iterations;
  if (settlingViscosity_Pas == 0) projection.prepare(flow, viscosity.wallDrag());
  if (!def.full) projection.pushByLastPressure(flow, -dt_s, v);
  report.density = projection.constantDensity(flow, particles.densityRatio, dt_s, v);
  projection.stress_m2s2(flow, particles.pressure_Pa);
  for (double& p : particles.pressure_Pa) p *= def.fluid.density_kgm3;
}

// Pressure of the equation of state and viscosity, both explicit.
void Solver::Impl::pushExplicitly(double dt_s, Substep& report) {
  const Flow flow{neighbours, walls, pool};
  wcsph.kick(flow, contacts, def.gravity_ms2, def.spacing_m, def.fluid.density_kgm3, dt_s,
             particles.velocities, particles.pressure_Pa);
  const double least_Pas =
      def.fluid.density_kgm3 * wcsph.leastViscosity_m2s(kernel.support_m() / 2);
  report.viscosityIterations =
      viscosity
          .apply(flow, def.fluid, {.leastPair_Pas = least_Pas, .explicitWhereStable = true}, dt_s,
                 kernel.support_m(), particles.velocities)
          .iterations;
}

// Settling is by projections with both solvers: it ends at rest sooner, and both start from the
// same places.
Solver::Impl::Substep Solver::Impl::substep(double dt_s) {
  Substep report;
  if (compressible())
    pushExplicitly(dt_s, report);
  else
    project(dt_s, report);
  move(dt_s, report);
  measure(report);
  return report;
}

void Solver::Impl::move(double dt_s, Substep& report) {
  std::vector<Vec3>& v = particles.velocities;
  report.clamped = clampSpeeds(dt_s);
  carried.resize(v.size());
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (particles.state[i] == State::swallowed) continue;
    const Vec3 wall_ms = contacts[i].empty() ? v[i] : contacts[i][0].velocity;
    carried[i] = {particles.positions[i] + dt_s * wall_ms, wall_ms};
    if (particles.state[i] == State::film) v[i] = filmVelocity_ms(static_cast<int>(i));
    clampVelocity(contacts[i], def.spacing_m, dt_s, v[i]);
    if (!v[i].allFinite()) {  // said by checkStep; until then it must not get into the grids
      v[i].setZero();
      report.broken = true;
    }
    report.maxSpeed_ms = std::max(report.maxSpeed_ms, v[i].norm());
    particles.positions[i] += dt_s * v[i];
  }
  report.rescued = meetWalls(time_s + (frozen ? 0 : dt_s));
}

void Solver::Impl::measure(Substep& s) {
  double mean = 0, taking = 0;
  for (std::size_t i = 0; def.full && i < active.size(); ++i) {
    mean += active[i] ? particles.densityRatio[i] : 0;
    taking += active[i];
  }
  mean /= std::max(taking, 1.0);
  for (std::size_t i = 0; i < active.size(); ++i) {
    if (!active[i]) continue;
    const double error = std::max(0.0, particles.densityRatio[i] - (def.full ? mean : 1));
    ++s.fluidCount;
    s.meanError += error;
    s.aboveTenPercent += error > 0.1;
    if (error > s.maxError || s.worst < 0) {
      s.maxError = error;
      s.worst = static_cast<int>(i);
    }
  }
  if (s.fluidCount > 0) s.meanError /= s.fluidCount;
  // a few particles on their way to being film are no reason
  const double weight = std::min(1.0, 10.0 * s.fluidCount / static_cast<double>(active.size()));
  const bool rough = def.adaptsStep && !compressible() &&
                     (weight * s.meanError > kMeanError || s.maxError > kPeakError);
  stepShare =
      rough ? std::max(kLeastShare, stepShare * kShorten) : std::min(1.0, stepShare * kLengthen);
}
}  // namespace swallowclip::bolus
