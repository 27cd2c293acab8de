// SPDX-License-Identifier: MIT
// Particle shifting (Lind et al. 2012, J. Comput. Phys. 231:1499): particles that a flow has drawn
// into strings move down the gradient of their own concentration, relative to the fluid:
//   w_i = -A dx rate_i dx (sum V gradW_ij + grad lambda_i)
// Velocities stay with their particles. To give each that of where it gets to, v_i += dt (w_i .
// grad) v_i, costs more than it mends: a particle's own noise is in that gradient, against w_i, and
// grows; and what momentum is gained so has to be taken from somewhere. Plates that start to drag
// water came out 24 % off, far from the plate as well, a sheared channel of 0.02 Pa.s 4 % too thin.
//
// A shift remembers the last one (the heavy ball of Polyak 1964): strings, which are long, are
// evened out as by a step twice as long, and neighbours do not overshoot each other. And what the
// density's projection does to places is held back where it takes back what it did a step ago:
// between two particles with hardly a gradient it would go to and fro, each step as far as the
// last, until a wave's flow is 10 to 50 % off at single moments.
#pragma once
#include <span>
#include <vector>

#include "bolus/projection.h"

namespace swallowclip::bolus {

class Shifting {
 public:
  /// Before a step.
  void begin(const Flow& flow, std::vector<Vec3>& moving);
  void resize(int particles);
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
  /// How far a particle is to be moved relative to its velocity (spacings) when its shift and the
  /// density's projection together want it moved by `move`.
  Vec3 calm(int particle, const Vec3& move);
  /// The step will not be taken again.
  void accept() { std::swap(last_, next_); }

  /// What the last step did, spacings, [particle]: part of the state of a run.
  struct Last {
    std::vector<Vec3f> shift, push;
  };
  Last& last() { return last_; }

 private:
  Last last_, next_;
  std::vector<float> density_, least_;  // [slot + 1]; [slot], of it and its neighbours
  Floats3 velocity_;                    // [slot + 1]
};
}  // namespace swallowclip::bolus
