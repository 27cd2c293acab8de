// SPDX-License-Identifier: MIT
// The integrals of WallField over pieces of wall, eight pieces at once.
#pragma once
#include <array>
#include <vector>

#include "bolus/kernels.h"

namespace swallowclip::bolus {

/// Flat arrays of pieces in the order of their cells; padded with pieces that reach nothing.
struct PieceArrays {
  // kReach: radius and kernel support; kRule: 0, 1, 2 for 1, 3, 7 quadrature points
  enum Field {
    kCx,
    kCy,
    kCz,
    kReach,
    kAx,
    kAy,
    kAz,
    kBx,
    kBy,
    kBz,
    kGx,
    kGy,
    kGz,  // c is taken
    kNx,
    kNy,
    kNz,
    kArea,
    kVx,
    kVy,
    kVz,
    kSpeed,
    kRule,
    kFields
  };
  std::array<std::vector<float>, kFields> field;
  void resize(std::size_t pieces);
  const float* at(Field f) const { return field[f].data(); }
};

/// Sums of one particle; names as in WallSample.
struct WallSums {
  double lambda = 0, shape = 0, flux = 0, friction = 0, area = 0;
  std::array<double, 3> gradLambda{}, frictionVelocity{};
  float normalSpeed = 0, nearest2 = 0;
  int nearest = -1;  ///< piece with the nearest centroid
};

/// What the pieces [begin, end) give to a particle at (x, y, z).
struct WallQuadrature {
  const PieceArrays* pieces;
  const KernelTable::Wall* table;
  float nodesPerMetre, leastShear_m, perHalfSupport, w0, support_m, spacing_m;
  bool cubicSpline;
  void add(float x, float y, float z, int begin, int end, WallSums& sums) const;
};

/// Pieces of [begin, end) with a point perhaps within `reach` of (x, y, z): appended to out.
int nearPieces(const PieceArrays& pieces, float x, float y, float z, float reach_m, float support_m,
               int begin, int end, int* out);
}  // namespace swallowclip::bolus
