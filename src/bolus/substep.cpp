// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include "bolus/solver_impl.h"

namespace swallowclip::bolus {
namespace {
constexpr double kShortestStep_s = 5e-6;  // assumed: below it nothing moves any more
constexpr double kWallCourant = 0.05;     // spacings per step at the fastest wall, DESIGN 5
constexpr double kLongestMove = 0.5;      // spacings per step, assumed; contacts reach 0.9
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
// What a closing slit would shoot out faster than this stays there as film: in a slit narrower than
// that share of a spacing a particle alone finds no way out at any speed, and no bolus is seen to
// move half as fast. Both assumed (2 to 3 m/s, 0.6 to 0.8 spacings).
constexpr double kShotOut_ms = 2.5, kShotOutGap = 0.75;
constexpr int kMoveChunk = 64;          // particles per work item
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
  viscosity.forget();
  wcsph.start();
  coating.start(motion->triangles.size(), n);
  lastStep_s = 0;
  projection.tolerances = {def.densityTolerance, def.rateTolerance, def.solveShare};
  projection.full = def.full;
  stats = {};
  errorSum = errorCount = aboveTenCount = infeasible_s = 0;
  stepShare = 1;
  meetWalls(t_s);
  finishFrame();
}

double Solver::Impl::chooseStep_s(double longest_s) {
  double fastest = 0, wall = 0;
  for (std::size_t i = 0; i < active.size(); ++i) {
    if (isGone(particles.state[i])) continue;
    fastest = std::max(fastest, particles.velocities[i].norm());
    if (active[i]) wall = std::max(wall, walls[i].normalSpeed_ms);
  }
  double dt = def.longestStep_s;
  if (compressible() && neighbours.count > 0) {
    chooseSound(std::max(fastest, wall));
    dt = std::min(dt, wcsph.longestStep_s(kernel.support_m() / 2));
  }
  if (tension) dt = std::min(dt, tension->longestStep_s());
  fastest += dt * def.gravity_ms2.norm();
  dt = std::min(dt, std::min(def.courant, kLongestMove) * def.spacing_m / fastest);
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

bool Solver::Impl::outruns(double dt_s, const Vec3& velocity) const {
  return velocity.norm() > kLongestMove * def.spacing_m / dt_s;
}

// A particle must not outrun the contacts it knows.
int Solver::Impl::clampSpeeds(double dt_s, std::vector<Vec3>& velocities) const {
  int clamped = 0;
  for (Vec3& v : velocities) {
    if (!outruns(dt_s, v)) continue;
    v *= kLongestMove * def.spacing_m / dt_s / v.norm();
    ++clamped;
  }
  return clamped;
}

// The projections of DFSPH, with gravity and viscosity before them. Velocities become free of
// compression; what density is left above rest moves particles apart without a part in velocity.
void Solver::Impl::project(double dt_s, Substep& report) {
  std::vector<Vec3>& v = particles.velocities;
  const Flow flow{neighbours, walls, pool};
  projection.prepare(flow);
  for (std::size_t i = 0; i < v.size(); ++i)
    if (active[i]) v[i] += dt_s * def.gravity_ms2;
  if (tension) tension->push(dt_s, v);
  // Friction acts on gravity and the last pressure together (incremental projection, Guermond et
  // al. 2006, sec. 3.2). On gravity alone walls would carry a share of it every step and pressure
  // only the rest: 6 % too little in a 10 mm wide column of 1 Pa.s at steps of 1 ms, half or less
  // in a squeezed gap with 12 nu dt / h^2 = 1.
  projection.pushByLastPressure(flow, dt_s, v);
  report.viscosityIterations =
      viscosity
          .apply(flow, def.fluid, {.override_Pas = settlingViscosity_Pas, .slip = def.slip}, dt_s,
                 kernel.support_m(), v)
          .iterations;
  if (settlingViscosity_Pas == 0)
    projection.brake(flow, viscosity.wallDrag());
  else
    projection.brake(flow, {});
  projection.takeLastPressureBack(flow, dt_s, v);
  report.rate = projection.divergenceFree(flow, particles.densityRatio, dt_s, v);
  shifting.shift(flow, particles.densityRatio, def.spacing_m, v, moving);
  report.density = projection.constantDensity(flow, particles.densityRatio, dt_s, moving);
  shifting.carry(flow, dt_s, moving, v);
  projection.stress_m2s2(flow, particles.pressure_Pa);
  // per volume that the particle really has
  for (std::size_t i = 0; i < v.size(); ++i)
    particles.pressure_Pa[i] *= def.fluid.density_kgm3 * particles.densityRatio[i];
  if (tension) tension->addPressure_Pa(particles.densityRatio, particles.pressure_Pa);
}

// A step that speeds a particle up beyond the reach of its contacts is taken again, half as long.
double Solver::Impl::projectInReach(double dt_s, Substep& report) {
  const std::vector<Vec3> before = particles.velocities;
  const std::vector<double> rate = projection.rateWarm(), density = projection.densityWarm();
  const Viscosity::ShearRates shear = viscosity.shearRates();
  for (const double least_s = kShortestRetry * dt_s;; dt_s /= 2) {
    project(dt_s, report);
    const auto outrun = [&](const Vec3& v) { return outruns(dt_s, v); };
    if (dt_s <= std::max(least_s, kShortestStep_s) ||
        (std::ranges::none_of(particles.velocities, outrun) &&
         std::ranges::none_of(moving, outrun)))
      return dt_s;
    particles.velocities = before;
    projection.rateWarm() = rate;
    projection.densityWarm() = density;
    viscosity.shearRates() = shear;
  }
}

// Pressure of the equation of state and viscosity, both explicit.
void Solver::Impl::pushExplicitly(double dt_s, Substep& report) {
  const Flow flow{neighbours, walls, pool};
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
    tension->measure({neighbours, walls, pool}, particles.positions, active,
                     {wallTriangles, wallPositions, wallVelocities, skipped, field}, def.period_m);
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
  report.clamped = clampSpeeds(dt_s, v) + clampSpeeds(dt_s, moving);
  const int n = static_cast<int>(v.size());
  carried.resize(n);
  std::vector<std::pair<double, bool>> parts((n + kMoveChunk - 1) / kMoveChunk);
  pool.forChunks(n, kMoveChunk, [&](int begin, int end, int chunk) {
    auto& [fastest, broken] = parts[chunk];
    for (int i = begin; i < end; ++i) {
      if (isGone(particles.state[i])) continue;
      const Vec3 wall_ms = contacts[i].empty() ? v[i] : contacts[i][0].velocity;
      carried[i] = {particles.positions[i] + dt_s * wall_ms, wall_ms};
      if (particles.state[i] == State::film) v[i] = moving[i] = filmVelocity_ms(i);
      clampVelocity(contacts[i], gap_m[i], def.spacing_m, dt_s, v[i]);
      clampVelocity(contacts[i], gap_m[i], def.spacing_m, dt_s, moving[i]);
      if (!v[i].allFinite() ||
          !moving[i].allFinite()) {  // said by checkStep; until then it must not get into the grids
        v[i].setZero();
        moving[i].setZero();
        broken = true;
      }
      fastest = std::max(fastest, v[i].norm());
      particles.positions[i] += dt_s * moving[i];
    }
  });
  for (const auto& [fastest, broken] : parts) {
    report.maxSpeed_ms = std::max(report.maxSpeed_ms, fastest);
    report.broken = report.broken || broken;
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
