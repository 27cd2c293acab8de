// SPDX-License-Identifier: MIT
// Two questions about the closed surface around the fluid: what closes it where a shut branch has
// been taken away, and whether a point is inside.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/tri_mesh.h"

namespace swallowclip::bolus {

/// Triangles that close the holes left when the triangles marked in `skip` are taken out of a
/// closed surface. No new vertices; facing like their surroundings. Each hole gets the
/// triangulation whose added edges are shortest (dynamic programming, Klincsek 1980): across a
/// slit, a zip.
std::vector<Triangle> capHoles(std::span<const Triangle> triangles,
                               std::span<const std::uint8_t> skip, std::span<const Vec3> positions);

/// Inside test by crossings of the line straight up from a point; triangles lie in a grid of
/// columns, so that a test costs some ten triangles. A line through an edge may be miscounted: ask
/// `windingNumber` before calling a point outside.
class ColumnIndex {
 public:
  void build(std::span<const Triangle> triangles, std::span<const Vec3> positions);
  bool inside(const Vec3& p) const;

 private:
  int column(double x, double y) const;
  std::span<const Triangle> triangles_;
  std::span<const Vec3> positions_;
  Vec3 low_ = Vec3::Zero();
  double cell_m_ = 1;
  int nx_ = 0, ny_ = 0;
  std::vector<int> start_, item_;
};
}  // namespace swallowclip::bolus
