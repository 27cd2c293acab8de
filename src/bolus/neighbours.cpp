// SPDX-License-Identifier: MIT
#include "bolus/neighbours.h"

#include <algorithm>
#include <cmath>

namespace swallowclip::bolus {
namespace {
constexpr int kChunk = 128;         // particles per work item
constexpr int kMaxCells = 1 << 21;  // a stray particle must not cost the memory of a continent
}  // namespace

Eigen::Vector3i PointGrid::cellOf(const Vec3& p) const {
  // clamped to one cell outside the box, so that far queries visit nothing
  Eigen::Vector3i c;
  for (int k = 0; k < 3; ++k)
    c[k] =
        static_cast<int>(std::floor(std::clamp((p[k] - low_[k]) / cell_m_, -2.0, size_[k] + 1.0)));
  return c;
}

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
    const Eigen::Vector3i c =
        cellOf(points[i]).cwiseMin(size_.array().matrix() - Eigen::Vector3i::Ones());
    cell_[i] = (c.z() * size_.y() + c.y()) * size_.x() + c.x();
    ++start_[cell_[i] + 1];
  }
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  std::vector<int> next(start_.begin(), start_.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (taken(i)) order_[next[cell_[i]]++] = static_cast<int>(i);
}

int Neighbours::countWithin(std::span<const Vec3> points, const Vec3& p, double radius_m) const {
  int count = 0;
  grid_.around(p, [&](int j) { count += (points[j] - p).squaredNorm() < radius_m * radius_m; });
  return count;
}

void Neighbours::build(std::span<const Vec3> points, std::span<const std::uint8_t> take,
                       const Kernel& kernel, ThreadPool& pool) {
  const int n = static_cast<int>(points.size());
  const double reach2 = kernel.support_m() * kernel.support_m();
  grid_.build(points, take, kernel.support_m());
  found_.resize(n);
  pool.forChunks(n, kChunk, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      found_[i].clear();
      if (!take.empty() && !take[i]) continue;
      grid_.around(points[i], [&](int j) {
        if (j != i && (points[i] - points[j]).squaredNorm() < reach2) found_[i].push_back(j);
      });
      std::sort(found_[i].begin(), found_[i].end());
    }
  });
  start.assign(n + 1, 0);
  for (int i = 0; i < n; ++i) start[i + 1] = start[i] + static_cast<int>(found_[i].size());
  index.resize(start[n]);
  gradW.resize(start[n]);
  sumW.assign(n, 0.0);
  const double self = kernel.w(0);
  pool.forChunks(n, kChunk, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      if (!take.empty() && !take[i]) continue;
      double sum = self;
      int k = start[i];
      for (int j : found_[i]) {
        const Vec3 d = points[i] - points[j];
        const double r = d.norm();
        index[k] = j;
        // two particles at one place have no direction: no force rather than a NaN
        gradW[k++] = r > 1e-12 ? Vec3(d * (kernel.slope(r) / r)) : Vec3::Zero();
        sum += kernel.w(r);
      }
      sumW[i] = sum;
    }
  });
}
}  // namespace swallowclip::bolus
