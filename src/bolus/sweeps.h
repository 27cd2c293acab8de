// SPDX-License-Identifier: MIT
// The loops over neighbour lists that take a solver's time, eight neighbours at once. Arrays are
// [slot] of Neighbours with one more slot of zeros behind them, which the lists' padding names.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "core/vec.h"

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
  void set(int i, const Vec3 &v) {
    x[i] = static_cast<float>(v.x());
    y[i] = static_cast<float>(v.y());
    z[i] = static_cast<float>(v.z());
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
    double most = 0;      ///< the largest of them
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
/// diagonal_i = mobility_i |sum g_ij + wall_i|^2 + sum mobility_j g_ij^2
struct DiagonalSweep {
  PairLists pairs;
  const float *mobility, *wallX, *wallY, *wallZ;
  float *diagonal;
  void run(int begin, int end) const;
};

/// rate_i = sum (v_i - v_j).g_ij
struct RateSweep {
  PairLists pairs;
  const float *vx, *vy, *vz;
  float *rate;
  void run(int begin, int end) const;
};

/// out_i = sum (k_i + k_j) g_ij, summed in double from terms that are antisymmetric to the bit.
struct GradientSweep {
  PairLists pairs;
  const float *k;
  double *out;  ///< [slot][3]
  void run(int begin, int end) const;
};

/// A symmetric tensor per slot: xx yy zz xy xz yz.
struct Tensors {
  std::vector<float> of[6];
  void assign(int n, float diagonal) {
    for (int k = 0; k < 6; ++k) of[k].assign(n, k < 3 ? diagonal : 0.f);
  }
};

/// c_ij = 2 scale mu_ij even_ij |g_ij| r / (r^2 + eta2), mu harmonic and at least leastPair, even =
/// n.(B_i + B_j).n / 2 along the pair, at least leastEven; diagonal_i = sum c_ij.
struct PairViscositySweep {
  PairLists pairs;
  const float *r, *viscosity;
  const Tensors *evenness;
  float scale, leastPair, eta2, leastEven;
  float *c, *diagonal;
  void run(int begin, int end) const;
};

/// Adds sum r |g| n n (n along the pair) to a tensor of each slot.
struct MomentSweep {
  PairLists pairs;
  const float *r;
  Tensors *moment;
  void run(int begin, int end) const;
};

/// out_i = sum (k_i + k_j) / 2 r |g_ij| / 3
struct StressSweep {
  PairLists pairs;
  const float *r, *k;
  float *out;
  void run(int begin, int end) const;
};

/// out_i = sum c_ij (v_i - v_j), summed as GradientSweep.
struct DragSweep {
  PairLists pairs;
  const float *c, *vx, *vy, *vz;
  double *out;  ///< [slot][3]
  void run(int begin, int end) const;
};
}  // namespace swallowclip::bolus
