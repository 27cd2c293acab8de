// SPDX-License-Identifier: MIT
// The left half (x >= 0) of a closed surface, built of rows of points and then mirrored and
// stitched without new vertices: what lies in x = 0 is shared by both sides (thesis 3.1).
// Rows are walked so that row i+1 lies ahead; the triangles' side is settled by the volume's sign.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/tri_mesh.h"

namespace swallowclip::anatomy {

using Ring = std::vector<int>;  ///< vertex numbers of one row

/// Hole left in a loft: rows [row0,row1], columns [column0,column1] (columns may wrap).
struct GridWindow {
  int row0 = 0, row1 = 0, column0 = 0, column1 = 0;
};

class HalfSurface {
 public:
  Ring addRow(const std::vector<Vec3>& points);
  int addVertex(const Vec3& p);
  const Vec3& position(int vertex) const { return positions_[vertex]; }

  /// Quads between neighbouring rows, windows left out; `closed` joins last and first column.
  void loft(const std::vector<Ring>& rows, bool closed, const std::vector<GridWindow>& windows);
  /// Fan to one vertex; `ahead` when the pole lies after the row.
  void capPole(const Ring& row, bool closed, int pole, bool ahead);
  /// Fills an open last row across itself: point i with point n-1-i.
  void capFold(const Ring& row);
  /// The border of a window, walked so that loft({border, next}) continues the surface.
  static Ring windowBorder(const std::vector<Ring>& rows, bool closed, const GridWindow& window);

  /// Whole closed surface, facing outwards; an error names what leaves it open.
  Result<TriMesh> mirrored(const std::string& name) const;
  /// For solids off the midplane: left one and right one.
  Result<std::pair<TriMesh, TriMesh>> leftAndRight(const std::string& name) const;

 private:
  void addQuad(int a, int b, int c, int d);

  std::vector<Vec3> positions_;
  std::vector<Triangle> triangles_;
};

/// `points` (a row of the child) turned and perhaps reversed so that they follow `border` best.
std::vector<int> bestTurn(const std::vector<Vec3>& border, const std::vector<Vec3>& points);

/// Closed curve through control points (Catmull-Rom), n points at equal arc length.
std::vector<Vec2> resampleClosed(const std::vector<Vec2>& control, int n);

/// Uniform Catmull-Rom curve between p1 and p2.
Vec3 catmullRom(const Vec3& p0, const Vec3& p1, const Vec3& p2, const Vec3& p3, double t);

/// |a|^e + |b|^e = 1 at n equal angles from a = 1; half: from b = -1 over a = 1 to b = 1.
std::vector<Vec2> superellipse(double exponent, int n, bool half);

/// Smooth curve in plan (x, y) from the midline backwards, by arc length.
class PlanCurve {
 public:
  explicit PlanCurve(const std::vector<Vec2>& control);
  double total() const { return length_.back(); }
  /// Point and direction; straight on beyond the end.
  std::pair<Vec2, Vec2> at(double s) const;

 private:
  std::vector<Vec2> fine_;
  std::vector<double> length_;
};

/// Piecewise linear y(x); x ascending; held constant outside.
double interpolate(const std::vector<Vec2>& table, double x);
}  // namespace swallowclip::anatomy
