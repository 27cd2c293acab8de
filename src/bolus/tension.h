// SPDX-License-Identifier: MIT
// Surface tension and wetting by attraction between particles, and of walls for particles. With V
// gradW of a kernel W3 of 3 spacings and of the density's own kernel W, A in m^2/s^2:
//   a_i  = A  sum V (grad W3 - kept grad W)_ij  +  A_w (grad lambda_3 - kept grad lambda)
//   sigma = rho A (<r>_3 - kept <r>) / 8,   <r> = int r W dV                  (Fowler 1937)
//   A_w  = A (1 + cos theta) / 2            (Young-Dupre: 2 A_w / A = work of adhesion / sigma)
// Forces between particles are central and equal to the bit, so that momentum is kept.
//
// W alone as the potential gives nothing: its sums are the densities, which the projection holds at
// one, whatever the surface does. Hence the longer reach; and taking part of W off, which changes
// no surface that is packed, takes the pressure off that would pack it (docs/bolus.md).
#pragma once
#include <span>
#include <vector>

#include "bolus/fluid.h"
#include "bolus/projection.h"

namespace swallowclip::bolus {

/// Reach of the attraction in spacings. Measured: with 2.5 the pressure in a drop creeps to twice
/// Laplace's, 4 is no better than 3 and costs twice the neighbours.
inline constexpr double kTensionReach = 3;

class Tension {
 public:
  Tension(const Fluid& fluid, const Kernel& densityKernel, double spacing_m);
  Tension(const Tension&) = delete;
  Tension& operator=(const Tension&) = delete;

  /// The walls of one moment, as the solver has them.
  struct Walls {
    std::span<const Triangle> triangles;
    std::span<const Vec3> positions, velocities;
    std::span<const std::uint8_t> skipped;
    const WallField& field;
    double time_s, fastest_ms;  ///< of that moment; speed of the fastest wall
  };
  /// Before a new run of as many particles.
  void start(int particles) { held_.assign(particles, {}); }
  /// Forces between particles at `positions`, of which `active` take part: those of `flow`.
  void measure(const Flow& flow, std::span<const Vec3> positions,
               std::span<const std::uint8_t> active, const Walls& walls, const Vec3& period_m);
  /// Adds dt times the measured acceleration to velocities ([particle], m/s).
  void push(double dt_s, std::vector<Vec3>& velocities) const;
  /// Adds the (negative) pressure that the attraction itself transmits: in the midst of the fluid
  /// what holds particles apart outweighs it by what the surface's curvature asks for.
  void addPressure_Pa(const std::vector<double>& densityRatio,
                      std::vector<double>& pressure_Pa) const;
  /// [particle], part of the state of a run.
  std::vector<HeldWalls>& held() { return held_; }
  /// Of a fluid that is at least so viscous.
  double longestStep_s(double viscosity_Pas) const;
  /// Numbers of particles have changed, or a run that goes on from here must find the same lists.
  void forgetLists() { neighbours_.forget(); }

 private:
  void attract(const Flow& flow);
  void attractLess(const Flow& flow);
  bool isDue(const HeldWalls& held, const Vec3& position, double time_s) const;

  double density_kgm3_, spacing_m_, tension_Nm_, attraction_m2s2_, adhesion_m2s2_;
  Kernel kernel_;
  KernelTable table_;
  WallField field_;
  Neighbours neighbours_;
  std::vector<HeldWalls> held_;            // in field_
  std::vector<std::uint8_t> due_;          // [slot] whose walls are to be integrated again
  std::vector<Vec3> acceleration_;         // [particle], m/s^2
  std::vector<double> stress_;             // [particle], m^2/s^2
  std::vector<float> half_, transmitted_;  // [slot]
  std::vector<double> force_;              // [slot][3]
};
}  // namespace swallowclip::bolus
