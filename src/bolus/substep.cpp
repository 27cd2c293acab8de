// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include "bolus/solver_impl.h"

namespace swallowclip::bolus {
namespace {
constexpr double kShortestStep_s = 5e-6;  // assumed: below it nothing moves any more
constexpr double kWallCourant = 0.05;     // spacings per step at the fastest wall, DESIGN 5
// Spacings per step. Contacts reach 0.9: who did not know a wall ends 0.2 before it, and half of
// the 0.4 that is kept there is the longest push. Assumed (0.5 to 0.7).
constexpr double kLongestMove = 0.7;
// Pressure and viscosity act one after the other, which leaves compression behind where a thick
// fluid is squeezed: 5 Pa.s at 2 mm, 2.8 / 0.5 / 0.2 per mille on average at 0.6 / 0.25 / 0.125 ms.
// So a step that leaves more than this shortens the next one, and quiet ones lengthen it again.
constexpr double kMeanError = 1.5e-3,
                 kPeakError = 0.045;  // assumed (a half and a third of what is allowed)
constexpr double kShorten = 0.7, kLengthen = 1.04;  // assumed
constexpr double kLeastShare = 1.0 / 16;            // of the step otherwise chosen, assumed
// A relaxed fluid's kernel sums are this much larger than those of a cubic lattice with as many
// particles per volume: measured in columns at rest, which else stand 1.5 % too tall. A room that
// is full feels only differences, and an equation of state has its own compression.
constexpr double kRelaxedSum = 1.015;
constexpr double kShortestRetry = 1.0 / 64;  // of a step that is taken again, assumed (1/64 to 1/4)
// While steps are limited so, the next one aims at this share of what contacts reach, and grows no
// faster. Assumed (0.8 to 0.95, 1.02 to 1.1): a dropped block takes 10 of 975 steps twice at 0.93,
// and steps that grow faster leave twice the compression where it lands.
constexpr double kReachAim = 0.93, kReachGrowth = 1.05;
// What a closing slit would shoot out faster than this stays there as film: in a slit narrower than
// that share of a spacing a particle alone finds no way out at any speed, and no bolus is seen to
// move half as fast. Both assumed (2 to 3 m/s, 0.6 to 0.8 spacings).
constexpr double kShotOut_ms = 2.5, kShotOutGap = 0.75;
// Places are put right by no more than this in a step. Two particles that have come close have next
// to no gradient between them, and a solve that is linear throws one of them half a spacing, onto
// others: single ones were 20 % too dense at 1 mm then, with this 9 %, and steps are longer. The
// rest follows in the next steps. Assumed (0.15 to 0.3; with 0.1 a yielding fluid seizes now and
// then and comes out 5 % slow).
constexpr double kLongestCorrection = 0.2;  // spacings
constexpr int kMoveChunk = 64;              // particles per work item
constexpr int kLookAlone = 4000;            // are looked at sooner than a thread wakes, assumed
constexpr double kFilmThickness = 0.1;  // spacings, assumed (0.05 to 0.3): how thick a film drains

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
      volume_m3(std::pow(d.spacing_m, 3) /
                ((d.full || d.solver == SolverKind::wcsph ? 1 : kRelaxedSum) *
                 kernel.latticeSum(d.spacing_m))),
      coating(d.fluid, d.gravity_ms2.norm(), d.spacing_m),
      filmDrainage_s(
          drainagePerAcceleration_s(d.fluid, kFilmThickness * d.spacing_m, d.gravity_ms2.norm())) {
  if (d.fluid.surfaceTension_Nm > 0) tension.emplace(d.fluid, kernel, d.spacing_m);
}

void Solver::Impl::start(double t_s, std::vector<Vec3> places, std::vector<Vec3> velocities) {
  const std::size_t n = places.size();
  number.clear();
  wallsStood = false;
  outside = {};
  particles.positions = std::move(places);
  particles.velocities = std::move(velocities);
  particles.velocities.resize(n, Vec3::Zero());
  particles.pressure_Pa.assign(n, 0.0);
  particles.densityRatio.assign(n, 1.0);
  particles.state.assign(n, State::fluid);
  particles.s_m.assign(n, 0.0);
  particles.branch.assign(n, 0);
  contacts.assign(n, {});
  gap_m.assign(n, INFINITY);
  walls.assign(n, {});
  held.assign(n, {});
  contactsAt.assign(n, Vec3::Constant(INFINITY));
  active.assign(n, 1);
  lastNearest.assign(n, -1);
  projection.resize(static_cast<int>(n));
  shifting.resize(static_cast<int>(n));
  viscosity.forget();
  wcsph.start();
  if (tension) tension->start(static_cast<int>(n));
  coating.start(motion->triangles.size(), n);
  lastStep_s = 0;
  projection.tolerances = {def.densityTolerance, def.rateTolerance, def.solveShare};
  projection.full = def.full;
  stats = {};
  errorSum = errorCount = aboveTenCount = infeasible_s = 0;
  stepShare = 1;
  reach_s = INFINITY;
  meetWalls(t_s);
  finishFrame();
}

// The largest of term(0 .. n - 1), or 0.
template <class Term>
double Solver::Impl::largest(int n, Term&& term) const {
  std::vector<double> parts((n + kMoveChunk - 1) / kMoveChunk);
  pool.forChunks(
      n, kMoveChunk,
      [&](int begin, int end, int chunk) {
        for (int i = begin; i < end; ++i) parts[chunk] = std::max(parts[chunk], term(i));
      },
      kLookAlone);
  return parts.empty() ? 0 : std::ranges::max(parts);
}

double Solver::Impl::chooseStep_s(double longest_s) {
  const double fastest2 = largest(static_cast<int>(active.size()), [&](int i) {
    return isGone(particles.state[i]) ? 0 : particles.velocities[i].squaredNorm();
  });
  const Flow f = flow();
  const double wall = fastestWall_ms == 0 ? 0 : largest(f.count(), [&](int slot) {
    return f.wall(slot).normalSpeed_ms;
  });
  double fastest = std::sqrt(fastest2);
  double dt = def.longestStep_s;
  if (compressible() && neighbours.count > 0) {
    chooseSound(std::max(fastest, wall));
    dt = std::min(dt, wcsph.longestStep_s(kernel.support_m() / 2));
  }
  if (tension)
    dt = std::min(
        dt, tension->longestStep_s(settlingViscosity_Pas > 0 ? settlingViscosity_Pas
                                                             : leastViscosity_Pas(def.fluid)));
  fastest += dt * def.gravity_ms2.norm();
  dt = std::min(dt, std::min(def.courant, kLongestMove) * def.spacing_m / fastest);
  if (wall > 0) dt = std::min(dt, kWallCourant * def.spacing_m / wall);
  dt = std::max(std::min(dt * stepShare, reach_s), kShortestStep_s);
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

bool Solver::Impl::outruns(double dt_s, const Vec3& velocity) const {
  const double most_ms = kLongestMove * def.spacing_m / dt_s;
  return velocity.squaredNorm() > most_ms * most_ms;
}

// A particle must not outrun the contacts it knows. Returns whether it would have.
bool Solver::Impl::clampSpeed(double dt_s, Vec3& velocity) const {
  if (!outruns(dt_s, velocity)) return false;
  velocity *= kLongestMove * def.spacing_m / dt_s / velocity.norm();
  return true;
}

// The projections of DFSPH, with gravity and viscosity before them. Velocities become free of
// compression; what density is left above rest moves particles apart without a part in velocity.
void Solver::Impl::project(double dt_s, Substep& report) {
  std::vector<Vec3>& v = particles.velocities;
  const Flow flow = this->flow();
  const bool settling = settlingViscosity_Pas > 0;
  std::fill(particles.pressure_Pa.begin(), particles.pressure_Pa.end(), 0.0);
  Viscosity::Step viscous{
      flow,
      def.fluid,
      {.override_Pas = settlingViscosity_Pas, .slip = def.slip, .full = def.full},
      dt_s,
      kernel.support_m(),
      v};
  projection.prepare(flow);
  viscosity.begin(viscous);
  shifting.begin(flow, moving);
  if (tension) tension->push(dt_s, v);
  // Friction acts on gravity and the last pressure together (incremental projection, Guermond et
  // al. 2006, sec. 3.2). On gravity alone walls would carry a share of it every step and pressure
  // only the rest: 6 % too little in a 10 mm wide column of 1 Pa.s at steps of 1 ms, half or less
  // in a squeezed gap with 12 nu dt / h^2 = 1.
  Projection::Friction friction;
  if (!settling)
    friction = {viscosity.wallDrag(), viscosity.viscosity_Pas(), def.fluid.density_kgm3};
  flow.sweep([&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) v[flow.particle(i)] += dt_s * def.gravity_ms2;
    projection.pushByLastPressure(flow, dt_s, v, begin, end);
    viscosity.prepare(viscous, begin, end);
    projection.brake(flow, friction, begin, end);
  });
  report.viscosityIterations = viscosity.exchange(viscous).iterations;
  const auto takeBack = [&](int begin, int end) {
    projection.takeLastPressureBack(flow, dt_s, v, begin, end);
  };
  const bool together = viscous.constant_Pas > 0;  // no rate of shear has to be looked for between
  flow.sweep([&](int begin, int end, int) {
    viscosity.rub(viscous, begin, end);
    if (together) takeBack(begin, end);
  });
  viscosity.end(viscous);
  if (!together) flow.sweep([&](int begin, int end, int) { takeBack(begin, end); });
  report.rate = projection.divergenceFree(
      flow, particles.densityRatio, dt_s, v,
      [&](int begin, int end) { shifting.look(flow, particles.densityRatio, v, begin, end); });
  shifting.shift(flow, {dt_s, def.spacing_m, mixing}, v, moving, viscosity.endSlopes_s(),
                 [&](int begin, int end) { projection.startFrom(flow, moving, begin, end); });
  report.density = projection.constantDensity(flow, particles.densityRatio, dt_s, moving);
  report.density.iterations += makeRoom(flow, dt_s);
  const double spacing_ms = def.spacing_m / dt_s;
  flow.sweep([&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      const int p = flow.particle(i);
      Vec3 correction = shifting.calm(p, (moving[p] - v[p]) / spacing_ms);
      correction *= kLongestCorrection / std::max(kLongestCorrection, correction.norm());
      moving[p] = v[p] + spacing_ms * correction;
      reached[i] = static_cast<float>(std::max(v[p].squaredNorm(), moving[p].squaredNorm()));
      particles.pressure_Pa[p] =  // per volume that the particle really has
          projection.stress_m2s2(flow, i) * def.fluid.density_kgm3 * particles.densityRatio[p];
    }
  });
  if (tension) tension->addPressure_Pa(particles.densityRatio, particles.pressure_Pa);
}

// A step that speeds a particle up beyond the reach of its contacts is taken again, half as long,
// and those after it know.
double Solver::Impl::projectInReach(double dt_s, Substep& report) {
  kept.velocities = particles.velocities;
  kept.rate = projection.rateWarm();
  kept.density = projection.densityWarm();
  kept.shear = viscosity.shear();
  kept.waiting = viscosity.waiting();
  reached.assign(neighbours.count, 0);
  for (const double least_s = std::max(kShortestRetry * dt_s, kShortestStep_s);;) {
    project(dt_s, report);
    float fastest2 = 0;
    for (const float v2 : reached)
      if (v2 > fastest2) fastest2 = v2;  // not where it is no number: checkStep says so
    const double share = std::sqrt(fastest2) * dt_s / (kLongestMove * def.spacing_m);
    if (dt_s <= least_s || share <= 1) {
      const double next_s = share > 0 ? dt_s * kReachAim / share : INFINITY;
      reach_s = std::clamp(next_s, reach_s / 2, kReachGrowth * reach_s);
      if (reach_s > def.longestStep_s) reach_s = INFINITY;
      viscosity.accept(flow());
      shifting.accept();
      return dt_s;
    }
    reach_s = dt_s;
    dt_s /= 2;
    particles.velocities = kept.velocities;
    projection.rateWarm() = kept.rate;
    projection.densityWarm() = kept.density;
    viscosity.shear() = kept.shear;
    viscosity.waiting() = kept.waiting;
  }
}

// Pressure of the equation of state and viscosity, both explicit.
void Solver::Impl::pushExplicitly(double dt_s, Substep& report) {
  const Flow flow = this->flow();
  if (tension) tension->push(dt_s, particles.velocities);
  wcsph.kick(flow, contacts, def.gravity_ms2, def.spacing_m, def.fluid.density_kgm3, dt_s,
             particles.velocities, particles.pressure_Pa);
  if (tension) tension->addPressure_Pa(particles.densityRatio, particles.pressure_Pa);
  const double least_Pas =
      def.fluid.density_kgm3 * wcsph.leastViscosity_m2s(kernel.support_m() / 2);
  report.viscosityIterations =
      viscosity
          .apply(flow, def.fluid,
                 {.leastPair_Pas = least_Pas, .explicitWhereStable = true, .slip = def.slip}, dt_s,
                 kernel.support_m(), particles.velocities)
          .iterations;
}

// Settling is by projections with both solvers: it ends at rest sooner, and both start from the
// same places.
Solver::Impl::Substep Solver::Impl::substep(double dt_s) {
  Substep report;
  if (tension)
    tension->measure(
        flow(), particles.positions, active,
        {wallTriangles, wallPositions, wallVelocities, skipped, field, time_s, fastestWall_ms},
        def.period_m);
  if (compressible())
    pushExplicitly(dt_s, report), moving = particles.velocities;
  else
    dt_s = projectInReach(dt_s, report);
  report.length_s = lastStep_s = dt_s;
  move(dt_s, report);
  coatWalls(report);
  measure(report);
  return report;
}

void Solver::Impl::leaveInSlits(double dt_s) {
  stats.leftInSlits *= std::exp(-dt_s / kInfeasibleFor_s);
  for (std::size_t i = 0; i < active.size(); ++i) {
    if (!active[i] || gap_m[i] > kShotOutGap * def.spacing_m) continue;
    const Vec3& v = particles.velocities[i];
    if ((v - contacts[i][0].velocity).norm() < kShotOut_ms && !outruns(dt_s, moving[i])) continue;
    particles.state[i] = State::film;
    active[i] = 0;
    ++stats.leftInSlits;
  }
}

void Solver::Impl::move(double dt_s, Substep& report) {
  std::vector<Vec3>& v = particles.velocities;
  leaveInSlits(dt_s);
  const int n = static_cast<int>(v.size());
  carried.resize(n);
  struct Part {
    double fastest2 = 0;
    int clamped = 0;
    bool broken = false;
  };
  std::vector<Part> parts((n + kMoveChunk - 1) / kMoveChunk);
  pool.forChunks(n, kMoveChunk, [&](int begin, int end, int chunk) {
    Part& part = parts[chunk];
    for (int i = begin; i < end; ++i) {
      if (isGone(particles.state[i])) continue;
      part.clamped += clampSpeed(dt_s, v[i]);
      if (active[i]) part.clamped += clampSpeed(dt_s, moving[i]);
      const Vec3 wall_ms = contacts[i].empty() ? v[i] : contacts[i][0].velocity;
      carried[i] = {particles.positions[i] + dt_s * wall_ms, wall_ms};
      if (particles.state[i] == State::film) v[i] = moving[i] = filmVelocity_ms(i);
      clampVelocity(contacts[i], gap_m[i], def.spacing_m, dt_s, v[i]);
      clampVelocity(contacts[i], gap_m[i], def.spacing_m, dt_s, moving[i]);
      if (!v[i].allFinite() ||
          !moving[i].allFinite()) {  // said by checkStep; until then it must not get into the grids
        v[i].setZero();
        moving[i].setZero();
        part.broken = true;
      }
      part.fastest2 = std::max(part.fastest2, v[i].squaredNorm());
      particles.positions[i] += dt_s * moving[i];
    }
  });
  for (const Part& part : parts) {
    report.maxSpeed_ms = std::max(report.maxSpeed_ms, std::sqrt(part.fastest2));
    report.clamped += part.clamped;
    report.broken = report.broken || part.broken;
  }
  report.rescued = meetWalls(time_s + (frozen ? 0 : dt_s));
}

void Solver::Impl::measure(Substep& s) {
  double rest = 1, sum = 0, most = -1;  // names of their own: through a reference they are slow
  int taking = 0, aboveTen = 0, worst = -1;
  for (std::size_t i = 0; i < active.size(); ++i) taking += active[i];
  if (def.full && taking > 0) {
    for (std::size_t i = 0; i < active.size(); ++i)
      sum += active[i] ? particles.densityRatio[i] : 0;
    rest = sum / taking;
    sum = 0;
  }
  for (std::size_t i = 0; i < active.size(); ++i) {
    if (!active[i]) continue;
    const double error = std::max(0.0, particles.densityRatio[i] - rest);
    sum += error;
    aboveTen += error > 0.1;
    if (error > most) {
      most = error;
      worst = static_cast<int>(i);
    }
  }
  s.fluidCount = taking;
  s.meanError = taking > 0 ? sum / taking : 0;
  s.maxError = std::max(0.0, most);
  s.worst = worst;
  s.aboveTenPercent = aboveTen;
  // a few particles on their way to being film are no reason
  const double weight = std::min(1.0, 10.0 * s.fluidCount / static_cast<double>(active.size()));
  const bool rough = def.adaptsStep && !compressible() &&
                     (weight * s.meanError > kMeanError || s.maxError > kPeakError);
  stepShare =
      rough ? std::max(kLeastShare, stepShare * kShorten) : std::min(1.0, stepShare * kLengthen);
}
}  // namespace swallowclip::bolus
