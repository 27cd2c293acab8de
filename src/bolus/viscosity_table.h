// SPDX-License-Identifier: MIT
// Apparent viscosity for inner loops: read from a table over the square of the shear rate, whose
// nodes are the floats with the same leading bits, 16 per octave, so that one is found by shifting.
// Linear between them: 0.05 % off where the viscosity falls as the inverse of the rate.
#pragma once
#include <vector>

#include "bolus/fluid.h"

namespace swallowclip::bolus {

struct ViscosityTable {
  static constexpr int kPartBits = 19;  ///< of a float's bits, those between two nodes
  static constexpr float kLeast = 1e-6f, kMost = 1e12f;  ///< 1/s^2, where it begins and ends
  struct Node {
    float value_Pas, step_Pas;  ///< at the node, and from it to the next
  };
  std::vector<Node> nodes;
  int first = 0;  ///< leading bits of the first node

  /// Nothing to do for the fluid that it is of already.
  void make(const Fluid& fluid);

 private:
  Fluid of_;
};
}  // namespace swallowclip::bolus
