// SPDX-License-Identifier: MIT
#include "bolus/point_grid.h"

namespace swallowclip::bolus {

void PointGrid::build(std::span<const Vec3> points, std::span<const std::uint8_t> take,
                      double cell_m) {
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  auto taken = [&](std::size_t i) { return take.empty() || take[i] != 0; };
  int count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!taken(i)) continue;
    low = low.cwiseMin(points[i]);
    high = high.cwiseMax(points[i]);
    ++count;
  }
  order_.assign(count, 0);
  if (count == 0) return;
  low_ = low;
  cell_m_ = cell_m;
  for (;;) {
    const Vec3 n = ((high - low) / cell_m_).array().floor() + 1;
    if (n.prod() <= kMaxCells) {
      size_ = n.cast<int>();
      break;
    }
    cell_m_ *= 2;
  }
  start_.assign(size_.prod() + 1, 0);
  cell_.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!taken(i)) continue;
    const Eigen::Vector3i c = cellOf(points[i]);
    cell_[i] = (c.z() * size_.y() + c.y()) * size_.x() + c.x();
    ++start_[cell_[i] + 1];
  }
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  std::vector<int> next(start_.begin(), start_.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (taken(i)) order_[next[cell_[i]]++] = static_cast<int>(i);
}
}  // namespace swallowclip::bolus
