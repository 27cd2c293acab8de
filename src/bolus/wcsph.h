// SPDX-License-Identifier: MIT
// The thesis' own solver (4.2): an artificially compressible fluid, stepped explicitly.
//   p = c^2 (rho - rho0), never negative        Morris et al. 1997; the thesis prints p = c^2 rho
//   rho / rho0 = V sum W_ij / gamma,   gamma = 1 - lambda          Ferrand et al. 2013, the thesis'
//   a_i = -(V sum (k_i + k_j) gradW_ij + m k_i grad lambda_i) / gamma,   k = p / rho0 (rho0 /
//   rho)^2
//   + the wall's repulsion (4.27) + gravity; viscosity by bolus/viscosity.h
// The projections find whatever pressure it takes; an equation of state must see in a slit, which
// is mostly wall, the whole compression (/ gamma) and push by the whole gradient (/ gamma).
// rho0 is subtracted as in Monaghan's (4.18), "to remove the boundary effect for free surface
// flow": with p = c^2 rho a free surface would feel the whole c^2 rho0, here the air's pressure is
// zero.
#pragma once
#include <array>
#include <vector>

#include "bolus/contact_response.h"
#include "bolus/projection.h"

namespace swallowclip::bolus {

class Wcsph {
 public:
  /// What eq. 4.21 wants to know of the moment.
  struct Scales {
    double speed_ms = 0;       ///< fastest of fluid and walls
    double bodyForce_ms2 = 0;  ///< per mass
    double depth_m = 0;        ///< of the fluid along the body force
    double viscosity_m2s = 0;  ///< kinematic
    double spacing_m = 0;      ///< the narrowest resolved gap: viscous length scale
  };
  void start() { *this = {}; }
  /// Speed of sound for the next step: at least that of eq. 4.21, falling slowly, and rising while
  /// the fluid is compressed by more than the delta of eq. 4.20: what a closing gap presses out is
  /// under a pressure that no scale of 4.21 knows (Reynolds' lubrication).
  void chooseSound(const Scales& scales, double sinceLast_s);
  double soundSpeed_ms() const { return sound_ms_; }

  /// Eq. 4.22 to 4.25; `smoothing_m` is the thesis' h, half of the support. Eq. 4.26 shortens no
  /// step: where it would, viscosity goes implicit (bolus/viscosity.h).
  double longestStep_s(double smoothing_m) const;

  /// Kicks velocities by pressure, walls and gravity, and leaves pressures [particle].
  void kick(const Flow& flow, const std::vector<std::vector<Contact>>& contacts,
            const Vec3& gravity_ms2, double spacing_m, double density_kgm3, double dt_s,
            std::vector<Vec3>& velocities, std::vector<double>& pressure_Pa);

  /// Viscosity (m^2/s) of Monaghan's linear term (4.12): what the fluid has at least.
  double leastViscosity_m2s(double smoothing_m) const;

  /// What the next step depends on: speed of sound, fastest kick, compression.
  std::array<double, 3> state() const { return {sound_ms_, fastestKick_ms2_, compression_}; }
  void setState(const std::array<double, 3>& s) {
    sound_ms_ = s[0];
    fastestKick_ms2_ = s[1];
    compression_ = s[2];
  }

 private:
  double sound_ms_ = 0, fastestKick_ms2_ = 0, compression_ = 0;  // of what is compressed
  std::vector<double> k_;                                        // [slot] p rho0 / rho^2, m^2/s^2
  std::vector<double> fastestPart_;                              // [chunk]
};
}  // namespace swallowclip::bolus
