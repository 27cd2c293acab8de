// SPDX-License-Identifier: MIT
#include "kinematics/follow.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace swallowclip::kinematics {

Attachment attach(const Vec3& p, const std::vector<Vec3>& points,
                  const std::vector<int>& candidates) {
  CHECK_LE(kFollowed, static_cast<int>(candidates.size()));
  std::vector<std::pair<double, int>> near;
  near.reserve(candidates.size());
  for (int v : candidates) near.push_back({(points[v] - p).squaredNorm(), v});
  std::partial_sort(near.begin(), near.begin() + kFollowed, near.end());
  const double kTouch_m = 1e-4;  // below this a neighbour counts as touching: no endless weight
  const double reach_m = 1.001 * std::sqrt(near[kFollowed - 1].first) + kTouch_m;
  Attachment a;
  double sum = 0;
  for (int k = 0; k < kFollowed; ++k) {
    const double d = std::max(std::sqrt(near[k].first), kTouch_m);
    const double w = (reach_m - d) / (reach_m * d);
    a.vertex[k] = near[k].second;
    a.weight[k] = w * w;
    sum += w * w;
  }
  for (double& w : a.weight) w /= sum;
  return a;
}

Vec3 follow(const Attachment& a, const std::vector<Vec3>& rest, const std::vector<Vec3>& now) {
  Vec3 d = Vec3::Zero();
  for (int k = 0; k < kFollowed; ++k) d += a.weight[k] * (now[a.vertex[k]] - rest[a.vertex[k]]);
  return d;
}
}  // namespace swallowclip::kinematics
