// SPDX-License-Identifier: MIT
// Particle shifting (Lind et al. 2012, J. Comput. Phys. 231:1499): particles that a flow has drawn
// into strings move down the gradient of their own concentration, relative to the fluid:
//   w_i = -A dx rate_i dx (sum V gradW_ij + grad lambda_i),  v_i += dt (w_i . grad) v_i
// the second so that they carry the velocity of where they get to, and not their old one there: by
// strings alone Taylor-Green vortices lose a fifth of their speed, by bare shifting a power-law
// profile 2 % of its peak.
#pragma once
#include <vector>

#include "bolus/projection.h"

namespace swallowclip::bolus {

class Shifting {
 public:
  /// `moving` becomes `velocities` plus the velocity of shifting (m/s, [particle]). Nothing happens
  /// near a free surface, whose own gradient is none to be evened out.
  void apply(const Flow& flow, const std::vector<double>& densityRatio, double spacing_m,
             double dt_s, std::vector<Vec3>& velocities, std::vector<Vec3>& moving);

 private:
  std::vector<Vec3> shift_, carried_;  // [slot]
};
}  // namespace swallowclip::bolus
