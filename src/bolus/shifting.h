// SPDX-License-Identifier: MIT
// Particle shifting (Lind et al. 2012, J. Comput. Phys. 231:1499): particles that a flow has drawn
// into strings move down the gradient of their own concentration, relative to the fluid:
//   w_i = -A dx rate_i dx (sum V gradW_ij + grad lambda_i),  v_i += dt (w_i . grad) v_i
// where w_i in the second is what shifting and the density's projection together make of it, so
// that particles carry the velocity of where they get to, and not their old one there.
#pragma once
#include <vector>

#include "bolus/projection.h"

namespace swallowclip::bolus {

class Shifting {
 public:
  /// Before a step.
  void begin(const Flow& flow, std::vector<Vec3>& moving);
  /// The velocities that are there before; shift, when all slots have them.
  void look(const Flow& flow, const std::vector<double>& densityRatio,
            const std::vector<Vec3>& velocities, int begin, int end);
  /// `moving` becomes `velocities` plus the velocity of shifting (m/s, [particle]). Nothing happens
  /// near a free surface, whose own gradient is none to be evened out. `then` is called when those
  /// of its slots are done.
  void shift(const Flow& flow, double dt_s, double spacing_m, const std::vector<Vec3>& velocities,
             std::vector<Vec3>& moving, const Projection::Range& then);
  /// Gives shifted particles the velocity of where `moving` takes them in dt_s; momentum is kept.
  /// `changed`: it is no longer what shift made it.
  void carry(const Flow& flow, double dt_s, bool changed, const std::vector<Vec3>& moving,
             std::vector<Vec3>& velocities, const Projection::Range& then);

 private:
  std::vector<float> density_, least_;  // [slot + 1]; [slot], of it and its neighbours
  Floats3 velocity_;                    // [slot + 1]
  std::vector<Mat3> slope_;             // [slot], 1/s; zero where nothing is shifted
  std::vector<Vec3> shift_, carried_;   // [slot], m/s
  std::vector<Vec3> parts_;             // [chunk], sums of carried_
};
}  // namespace swallowclip::bolus
