// SPDX-License-Identifier: MIT
// The integrals of WallField over pieces of wall, eight pieces at once.
#pragma once
#include <array>
#include <utility>
#include <vector>

#include "bolus/kernels.h"

namespace swallowclip::bolus {

/// Pieces in the order of their cells, padded with pieces that reach nothing: what is looked at in
/// a row as flat arrays, what is integrated as one record each.
struct PieceArrays {
  enum Field {
    kCx,
    kCy,
    kCz,     // centroid
    kReach,  // radius and kernel support
    kNx,
    kNy,
    kNz,
    kSpeed,   // fastest along its normal
    kClose2,  // nearer than this (by the square) its solid angle is taken exactly
    kFields
  };
  static constexpr int kRecord = 16;  ///< corners a, b, c, normal, velocity (3 each), area
  std::array<std::vector<float>, kFields> field;
  std::vector<int> rule;  ///< 0, 1, 2 for 1, 3, 7 quadrature points
  std::vector<float> records;
  int count = 0;
  void resize(int pieces);
  /// Where a piece of this rule and radius counts as close.
  static float close2(int rule, float radius_m, float spacing_m, float support_m);
  const float* at(Field f) const { return field[f].data(); }
  float* record(int piece) { return &records[static_cast<std::size_t>(kRecord) * piece]; }
};

/// Sums of one particle; names as in WallSample.
struct WallSums {
  double lambda = 0, shape = 0, flux = 0, friction = 0, area = 0;
  std::array<double, 3> gradLambda{}, frictionVelocity{};
  std::array<float, 6> bend{};              ///< of the gradient, 1/m^2: xx, yy, zz, xy, xz, yz
  float normalSpeed = 0, nearest2 = 1e30f;  // m/s, m^2
  float clear_m = 1e30f;                    ///< no wall is nearer, of those looked at
  int nearest = -1;                         ///< piece with the nearest centroid
};

/// Pieces within reach of a particle, by their rule; those that are close come behind the others.
struct NearPieces {
  static constexpr int kRules = 3, kLists = 2 * kRules;
  std::array<std::vector<int>, kLists> of;
  std::array<int, kLists> count{};
  std::vector<std::pair<int, int>> rows;  ///< of pieces, first and behind the last: to be looked at
  int pieces = 0;                         ///< in all rows
  std::vector<int> all, lists;
  void clear() { count = {}, pieces = 0, rows.clear(); }
  void add(int first, int last) { rows.emplace_back(first, last), pieces += last - first; }
};

/// What pieces give to a particle at (x, y, z): first look through the rows, then integrate.
struct WallQuadrature {
  const PieceArrays* pieces;
  const KernelTable::Wall* table;
  float nodesPerMetre, leastShear_m, perHalfSupport, w0, support_m, spacing_m;
  bool cubicSpline;
  void look(float x, float y, float z, NearPieces& near, WallSums& sums) const;
  void integrate(float x, float y, float z, NearPieces& near, WallSums& sums) const;
};

/// Nearest points of pieces that are within reach of a place, from there, in single precision.
struct NearPoints {
  std::vector<int> piece, candidates;
  std::vector<float> x, y, z, away2;  // m, m^2
  std::vector<float> plane;           ///< how far behind the piece's plane the particle is, m
  int count = 0, candidateCount = 0;
  void clear() { count = candidateCount = 0; }
};
/// Takes pieces of [begin, end) that perhaps have such a point as candidates; then finds the
/// points.
void lookForPoints(const PieceArrays& pieces, float x, float y, float z, float reach_m,
                   float support_m, int begin, int end, NearPoints& near);
void findPoints(const PieceArrays& pieces, float x, float y, float z, float reach_m,
                NearPoints& near);
/// Keeps those farther than `least_m` whose wall is not seen from behind and that do not lie the
/// same way as the unit vector `inward` points back.
void keepOthers(NearPoints& near, float least_m, const std::array<float, 3>& inward);
}  // namespace swallowclip::bolus
