// SPDX-License-Identifier: MIT
// Points by the cubic cells that they lie in.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"

namespace swallowclip::bolus {

inline constexpr int kMaxCells = 1 << 21;  ///< a stray point must not cost a continent's memory

/// Points sorted into cubic cells; cell c holds order[start[c]] .. order[start[c + 1] - 1].
/// Points of one cell keep their index order, so that every sum has a fixed order.
class PointGrid {
 public:
  /// Only points with take[i] != 0 enter; an empty `take` takes all.
  void build(std::span<const Vec3> points, std::span<const std::uint8_t> take, double cell_m);

  /// Calls visit(first, last) for each row of the cells within reach_m of p: places in order().
  template <class Visit>
  void rowsAround(const Vec3& p, double reach_m, Visit&& visit) const {
    if (order_.empty()) return;
    const Vec3 at = (p - low_) / cell_m_;
    const double reach = reach_m / cell_m_ * (1 + 1e-9), reach2 = reach * reach;
    const int lowZ = first(at.z() - reach), highZ = last(at.z() + reach, size_.z());
    for (int z = lowZ; z <= highZ; ++z) {
      const double left2 = reach2 - square(outside(at.z(), z));
      if (left2 < 0) continue;
      const double wide = std::sqrt(left2);
      const int lowY = first(at.y() - wide), highY = last(at.y() + wide, size_.y());
      for (int y = lowY; y <= highY; ++y) {
        const double long2 = left2 - square(outside(at.y(), y));
        if (long2 < 0) continue;
        const double length = std::sqrt(long2);
        const int lowX = first(at.x() - length), highX = last(at.x() + length, size_.x());
        if (lowX > highX) continue;
        const int row = (z * size_.y() + y) * size_.x();
        const int from = start_[row + lowX], to = start_[row + highX + 1];
        if (from < to) visit(from, to);
      }
    }
  }

  const std::vector<int>& order() const { return order_; }

 private:
  Eigen::Vector3i cellOf(const Vec3& p) const {
    const Eigen::Array3d at = ((p - low_) / cell_m_).array().floor();
    return at.max(0).min(size_.cast<double>().array() - 1).cast<int>();
  }
  // In cells: the first and the last that reach this far, none if the last is before the first.
  static int first(double at) { return at > 0 ? static_cast<int>(std::min(at, 1e9)) : 0; }
  static int last(double at, int size) {
    return at < 0 ? -1 : static_cast<int>(std::min(at, size - 1.0));
  }
  static double outside(double at, int cell) {  // how far from a cell
    return std::max({cell - at, at - (cell + 1), 0.0});
  }
  static double square(double a) { return a * a; }

  double cell_m_ = 1;
  Vec3 low_ = Vec3::Zero();
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  std::vector<int> start_, order_, cell_;
};
}  // namespace swallowclip::bolus
