// SPDX-License-Identifier: MIT
#include "bolus/solver.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "bolus/solver_impl.h"
#include "core/digest.h"

namespace swallowclip::bolus {
namespace {
constexpr std::array<const char*, 2> kSolverNames{"dfsph", "wcsph"};
constexpr int kMostParticles = 2'000'000;  // what this program is made for, times a hundred
// At rest means drifting, not speed: the projections leave a flicker of about a third of what
// gravity adds in one step (measured: mean 1-3 mm/s), which leads nowhere.
constexpr double kDriftWindow_s = 0.05;  // assumed (0.02 to 0.1)
// Fastest particle and mean over a window, in spacings per second, assumed (1 to 3, 0.2 to 0.5). A
// column of 1 Pa.s that still sinks by 5 and 1 has 2.8 % too much pressure at its floor; then 0.8.
constexpr double kRestDrift = 1.5, kRestMeanDrift = 0.4;
constexpr double kInfeasibleError = 0.02;  // mean compression, DESIGN 5
// Nor may it squirt more than this share of the bolus out through slits in that time, assumed
// (3 to 10 %).
constexpr double kMostLeftInSlits = 0.08;
// At its cap the density solve counts as failing only when it leaves more than this, assumed
// (0.2 to 1 %): slow convergence of thin layers is harmless.
constexpr double kCapError = 0.005;
constexpr double kCrossing_m = 0.5e-3;  // sheets of the skin may cross by this much (motion tests)
}  // namespace

const char* name(SolverKind kind) {
  return kSolverNames[static_cast<int>(kind)];
}

Result<SolverKind> solverFromName(std::string_view word) {
  for (std::size_t k = 0; k < kSolverNames.size(); ++k)
    if (word == kSolverNames[k]) return static_cast<SolverKind>(k);
  return usageError("solver", fmt::format("no solver is named '{}'", word), "use dfsph or wcsph");
}

int BolusDef::particleCount() const {
  return static_cast<int>(std::lround(kFilledShare * volume_m3 / std::pow(spacing_m, 3)));
}

std::string BolusDef::validate() const {
  if (const std::string bad = fluid.validate(); !bad.empty()) return bad;
  if (!(spacing_m >= 2e-4 && spacing_m <= 1e-2))
    return fmt::format("spacing_m is {}, expected 0.0002 to 0.01", spacing_m);
  if (!(volume_m3 > 0 && volume_m3 < 1e-3))
    return fmt::format("volume_m3 is {}, expected above 0 and below 0.001", volume_m3);
  if (!gravity_ms2.allFinite()) return "gravity_ms2 is not finite";
  if (const double n = kFilledShare * volume_m3 / std::pow(spacing_m, 3);
      !(n >= 1 && n <= kMostParticles))
    return fmt::format("volume and spacing give {:.0f} particles, expected 1 to {}", n,
                       kMostParticles);
  return "";
}

Solver::Solver(const BolusDef& def, const WallMotion& motion, int threads)
    : impl_(std::make_unique<Impl>(def, motion, threads)) {}
Solver::~Solver() = default;
Solver::Solver(Solver&&) noexcept = default;

namespace {
Result<void> checkInputs(const BolusDef& def, const WallMotion& m,
                         const std::vector<Vec3>& positions) {
  if (const std::string bad = def.validate(); !bad.empty())
    return usageError("bolus", bad, "correct the bolus definition");
  if (m.triangles.empty()) return {};  // free space
  const int vertices = static_cast<int>(positions.size());
  for (const Triangle& t : m.triangles)
    for (int v : t)
      if (v < 0 || v >= vertices)
        return usageError("skin", fmt::format("a triangle names vertex {} of {}", v, vertices),
                          "give a skin whose triangles use its own vertices");
  for (std::size_t size : {m.s_m.size(), m.branch.size(), m.wall.size()})
    if (size != 0 && static_cast<int>(size) != vertices)
      return usageError("skin", fmt::format("{} vertex labels for {} vertices", size, vertices),
                        "give one label per vertex");
  const ManifoldReport report = checkManifold(m.triangles, vertices);
  if (!report.closed())
    return usageError("skin", report.text(), "give a closed surface around the fluid");
  if (volume(positions, m.triangles) <= 0)
    return usageError("skin", "the surface encloses no volume, or faces inwards",
                      "turn its triangles to face out of the lumen");
  return {};
}
}  // namespace

Result<void> Solver::seed(double t_s, const SeedRange& range) {
  Impl& s = *impl_;
  s.motion->at(t_s, s.wallPositions, s.wallVelocities);
  if (auto ok = checkInputs(s.def, *s.motion, s.wallPositions); !ok) return ok;
  auto places = seedPlaces(*s.motion, s.wallPositions, s.def.gravity_ms2, range, s.def.spacing_m,
                           s.def.particleCount());
  if (!places) return std::unexpected(places.error());
  s.start(t_s, std::move(*places));
  return {};
}

Result<void> Solver::place(double t_s, std::vector<Vec3> positions, std::vector<Vec3> velocities) {
  Impl& s = *impl_;
  s.motion->at(t_s, s.wallPositions, s.wallVelocities);
  if (auto ok = checkInputs(s.def, *s.motion, s.wallPositions); !ok) return ok;
  if (!velocities.empty() && velocities.size() != positions.size())
    return usageError(
        "bolus", fmt::format("{} velocities for {} particles", velocities.size(), positions.size()),
        "give one velocity per particle, or none");
  s.start(t_s, std::move(positions), std::move(velocities));
  return {};
}

Result<RelaxReport> Solver::relax(double t_s, double longest_s) {
  Impl& s = *impl_;
  s.frozen = true;
  s.settlingViscosity_Pas = Impl::kSettlingViscosity_Pas;
  s.meetWalls(t_s);
  RelaxReport report;
  Result<void> ok;
  std::vector<Vec3> before = s.particles.positions;
  for (double window_s = 0; report.time_s < longest_s && !report.atRest;) {
    const Impl::Substep step = s.substep(s.chooseStep_s(1e-3));
    const double dt = step.length_s;
    report.time_s += dt;
    report.meanDensityError = step.meanError;
    window_s += dt;
    if (window_s >= kDriftWindow_s) {
      report.maxDrift_ms = report.meanDrift_ms = 0;
      for (std::size_t i = 0; i < before.size(); ++i) {
        const double drift = (s.particles.positions[i] - before[i]).norm() / window_s;
        report.maxDrift_ms = std::max(report.maxDrift_ms, drift);
        report.meanDrift_ms += drift / static_cast<double>(before.size());
      }
      report.atRest = report.maxDrift_ms < kRestDrift * s.def.spacing_m &&
                      report.meanDrift_ms < kRestMeanDrift * s.def.spacing_m;
      before = s.particles.positions;
      window_s = 0;
    }
    // a lattice that starts too dense needs time to spread; only then is the room judged
    if (report.time_s > 0.2 && !(ok = s.checkStep(step, dt))) break;
  }
  s.frozen = false;
  s.settlingViscosity_Pas = 0;
  s.infeasible_s = 0;
  s.forgetWalls();  // those that stood still
  std::fill(s.particles.velocities.begin(), s.particles.velocities.end(), Vec3::Zero());
  s.meetWalls(t_s);
  s.outside = {};
  s.finishFrame();
  if (!ok) return std::unexpected(ok.error());
  if (s.escapedNow > 0)
    return failure(fmt::format("t = {:.4f} s", t_s),
                   fmt::format("{} of {} particles find no place between the walls", s.escapedNow,
                               s.particles.positions.size()),
                   "hold a smaller bolus, or open the held mouth to 1.15 times its volume");
  return report;
}

std::string Solver::Impl::wallsAt(int i) const {
  if (motion->wall.empty() || i < 0 || contacts[i].empty()) return "walls unnamed";
  auto label = [&](const Contact& c) {
    return static_cast<int>(motion->wall[wallTriangles[c.triangle][0]]);
  };
  const int facing = facingContact(contacts[i]);
  if (facing < 0) return fmt::format("wall {}", label(contacts[i][0]));
  return fmt::format("walls {} and {}, {:.2f} mm apart", label(contacts[i][0]),
                     label(contacts[i][facing]), localGap_m(contacts[i]) * 1e3);
}

Result<void> Solver::Impl::checkStep(const Substep& s, double dt_s) {
  const int w = s.worst;
  const std::string where =
      w < 0 ? fmt::format("t = {:.4f} s", time_s)
            : fmt::format("t = {:.4f} s, s = {:.1f} mm", time_s, particles.s_m[w] * 1e3);
  if (s.broken || !std::isfinite(s.meanError) || !std::isfinite(s.maxSpeed_ms))
    return failure(where, "the bolus has a position or velocity that is not a number",
                   "check the skin's positions and velocities at this time");
  // A drop caught between closing sheets is on its way to being film; only a body of fluid without
  // room stops the run, so the mean is taken over a tenth of the bolus at least.
  const double share =
      std::min(1.0, 10.0 * s.fluidCount / static_cast<double>(particles.state.size()));
  const bool bad = share * s.meanError > kInfeasibleError ||
                   (s.density.atCap && share * s.density.meanError > kCapError);
  infeasible_s = bad ? infeasible_s + dt_s : 0;
  const double squirted = stats.leftInSlits / static_cast<double>(particles.state.size());
  if (infeasible_s < kInfeasibleFor_s && squirted <= kMostLeftInSlits) return {};
  const std::string sign =
      infeasible_s < kInfeasibleFor_s
          ? fmt::format("{:.1f} % of the bolus squirts out through slits within {:.0f} ms",
                        squirted * 100, kInfeasibleFor_s * 1e3)
          : fmt::format("mean compression {:.1f} %, worst {:.1f} %", s.meanError * 100,
                        s.maxError * 100);
  return failure(
      where,
      fmt::format("a sealed pocket is smaller than the fluid in it ({}; {})", sign, wallsAt(w)),
      "open these walls later, close them more slowly, or hold a smaller bolus");
}

// Outside the skin, every branch included, by more than its sheets may cross each other.
bool Solver::Impl::escaped(const Vec3& p) const {
  if (columns.inside(p) || windingNumber(p, wallPositions, motion->triangles) >= 0.5) return false;
  return nearestPoint(p, wallPositions, motion->triangles).distance_m > kCrossing_m;
}

void Solver::Impl::finishFrame() {
  updatePath(true);
  columns.build(motion->triangles, wallPositions);
  escapedNow = 0;
  for (std::size_t i = 0; i < active.size(); ++i)
    escapedNow += !isGone(particles.state[i]) && escaped(particles.positions[i]);
  stats.escaped = std::max(stats.escaped, escapedNow);
  findNeighbours();  // here, so that a run that goes on from a checkpoint has the same lists
  if (tension) tension->forgetLists();
}

Result<StepReport> Solver::advanceTo(double t_s) {
  Impl& s = *impl_;
  StepReport report;
  s.outside = {};
  s.stepsUnsorted = 0;
  std::vector<double>& pressure = s.particles.pressure_Pa;
  std::vector<double> sum(pressure.size(), 0.0);
  double length_s = 0;
  while (s.time_s < t_s - 1e-12) {
    const Impl::Substep step = s.substep(s.chooseStep_s(t_s - s.time_s));
    const double dt = step.length_s;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += dt * pressure[i];
    length_s += dt;
    ++report.substeps;
    report.meanDensityError = step.meanError;
    report.maxDensityError = step.maxError;
    Stats& all = s.stats;
    ++all.steps;
    all.densityIterations += step.density.iterations;
    all.rateIterations += step.rate.iterations;
    all.viscosityIterations += step.viscosityIterations;
    all.clamped += step.clamped;
    all.rescued += step.rescued;
    all.maxSpeed_ms = std::max(all.maxSpeed_ms, step.maxSpeed_ms);
    all.maxDensityError = std::max(all.maxDensityError, step.maxError);
    s.errorSum += step.meanError * step.fluidCount;
    s.errorCount += step.fluidCount;
    s.aboveTenCount += step.aboveTenPercent;
    if (s.errorCount > 0) {
      all.meanDensityError = s.errorSum / s.errorCount;
      all.shareAboveTenPercent = s.aboveTenCount / s.errorCount;
    }
    if (auto ok = s.checkStep(step, dt); !ok) return std::unexpected(ok.error());
    s.sortParticles(sum);
  }
  // Every projection takes back what the one before left of compression: single pressures flicker.
  for (std::size_t i = 0; !s.compressible() && length_s > 0 && i < sum.size(); ++i)
    pressure[i] = sum[i] / length_s;
  s.finishFrame();
  return report;
}

double Solver::time_s() const {
  return impl_->time_s;
}
const Particles& Solver::particles() const {
  return impl_->asNumbered();
}
const Stats& Solver::stats() const {
  return impl_->stats;
}
double Solver::particleVolume_m3() const {
  return std::pow(impl_->def.spacing_m, 3);
}
const Coating& Solver::coating() const {
  return impl_->coating;
}
std::vector<double> Solver::coatingThickness_m() const {
  const Impl& s = *impl_;
  std::vector<double> thickness_m = s.coating.volume_m3();
  for (std::size_t k = 0; k < thickness_m.size(); ++k) {
    const Triangle& t = s.motion->triangles[k];
    const Vec3& corner = s.wallPositions[t[0]];
    const Vec3 cross = (s.wallPositions[t[1]] - corner).cross(s.wallPositions[t[2]] - corner);
    if (thickness_m[k] > 0 && cross.norm() > 0) thickness_m[k] /= cross.norm() / 2;
  }
  return thickness_m;
}

Ledger Solver::ledger() const {
  Ledger l;
  const std::vector<State>& states = impl_->particles.state;
  const std::vector<double>& lent_m3 = impl_->coating.lent_m3();
  l.start = static_cast<std::int32_t>(states.size());
  for (std::size_t i = 0; i < states.size(); ++i) {
    const State s = states[i];
    l.fluid += s == State::fluid;
    l.film += s == State::film;
    l.swallowed += s == State::swallowed;
    l.coating += s == State::coating;
    const double own_m3 = particleVolume_m3() - (lent_m3.empty() ? 0 : lent_m3[i]);
    l.start_m3 += particleVolume_m3();
    l.particles_m3 += own_m3;
    if (s == State::swallowed) l.swallowed_m3 += own_m3;
  }
  for (const double volume_m3 : impl_->coating.volume_m3()) l.coating_m3 += volume_m3;
  l.escaped = impl_->escapedNow;
  return l;
}

std::uint64_t Solver::digest() const {
  const Particles& p = particles();
  std::uint64_t d = stateDigest(p.positions.data(), p.positions.size() * sizeof(Vec3));
  d = stateDigest(p.velocities.data(), p.velocities.size() * sizeof(Vec3), d);
  return stateDigest(p.state.data(), p.state.size(), d);
}
}  // namespace swallowclip::bolus
