// SPDX-License-Identifier: MIT
// Points by the cubic cells that they lie in.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"

namespace swallowclip::bolus {

inline constexpr int kMaxCells = 1 << 21;  ///< a stray point must not cost a continent's memory
inline const Eigen::Vector3i kOne = Eigen::Vector3i::Ones();

/// Points sorted into cubic cells; cell c holds order[start[c]] .. order[start[c + 1] - 1].
/// Points of one cell keep their index order, so that every sum has a fixed order.
class PointGrid {
 public:
  /// Only points with take[i] != 0 enter; an empty `take` takes all.
  void build(std::span<const Vec3> points, std::span<const std::uint8_t> take, double cell_m);

  /// Calls visit(first, last) for each row of the cells within reach_m of p along every axis:
  /// places in order().
  template <class Visit>
  void rowsAround(const Vec3& p, double reach_m, Visit&& visit) const {
    if (order_.empty()) return;
    const Vec3 reach = Vec3::Constant(reach_m);
    const Eigen::Vector3i low = cellOf(p - reach).cwiseMax(0),
                          high = cellOf(p + reach).cwiseMin(size_.array().matrix() - kOne);
    if (low.x() > high.x()) return;
    for (int z = low.z(); z <= high.z(); ++z)
      for (int y = low.y(); y <= high.y(); ++y) {
        const int row = (z * size_.y() + y) * size_.x();
        const int first = start_[row + low.x()], last = start_[row + high.x() + 1];
        if (first < last) visit(first, last);
      }
  }

  const std::vector<int>& order() const { return order_; }

 private:
  Eigen::Vector3i cellOf(const Vec3& p) const {  // one outside at most, so that rows are few
    const Eigen::Array3d at = ((p - low_) / cell_m_).array().floor();
    return at.max(-1).min(size_.cast<double>().array()).cast<int>();
  }

  double cell_m_ = 1;
  Vec3 low_ = Vec3::Zero();
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  std::vector<int> start_, order_, cell_;
};
}  // namespace swallowclip::bolus
