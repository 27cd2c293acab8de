// SPDX-License-Identifier: MIT
// The two projections of DFSPH (Bender & Koschier 2015), written with rho* = rho / rho0 and the
// kinematic pressure k = p / rho0 (m^2/s^2); a wall gives back a share m of the particle's own:
//   a_i = (-V sum (k_i + k_j) gradW_ij - m k_i grad lambda_i) / (1 + drag_i)
//   D_i(v) = V sum (v_i - v_j).gradW_ij + v_i.grad lambda_i - flux_i
// solved by relaxed Jacobi with k >= 0 (Ihmsen et al. 2014). Walls enter nowhere else.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "bolus/neighbours.h"
#include "bolus/wall_field.h"

namespace swallowclip::bolus {

/// What a substep's solvers look at; arrays of one length, valid while the step lasts.
struct Flow {
  const std::vector<Vec3>& positions;
  const std::vector<std::uint8_t>& active;  ///< 1 for particles that take part
  const Neighbours& neighbours;
  const std::vector<WallSample>& walls;
  double volume_m3;  ///< particle volume in kernel sums
  ThreadPool& pool;
};

inline constexpr int kSweepChunk = 128;  ///< particles per work item of a neighbour sweep

struct ProjectionReport {
  int iterations = 0;
  bool atCap = false;
  double meanError = 0;  ///< mean compression left, share of rho0
};

class Projection {
 public:
  /// Removes compression rate where rho* would pass one; `velocities` in and out.
  ProjectionReport divergenceFree(const Flow& flow, const std::vector<double>& densityRatio,
                                  double dt_s, std::vector<Vec3>& velocities);
  /// Makes the density at the end of the step at most rho0.
  ProjectionReport constantDensity(const Flow& flow, const std::vector<double>& densityRatio,
                                   double dt_s, std::vector<Vec3>& velocities);
  /// Before each projection: the diagonal. `wallDrag` ([particle], dt times the rate at which walls
  /// brake it; empty: none) lets pressure move a particle only as far as the walls' friction allows
  /// within the step: a_i / (1 + drag_i), the implicit Brinkman term. Without it a narrow slit is
  /// squeezed out as if the fluid had no viscosity.
  void prepare(const Flow& flow, std::span<const double> wallDrag);
  void resize(int particles);

 private:
  ProjectionReport solve(const Flow& flow, double dt_s, int cap, double tolerance,
                         std::vector<double>& k);
  void accelerate(const Flow& flow, const std::vector<double>& k);

  std::vector<double> mobility_;  // 1 / (1 + drag)
  std::vector<double> diagonal_, source_, densityK_, rateK_, next_;
  std::vector<Vec3> acceleration_;
};

/// Rate of rho* (1/s) of each active particle.
void densityRate(const Flow& flow, const std::vector<Vec3>& velocities, std::vector<double>& rate);
}  // namespace swallowclip::bolus
