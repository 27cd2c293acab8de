// SPDX-License-Identifier: MIT
// Implicit viscosity for every fluid, thin or thick: the pairwise Laplacian of Morris, Fox & Zhu
// (1997, eq. 22), with the walls' no-slip friction inside the same matrix-free conjugate gradients:
//   (1 - lambda_i) a_i = 2 sum nu_ij V v_ij (x_ij . gradW_ij) / (r^2 + eta^2)
//                        - 2 nu_wall friction (v_i - v_wall),
// nu_ij that of the shear rate half way between the two (PairViscositySweep).
// Where stress grows linearly from a wall, the right side is 1 - lambda times its gradient: pairs
// give 2 tau(d) |grad lambda| + (1 - lambda - d |grad lambda|) tau', the wall takes 2 |grad lambda|
// times the stress half way to it, tau(d) - tau' d / 2; so nu_wall is that of the shear rate there.
// On the left, as a share of the particle's inertia, 1 - lambda (the gamma by which Ferrand et al.
// 2013 divide) leaves the system symmetric. Walls that let slip have tau = tau' d and no friction:
// there the right side is 1 - lambda + d |grad lambda|, which is one within a few percent.
// On a cubic lattice it gives 1.01 of the viscosity; forces along the line of centres, which also
// keep angular momentum (Monaghan 2005: 10 v.x / r^2 gradW), give 0.71 of it with so few
// neighbours. That Laplacian is what stress makes of a flow without compression, inside. At a free
// surface it lets du/dn vanish instead of the stress, and so stops a lump of honey that turns. What
// it lacks is div(mu (grad v)^T), and pairs of the same weights c_ij give it, with G = grad v:
//   sum c_ij (v_i - v_j)  becomes  sum c_ij (v_i - v_j + (G_i + G_j)^T x_ij / 2),
// which is zero for each pair of a body that turns as if rigid, so that angular momentum stays. A
// wall that does not let slip has the T = mu G^T of the particle before it: + 2 T_i grad lambda_i.
// G comes from the last steps' velocities, each step's counting as much as all before it. From the
// last step alone a field of pure strain would change its sign every step where mu dt / h^2 is
// large; so it is damped. (wcsph, as in the thesis, goes without.)
#pragma once
#include <cstdint>
#include <span>
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
    bool slip = false;  ///< walls have no friction
    /// No free surface: with one viscosity everywhere the transposed part has no divergence there.
    bool full = false;
  };
  /// Viscosities of the moment from the strain rate, then one backward Euler step of `velocities`.
  Report apply(const Flow& flow, const Fluid& fluid, const Scheme& scheme, double dt_s,
               double support_m, std::vector<Vec3>& velocities);

  /// The same in parts, for who has other work for the same slots: `begin`, `prepare` all slots,
  /// `exchange`, `rub` all slots, `end`.
  struct Step {
    const Flow& flow;
    const Fluid& fluid;
    Scheme scheme;
    double dt_s, support_m;
    std::vector<Vec3>& velocities;
    double constant_Pas = 0;  ///< 0: by the shear rate; `begin` finds it
    double pairs_s = 0;       ///< how long neighbours rub on each other now; 0: not in this step
  };
  void begin(Step& step);
  void prepare(const Step& step, int begin, int end);
  Report exchange(const Step& step);
  void rub(const Step& step, int begin, int end);
  void end(const Step& step);

  /// [slot] dv_a / dx_b (1/s) of the velocities that a step ended with, to be filled by who knows
  /// them; empty where nothing will be asked of them.
  std::span<Mat3f> endSlopes_s() { return endSlopes_s_; }
  /// The step, with these slopes, will not be taken again.
  void accept(const Flow& flow);

  /// Before a new run.
  void forget() { *this = {}; }

  /// [particle] of the last step: its length times the rate at which walls brake the particle.
  const std::vector<double>& wallDrag() const { return wallDrag_; }
  /// [slot] after `prepare`.
  std::span<const double> viscosity_Pas() const { return viscosity_; }

  /// [particle] of the last step: what the next one's viscosities follow from. Empty where
  /// viscosity is constant.
  struct Shear {
    std::vector<double> own_s;   ///< 1/s, at the particle; NAN: not yet known
    std::vector<double> wall_s;  ///< 1/s, half way to its wall
    /// Gradient (1/s) and velocity (m/s), row by row as PairViscositySweep wants them.
    std::vector<Eigen::Matrix<float, 3, 4, Eigen::RowMajor>> field;
    void forget(std::size_t particles);
  };
  Shear& shear() { return shear_; }

  /// Neighbours of a thin fluid that exchange next to nothing in a step do it once in a few, for
  /// all of that time (multiple time steps, Tuckerman et al. 1992).
  struct Waiting {
    double since_s = 0;  ///< how long they have not
    std::int64_t steps = 0;
    double rate_s = 0;  ///< largest share of their velocities per time, 1/s; 0: not known
  };
  Waiting& waiting() { return waiting_; }

  /// [particle] acceleration by the last step's viscosity: where the next solve starts from.
  std::vector<Vec3>& drags_ms2() { return drag_ms2_; }
  /// [particle] dv_a / dx_b (1/s) of the last steps; empty: not known or not asked for.
  std::vector<Mat3f>& slopes_s() { return slopes_s_; }

 private:
  /// Largest sum of a slot's weights; also adds the transposed part to the right side.
  float weighPairs(const Step& step);
  void findRates(const Flow& flow, const std::vector<Vec3>& velocities);
  void look(const Flow& flow, const std::vector<Vec3>& velocities);
  void findSlopes(const Flow& flow, const std::vector<Vec3>& velocities);
  static void evenOut(const WallSample& wall, const float* moment, float* even);
  bool canWait(const Step& step) const;
  bool isStableExplicitly(const Step& step) const;
  static bool knowsTransposed(const Step& step);
  Report solve(const Step& step);
  void addTransposed(const Step& step, int begin, int end);

  Shear shear_;
  Waiting waiting_;
  std::vector<Vec3> drag_ms2_;             // [particle]
  std::vector<Mat3f> slopes_s_;            // [particle]
  std::vector<Mat3f> endSlopes_s_;         // [slot]
  std::vector<double> wallDrag_;           // [particle]
  std::vector<double> viscosity_, force_;  // [slot]; [slot][3]
  std::vector<double> inertia_;            // [slot], see above
  std::vector<float> field_;               // [slot + 1][12] of Shear; empty: not needed
  ViscosityTable table_;
  std::vector<PairTensors> tensors_;         // [slot + 1]
  bool transposed_ = false;                  // with slopes
  std::vector<Vec3> right_;                  // [slot] right side
  std::vector<float> pair_, own_, inverse_;  // [pair]; [slot + 1] inertia and drag; [slot] sum of
                                             // the pairs' weights, then 1 / diagonal
  Floats3 v_, residual_, direction_, product_;  // [slot + 1]
};
}  // namespace swallowclip::bolus
