// SPDX-License-Identifier: MIT
// The two projections of DFSPH (Bender & Koschier 2015), written with rho* = rho / rho0 and the
// kinematic pressure k = p / rho0 (m^2/s^2); a wall has the pressure of the particle before it:
//   a_i = (-V sum (k_i + k_j) gradW_ij - 2 k_i grad lambda_i) / (1 + drag_i)
//   D_i(v) = V sum (v_i - v_j).gradW_ij + 2 (v_i.grad lambda_i - flux_i)
// one for velocities, one for places: what density is above rest moves particles apart and leaves
// their velocities alone, or every rearrangement would stir the flow. Both are solved with k >= 0
// (for velocities also below, as far as viscosity holds a liquid together) by projected gradient
// steps, scaled by the diagonal and with momentum (the optimized gradient method of Kim & Fessler
// 2016, Math. Program. 159:81, two thirds of the iterations of Nesterov 1983 here; restarted as
// O'Donoghue & Candes 2015). Walls enter nowhere else but in makeRoom. Inner loops in single
// precision; what changes a velocity is summed in double from antisymmetric terms, so that momentum
// is kept.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "bolus/neighbours.h"
#include "bolus/sweeps.h"
#include "bolus/wall_field.h"

namespace swallowclip::bolus {

inline constexpr int kSweepChunk = 64;  ///< slots per work item of a neighbour sweep
/// Sweeps over fewer slots than this take less time than waking a thread, assumed (100 to 300).
inline constexpr int kSweepAlone = 200;

inline const WallSample kNoWall;

/// What one step works on. Arrays are [particle] unless they say slot.
struct Flow {
  const Neighbours& neighbours;
  const std::vector<WallSample>& walls;
  const std::vector<std::uint8_t>& beside;  ///< [slot] a wall is within the kernel's reach
  ThreadPool& pool;

  PairLists lists() const { return neighbours.lists(); }
  int count() const { return neighbours.count; }
  /// body(begin, end, chunk) over the slots.
  void sweep(const std::function<void(int, int, int)>& body) const {
    pool.forChunks(count(), kSweepChunk, body, kSweepAlone);
  }
  int particle(int slot) const { return neighbours.id[slot]; }
  /// Most are far from walls, and theirs need not be fetched.
  const WallSample& wall(int slot) const { return beside[slot] ? walls[particle(slot)] : kNoWall; }
};

struct Tolerances {
  double density = 1e-4;  ///< mean compression left after a step, assumed (1e-5 to 1e-3)
  double rate = 3e-4;     ///< mean compression within a step, assumed
  /// Of what is to be removed, may be left; 1: any. Assumed (1e-4 to 1e-3): 5.7 Pa.s squeezed out
  /// of 12 spacings lacks 6 % of its flux at 2e-3 and 2 % at 5e-4, corrections of places do the
  /// rest.
  double share = 5e-4;
};

struct ProjectionReport {
  int iterations = 0;
  bool atCap = false;
  double meanError = 0;  ///< mean compression left, share of rho0
};

class Projection {
 public:
  /// Work on the slots [begin, end) that others do in the same sweep.
  using Range = std::function<void(int begin, int end)>;

  /// Before anything else of a step.
  void prepare(const Flow& flow);
  /// Adds dt times the acceleration by the pressure of the last divergenceFree to velocities. Put
  /// in before friction and taken out after it, it lets friction act on forces that are in balance;
  /// divergenceFree then finds the whole pressure anew.
  void pushByLastPressure(const Flow& flow, double dt_s, std::vector<Vec3>& velocities, int begin,
                          int end);
  struct Friction {
    std::span<const double> wallDrag;  ///< [particle] dt times the rate at which walls brake it
    std::span<const double> viscosity_Pas;  ///< [slot]
    double density_kgm3 = 0;
  };
  /// Then, where there is any: `wallDrag` lets pressure move a particle only as far as the walls'
  /// friction allows within the step: a_i / (1 + drag_i), the implicit Brinkman term. Without it a
  /// narrow slit is squeezed out as if the fluid had no viscosity. And viscosity holds a liquid
  /// together, see kHold.
  void brake(const Flow& flow, const Friction& friction, int begin, int end);
  /// When all are braked.
  void takeLastPressureBack(const Flow& flow, double dt_s, std::vector<Vec3>& velocities, int begin,
                            int end);
  /// Removes compression rate where rho* would pass one; `velocities` (m/s), those that
  /// takeLastPressureBack left, in and out. `then` is called when those of its slots are done.
  ProjectionReport divergenceFree(const Flow& flow, const std::vector<double>& densityRatio,
                                  double dt_s, std::vector<Vec3>& velocities, const Range& then);
  /// Before constantDensity: which velocities those are.
  void startFrom(const Flow& flow, const std::vector<Vec3>& velocities, int begin, int end);
  /// Makes the density at the end of the step at most rho0; `velocities` are those that move.
  ProjectionReport constantDensity(const Flow& flow, const std::vector<double>& densityRatio,
                                   double dt_s, std::vector<Vec3>& velocities);
  /// The same again, when walls have taken from some of these velocities what would go through
  /// them: along stopped[slot] (of length one, or zero) a particle stays, and others make room.
  ProjectionReport makeRoom(const Flow& flow, const std::vector<double>& densityRatio, double dt_s,
                            std::vector<Vec3f> stopped, std::vector<Vec3>& velocities);
  void resize(int particles);

  /// Force per area (and rho0) that the velocities' projection of the last step transmits at a
  /// slot, m^2/s^2: the mean normal stress sum V (k_i + k_j)/2 r |gradW| / 3 of the pairs (Irving &
  /// Kirkwood 1950). k itself is a multiplier: among disordered particles, where gradW of a linear
  /// field comes out 10 % small, it is so much larger, and it zigzags from layer to layer.
  double stress_m2s2(const Flow& flow, int slot) const {
    return stress_[slot] + rateK_[flow.particle(slot)] * flow.wall(slot).lambdaSlope;
  }

  Tolerances tolerances;
  bool full = false;  ///< BolusDef::full

  /// Where the next solves start, [particle]: part of the state of a run.
  std::vector<double>& densityWarm() { return densityK_; }
  std::vector<double>& rateWarm() { return rateK_; }

 private:
  ProjectionReport project(const Flow& flow, double dt_s, int least, int cap, double tolerance,
                           bool levelled, std::vector<double>& warmK);
  // Sizes of a source: of all of it, and of what is compression.
  struct Asked {
    double size = 0, over = 0, most = 0;
    void add(float source, bool full) {
      const double positive = full ? std::abs(source) : std::max(0.f, source);
      add(Asked{std::abs(source), positive, positive});
    }
    void add(const Asked& o) {
      size += o.size;
      over += o.over;
      most = std::max(most, o.most);
    }
  };
  void startAt(const Flow& flow, const std::vector<Vec3>& velocities,
               const std::vector<double>& warmK, int begin, int end);
  struct Want {
    double source, room = 0, hold = 0;  // see StepSweep
  };
  template <class Source>
  void findSource(const Flow& flow, const std::vector<Vec3>& velocities, bool pushes,
                  Source&& source);
  PressureSweep pressureOf(const Flow& flow, const std::vector<float>& k);
  ProjectionReport correct(const Flow& flow, const std::vector<double>& densityRatio, double dt_s,
                           std::vector<double>& warmK, std::vector<Vec3>& velocities);
  void findAccelerations(const PressureSweep& pressure, int begin, int end);
  void accelerate(const Flow& flow, double dt_s, std::vector<Vec3>& velocities, const Range& then);

  std::vector<double> densityK_, rateK_;  // [particle], where the next solve starts
  // [slot] and one slot of zeros
  std::vector<float> along_, across_;  // how much farther particles move along their wall
  std::vector<float> bulk_m2s_;        // against dilation, see kHold
  std::vector<float> mobility_, freedom_, diagonal_, source_, room_, hold_m2_, x_, y_;
  Floats3 wall_, acceleration_, velocity_;
  std::vector<Vec3f> stopped_;  // [slot] of makeRoom; empty: nobody is
  std::vector<double> force_;   // [slot][3], of x_
  std::vector<float> stress_;   // [slot]
  std::vector<Asked> asked_;    // [chunk]
  std::vector<StepSweep::Sums> parts_;
};
}  // namespace swallowclip::bolus
