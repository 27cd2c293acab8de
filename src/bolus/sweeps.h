// SPDX-License-Identifier: MIT
// The loops over neighbour lists that take a solver's time, eight neighbours at once. Arrays are
// [slot] of Neighbours with one more slot of zeros behind them, which the lists' padding names.
#pragma once
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "bolus/viscosity_table.h"
#include "core/vec.h"

namespace swallowclip::bolus {

struct PairLists {
  const int *start, *stop, *index;
  const float *gx, *gy, *gz;  ///< V gradW, 1/m
};

/// Who might be near whom, by places in space, images of periodic neighbours among them.
struct PlaceLists {
  const float *places;    ///< [place][4], m
  const int *self;        ///< [slot] its place
  const int *start;       ///< [slot] and its end, of each list, in whole vectors
  const int *candidates;  ///< places; what fills lists up is far away
};

/// Vectors of three, each in four floats, so that one is fetched at once.
struct Floats3 {
  std::vector<float> of;
  /// n to be written, and zeros behind them.
  void shape(std::size_t n, std::size_t behind) {
    of.resize(4 * (n + behind));
    std::fill(of.begin() + 4 * n, of.end(), 0.f);
  }
  const float *data() const { return of.data(); }
  float *data() { return of.data(); }
  float *operator[](int i) { return &of[4 * static_cast<std::size_t>(i)]; }
  const float *operator[](int i) const { return &of[4 * static_cast<std::size_t>(i)]; }
  void set(int i, const Vec3 &v) {
    for (int a = 0; a < 3; ++a) (*this)[i][a] = static_cast<float>(v[a]);
  }
  Vec3f at(int i) const { return Vec3f((*this)[i]); }
};

/// a_i = -mobility_i (sum (k_i + k_j) g_ij + k_i wall_i)
struct PressureSweep {
  PairLists pairs;
  const float *k, *mobility, *wall;  ///< wall: [slot][4], as all vectors
  float *a;
  void run(int begin, int end) const;
};

/// One projected step of  residual = source + sum (a_i - a_j).g_ij + a_i.wall_i: with s = diagonal
/// / relax,  z = y + residual / s  and  z_ = z + room / s, x' = z above zero, z_ s / (s + 1 / hold)
/// where that is below, else 0;  y' = x' + momentum (x' - x) + lead (x' - y), not below zero where
/// hold is none.
/// Chunks begin at multiples of eight, and all arrays have seven more slots of zeros.
struct StepSweep {
  PairLists pairs;
  const float *a, *wall, *source;
  const float *diagonal;  ///< 0: takes no part
  const float *room;      ///< what the source lacks of that for tension
  const float *hold;      ///< tension for how much of a source that is left, m^2; 0: none
  float relax, momentum, lead;
  float *x, *y;  ///< in and out
  struct Sums {
    double residual = 0;  ///< of |residual|, where it is not held by x' = 0
    double most = 0;      ///< the largest of them
    double moved = 0;     ///< sum of x' - y
    double ahead = 0;     ///< (x' - y).(x' - x): negative when the momentum leads astray
  };
  Sums run(int begin, int end) const;
};

/// out_i = own_i v_i + sum c_ij (v_i - v_j); returns sum v.out.
struct ViscositySweep {
  PairLists pairs;
  const float *c, *own, *v;
  float *out;
  double run(int begin, int end) const;
};
/// diagonal_i = mobility_i |sum g_ij + wall_i|^2 + sum mobility_j g_ij^2
struct DiagonalSweep {
  PairLists pairs;
  const float *mobility, *wall;
  float *diagonal;
  void run(int begin, int end) const;
};

/// rate_i = sum (v_i - v_j).g_ij
struct RateSweep {
  PairLists pairs;
  const float *v;
  float *rate;
  void run(int begin, int end) const;
};

/// out_i = sum (k_i + k_j) g_ij, summed in double from terms that are antisymmetric to the bit; and
/// stress_i = sum (k_i + k_j) / 2 r |g_ij| / 3.
struct GradientSweep {
  PairLists pairs;
  const float *k;
  double *out;     ///< [slot][3]
  const float *r;  ///< [pair]
  float *stress;
  void run(int begin, int end) const;
};

/// out_i = factor sum gradW_ij of a cubic spline, summed as GradientSweep, and stress_i = factor
/// sum r |gradW_ij| / 6, in one go through places.
struct AttractionSweep {
  PlaceLists lists;
  float perHalfSupport, factor;  ///< 2 / H; the factor times W(0) (2 / H)^2
  double *out;                   ///< [slot][3]
  float *stress;
  void run(int begin, int end) const;
};

/// A symmetric tensor per slot: xx yy zz - xy xz yz -, so that one is fetched at once.
struct Tensors {
  std::vector<float> of;
  void shape(std::size_t n, std::size_t behind) {
    of.resize(8 * (n + behind));
    std::fill(of.begin() + 8 * n, of.end(), 0.f);
  }
  float *operator[](int i) { return &of[8 * static_cast<std::size_t>(i)]; }
  const float *operator[](int i) const { return &of[8 * static_cast<std::size_t>(i)]; }
};

/// What a pair's viscosity takes from either: B, by which weights are evened out, and G^T of
/// PairViscositySweep, together in one line of the cache.
struct alignas(64) PairTensors {
  float even[8] = {};   ///< xx yy zz, the last of G^T, xy xz yz and nothing
  float slope[8] = {};  ///< rows of G^T
  float transposed(int row, int column) const {
    const int k = 3 * row + column;
    return k < 8 ? slope[k] : even[3];
  }
  void setTransposed(int row, int column, float value) {
    const int k = 3 * row + column;
    (k < 8 ? slope[k] : even[3]) = value;
  }
};

/// c_ij = 2 scale mu_ij even_ij |g_ij| r / (r^2 + eta2), mu at least leastPair, even =
/// n.(B_i + B_j).n / 2 along the pair, at least leastEven; diagonal_i = sum c_ij. Without
/// `constant` mu is that of the shear rate half way, where the gradient is (F_i + F_j) / 2, but
/// along the pair that of the cubic through both ends' v and F. `withSlopes` G also transposed_i =
/// -sum c_ij (G_i + G_j)^T x_ij / 2, summed as GradientSweep.
struct PairViscositySweep {
  PairLists pairs;
  const float *r;              ///< [pair]
  const PairTensors *tensors;  ///< [slot + 1]
  float constant;              ///< mu of all; 0: by the next two
  const ViscosityTable *table;
  const float *field;  ///< [slot][3][4] rows of F, 1/s, and behind each that component of v, m/s
  float scale, leastPair, eta2, leastEven;
  float *c, *diagonal;
  bool withSlopes;
  double *transposed;  ///< [slot][3]
  void run(int begin, int end) const;
};

/// out_i = sum (v_j - v_i) g_ij^T, row by row.
struct SlopeSweep {
  PairLists pairs;
  const float *v;
  void run(int slot, float *out9) const;
};

/// The least value of a slot and its neighbours.
struct LeastSweep {
  PairLists pairs;
  const float *value;  ///< padding: not less than any
  float *out;
  void run(int begin, int end) const;
};

/// out_i = sum c_ij (v_i - v_j), summed as GradientSweep.
struct DragSweep {
  PairLists pairs;
  const float *c, *v;
  double *out;  ///< [slot][3]
  void run(int begin, int end) const;
};
}  // namespace swallowclip::bolus
