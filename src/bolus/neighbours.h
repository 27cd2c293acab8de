// SPDX-License-Identifier: MIT
// Who is within a kernel support of whom: counting-sort grid, then flat lists (CSR) with the
// kernel gradient cached, since the projections and the viscosity walk them many times a step.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "bolus/kernels.h"
#include "core/parallel.h"
#include "core/vec.h"

namespace swallowclip::bolus {

/// Points sorted into cubic cells; cell c holds order[start[c]] .. order[start[c + 1] - 1].
/// Points of one cell keep their index order, so that every sum has a fixed order.
class PointGrid {
 public:
  /// Only points with take[i] != 0 enter; an empty `take` takes all.
  void build(std::span<const Vec3> points, std::span<const std::uint8_t> take, double cell_m);

  /// Calls visit(index) for the points of the 27 cells around p.
  template <class Visit>
  void around(const Vec3& p, Visit&& visit) const {
    if (order_.empty()) return;
    const Eigen::Vector3i c = cellOf(p);
    for (int z = std::max(c.z() - 1, 0); z <= std::min(c.z() + 1, size_.z() - 1); ++z)
      for (int y = std::max(c.y() - 1, 0); y <= std::min(c.y() + 1, size_.y() - 1); ++y) {
        const int x0 = std::max(c.x() - 1, 0), x1 = std::min(c.x() + 1, size_.x() - 1);
        if (x0 > x1) continue;
        const int row = (z * size_.y() + y) * size_.x();
        for (int k = start_[row + x0]; k < start_[row + x1 + 1]; ++k) visit(order_[k]);
      }
  }

 private:
  Eigen::Vector3i cellOf(const Vec3& p) const;

  double cell_m_ = 1;
  Vec3 low_ = Vec3::Zero();
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  std::vector<int> start_, order_, cell_;
};

struct Neighbours {
  std::vector<int> start;    ///< [n + 1]
  std::vector<int> index;    ///< neighbours of i: index[start[i]] .. index[start[i + 1] - 1]
  std::vector<Vec3> gradW;   ///< gradient of W(x_i - x_j) at x_i (1/m^4)
  std::vector<double> sumW;  ///< [n] sum of W over the neighbours and the particle itself

  /// Lists without the particle itself, in ascending order; untaken ones have none and are in none.
  void build(std::span<const Vec3> points, std::span<const std::uint8_t> take, const Kernel& kernel,
             ThreadPool& pool);

  /// How many of the points of the last build are nearer to p than radius (at most a support).
  int countWithin(std::span<const Vec3> points, const Vec3& p, double radius_m) const;

 private:
  PointGrid grid_;
  std::vector<std::vector<int>> found_;
};
}  // namespace swallowclip::bolus
