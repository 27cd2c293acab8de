// SPDX-License-Identifier: MIT
// Particle shifting (Lind et al. 2012, J. Comput. Phys. 231:1499): particles that a flow has drawn
// into strings move down the gradient of their own concentration, relative to the fluid:
//   w_i = -A dx rate_i dx (sum V gradW_ij + grad lambda_i)
// Velocities stay with their particles. To give each that of where it gets to, v_i += dt (w_i .
// grad) v_i, costs more than it mends: a particle's own noise is in that gradient, against w_i, and
// grows; and what momentum is gained so has to be taken from somewhere. Plates that start to drag
// water came out 24 % off, far from the plate as well, a sheared channel of 0.02 Pa.s 4 % too thin.
#pragma once
#include <span>
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
  struct Step {
    double dt_s, spacing_m;
    bool mixing = false;  ///< also what does not flow
  };
  /// `slopes_s`, where not empty, become the gradients of the velocities, [slot].
  /// `moving` becomes `velocities` plus the velocity of shifting (m/s, [particle]). Nothing happens
  /// near a free surface, whose own gradient is none to be evened out. `then` is called when those
  /// of its slots are done.
  void shift(const Flow& flow, const Step& step, const std::vector<Vec3>& velocities,
             std::vector<Vec3>& moving, std::span<Mat3f> slopes_s, const Projection::Range& then);

 private:
  std::vector<float> density_, least_;  // [slot + 1]; [slot], of it and its neighbours
  Floats3 velocity_;                    // [slot + 1]
};
}  // namespace swallowclip::bolus
