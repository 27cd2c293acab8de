// SPDX-License-Identifier: MIT
// The bolus: smoothed particles carried by the moving walls (thesis 4.2-4.3; DESIGN 5). SI units.
//   Solver s(def, motion, threads);  s.seed(t0, range);  s.relax(t0);  s.advanceTo(t) per frame
// Particle k is the same one for ever; nothing is deleted. One-way coupling.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bolus/coating.h"
#include "bolus/fluid.h"
#include "bolus/kernels.h"
#include "bolus/seeding.h"
#include "bolus/wall_motion.h"
#include "core/error.h"

namespace swallowclip::bolus {

/// 621 particles of (2 mm)^3 are called 5 mL (thesis 4.3, table 4.2): this share of the nominal.
inline constexpr double kFilledShare = 621 * 8e-9 / 5e-6;

enum class SolverKind { dfsph, wcsph };
const char* name(SolverKind kind);
Result<SolverKind> solverFromName(std::string_view word);

struct BolusDef {
  Fluid fluid;
  double spacing_m = 2e-3;  ///< thesis 4.3: 621 particles for 5 mL
  double volume_m3 = 5e-6;  ///< nominal
  Vec3 gravity_ms2 = {0, 0, -9.81};
  KernelKind kernel = KernelKind::cubicSpline;
  SolverKind solver = SolverKind::dfsph;
  double swallowedAt_s_m = 0.180;  ///< end of the UES (DESIGN 2)
  /// Length of the domain along each axis where it repeats, 0 where it does not. Particles live in
  /// [0, period); walls must reach a kernel support beyond both ends (verification cases).
  Vec3 period_m = Vec3::Zero();
  bool slip = false;  ///< walls without friction
  /// The room is full, there is no free surface: pressure is known but for a constant and may be
  /// negative, and density is compared with its mean (a sheared lattice sums to more than one).
  bool full = false;
  /// Steps shorten while they leave compression (bolus/substep.cpp); off: never.
  bool adaptsStep = true;
  double longestStep_s = 1e-3;  ///< DESIGN 5
  double courant = 0.4;         ///< spacings per step at the fastest particle, DESIGN 5
  double densityTolerance = 1e-4, rateTolerance = 3e-4;  ///< mean compression left, assumed
  double solveShare = 5e-4;                              ///< Tolerances::share

  /// 621 at 2 mm for the nominal 5 mL, as the thesis has it (4.968 mL).
  int particleCount() const;
  std::string validate() const;  ///< "" or what is wrong
};

/// coating: it has lent all of its volume to the walls (bolus/coating.h) and lies where it did so.
enum class State : std::uint8_t { fluid = 0, film = 1, swallowed = 2, coating = 3 };
/// Takes no part in anything any more, or for now.
constexpr bool isGone(State s) {
  return s == State::swallowed || s == State::coating;
}

/// Flat arrays of one length.
struct Particles {
  std::vector<Vec3> positions, velocities;
  std::vector<double> densityRatio;  ///< rho / rho0
  std::vector<double>
      pressure_Pa;  ///< above that of the air; mean over the last advanceTo (wcsph: last step).
                    ///< What surface tension's attraction transmits is part of it.
  std::vector<State> state;
  std::vector<double> s_m;           ///< path coordinate of the nearest skin point
  std::vector<std::uint8_t> branch;  ///< WallMotion::branch of the nearest skin vertex
};

/// Over all substeps of advanceTo since relax; density errors are compression, film apart.
struct Stats {
  double meanDensityError = 0, maxDensityError = 0;
  double shareAboveTenPercent = 0;  ///< particle-steps with an error above 10 %
  double maxSpeed_ms = 0;
  std::int64_t steps = 0, densityIterations = 0, rateIterations = 0, viscosityIterations = 0;
  std::int64_t clamped = 0;  ///< particle-steps slowed to half a spacing per step
  std::int64_t rescued = 0;  ///< particle-steps brought back from behind a wall
  double leftInSlits = 0;    ///< particles that closing slits would have shot out in the last 20 ms
  std::int32_t escaped = 0;  ///< most ever found outside at an end of frame; must be 0
};

struct StepReport {
  int substeps = 0;
  double meanDensityError = 0, maxDensityError = 0;  ///< of the last substep
};
struct RelaxReport {
  double time_s = 0, meanDensityError = 0;
  double maxDrift_ms = 0, meanDrift_ms = 0;  ///< net motion over the last 50 ms
  bool atRest = false;
};
/// Particle counts; they always add up to start. Escaped ones are counted in their state too.
struct Ledger {
  std::int32_t start = 0, fluid = 0, film = 0, swallowed = 0, escaped = 0, coating = 0;
  /// Volumes: of all particles at the start; of what they have not lent; on the walls. The last two
  /// always add up to the first.
  double start_m3 = 0, particles_m3 = 0, swallowed_m3 = 0, coating_m3 = 0;
};

class Solver {
 public:
  /// `motion` must outlive the solver. `threads` changes speed, never results.
  Solver(const BolusDef& def, const WallMotion& motion, int threads);
  ~Solver();
  Solver(Solver&&) noexcept;

  /// Fills the held lumen at t with exactly def.particleCount() particles.
  Result<void> seed(double t_s, const SeedRange& range);
  /// Starts from given places instead (tests, verification).
  Result<void> place(double t_s, std::vector<Vec3> positions, std::vector<Vec3> velocities = {});
  /// Puts particles that stand on a lattice into disorder, as fluid is: each is moved by up to a
  /// third of a spacing, then they shift apart until they lie evenly. A lattice that a flow
  /// stretches resists it, and then buckles. Right after seed or place; velocities stay.
  Result<void> mix(double t_s);
  /// Lets the fluid come to rest between the walls as they are at t, frozen, for at most
  /// `longest_s` of simulated time; ends with all velocities zero.
  Result<RelaxReport> relax(double t_s, double longest_s = 1.5);
  /// Substeps up to t. An error names place, time and walls when a pocket cannot hold its fluid.
  Result<StepReport> advanceTo(double t_s);

  double time_s() const;
  const Particles& particles() const;
  const Stats& stats() const;
  Ledger ledger() const;
  double particleVolume_m3() const;
  const Coating& coating() const;
  /// Per skin triangle, over its area of now; empty when the fluid coats nothing.
  std::vector<double> coatingThickness_m() const;
  /// All that the next step depends on, for a solver of the same definition and motion.
  std::string save() const;
  /// Goes on where save() was called, to the bit. Errors when the bytes are damaged or belong to
  /// another bolus; the solver is then as new.
  Result<void> restore(std::string_view bytes);
  std::uint64_t digest() const;  ///< of positions, velocities and states

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace swallowclip::bolus
