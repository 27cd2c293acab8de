// SPDX-License-Identifier: MIT
// Implicit viscosity for every fluid, thin or thick: the pairwise Laplacian of Morris, Fox & Zhu
// (1997, eq. 22), with the walls' no-slip friction inside the same matrix-free conjugate gradients:
//   a_i = 2 sum nu_ij V v_ij (x_ij . gradW_ij) / (r^2 + eta^2) - 2 nu_i friction (v_i - v_wall)
// On a cubic lattice it gives 1.01 of the viscosity; the form that also keeps angular momentum
// (Monaghan 2005: 10 v.x / r^2 gradW) gives 0.71 of it with so few neighbours.
#pragma once
#include <vector>

#include "bolus/fluid.h"
#include "bolus/projection.h"

namespace swallowclip::bolus {

class Viscosity {
 public:
  struct Report {
    int iterations = 0;
    bool atCap = false;
  };
  struct Scheme {
    double override_Pas = 0;   ///< above 0: replaces the fluid's law (used while settling)
    double leastPair_Pas = 0;  ///< between particles, not at walls (artificial viscosity, eq. 4.12)
    /// Forward Euler between particles where the step is short enough for it (thesis eq. 4.26);
    /// the walls' friction stays implicit, for it has no least distance.
    bool explicitWhereStable = false;
  };
  /// Viscosities of the moment from the strain rate, then one backward Euler step of `velocities`.
  Report apply(const Flow& flow, const Fluid& fluid, const Scheme& scheme, double dt_s,
               double support_m, std::vector<Vec3>& velocities);

  /// Before a new run.
  void forget() { *this = {}; }

  /// [particle] of the last step: its length times the rate at which walls brake the particle.
  const std::vector<double>& wallDrag() const { return wallDrag_; }

  /// [particle] of the last step, 1/s: what the next one's viscosities follow from.
  std::vector<double>& shearRates_s() { return shearRate_s_; }

  /// [particle] acceleration by the last step's viscosity: where the next solve starts from.
  std::vector<Vec3>& drags_ms2() { return drag_ms2_; }

 private:
  void prepare(const Flow& flow, const Fluid& fluid, double constant_Pas, double dt_s,
               const std::vector<Vec3>& velocities);
  void weighPairs(const Flow& flow, double density_kgm3, double leastPair_Pas, double dt_s,
                  double support_m);
  void findRates(const Flow& flow, const std::vector<Vec3>& velocities);
  static void evenOut(const WallSample& wall, const float* moment, float* even);
  bool isStableExplicitly(const Scheme& scheme, double density_kgm3, double dt_s,
                          double support_m) const;
  Report solve(const Flow& flow, double dt_s, const std::vector<Vec3>& velocities);

  std::vector<double> shearRate_s_;             // [particle] NaN where not yet known
  std::vector<Vec3> drag_ms2_;                  // [particle]
  std::vector<double> wallDrag_;                // [particle]
  std::vector<double> viscosity_, force_;       // [slot]; [slot][3]
  std::vector<float> mu_;                       // [slot + 1]
  Tensors evenness_;                            // [slot + 1]
  std::vector<Vec3> right_;                     // [slot] right side
  std::vector<float> pair_, own_, inverse_;     // [pair]; [slot + 1] 1 + wall drag; [slot] sum of
                                                // the pairs' weights, then 1 / diagonal
  float mostExchanged_ = 0;                     // the largest sum of a slot's weights
  Floats3 v_, residual_, direction_, product_;  // [slot + 1]
};

/// dv_a / dx_b (1/s) at a slot that moves with `velocity`, walls included.
Mat3 velocityGradient_s(const Flow& flow, const SlopeSweep& slopes, const Vec3& velocity, int slot);
/// sqrt(2 D:D) (1/s) of it.
double shearRate_s(const Mat3& velocityGradient_s);
}  // namespace swallowclip::bolus
