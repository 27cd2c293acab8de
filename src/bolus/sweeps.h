// SPDX-License-Identifier: MIT
// The loops over neighbour lists that take a solver's time, eight neighbours at once. Arrays are
// [slot] of Neighbours with one more slot of zeros behind them, which the lists' padding names.
#pragma once
#include <array>
#include <span>
#include <vector>

namespace swallowclip::bolus {

struct PairLists {
  const int *start, *index;
  const float *gx, *gy, *gz;  ///< V gradW, 1/m
};

/// Three components, flat.
struct Floats3 {
  std::vector<float> x, y, z;
  void assign(std::size_t n) {
    for (auto *c : {&x, &y, &z}) c->assign(n, 0.f);
  }
};

/// a_i = -mobility_i (sum (k_i + k_j) g_ij + k_i wall_i)
struct PressureSweep {
  PairLists pairs;
  const float *k, *mobility, *wallX, *wallY, *wallZ;
  float *ax, *ay, *az;
  void run(int begin, int end) const;
};

/// One projected step of  residual = source + sum (a_i - a_j).g_ij + a_i.wall_i:
/// x' = max(least, y + relax residual / diagonal),  y' = max(least, x' + momentum (x' - x)).
struct StepSweep {
  PairLists pairs;
  const float *ax, *ay, *az, *wallX, *wallY, *wallZ, *source;
  const float *diagonal;  ///< 0: takes no part
  float relax, momentum;
  float least;   ///< pressure: 0 at a free surface
  float *x, *y;  ///< in and out
  struct Sums {
    double residual = 0;  ///< of |residual|, where it is not held by x' = 0
    double ahead = 0;     ///< (x' - y).(x' - x): negative when the momentum leads astray
  };
  Sums run(int begin, int end) const;
};

/// out_i = own_i v_i + sum c_ij (v_i - v_j); returns sum v.out.
struct ViscositySweep {
  PairLists pairs;
  const float *c, *own, *vx, *vy, *vz;
  float *outX, *outY, *outZ;
  double run(int begin, int end) const;
};
}  // namespace swallowclip::bolus
