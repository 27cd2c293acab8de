// SPDX-License-Identifier: MIT
#include "bolus/closed_walls.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace swallowclip::bolus {
namespace {
// Closed walks along the open edges, against their direction in the surface.
std::vector<std::vector<int>> holes(std::span<const Triangle> triangles,
                                    std::span<const std::uint8_t> skip) {
  std::set<std::pair<int, int>> edges;
  for (std::size_t k = 0; k < triangles.size(); ++k)
    for (int e = 0; !skip[k] && e < 3; ++e)
      edges.insert({triangles[k][e], triangles[k][(e + 1) % 3]});
  std::map<int, int> next;
  for (const auto& [a, b] : edges)
    if (!edges.contains({b, a})) next[b] = a;
  std::vector<std::vector<int>> loops;
  while (!next.empty()) {
    std::vector<int>& loop = loops.emplace_back();
    for (auto at = next.begin(); at != next.end();) {
      loop.push_back(at->first);
      const int following = at->second;
      next.erase(at);
      at = next.find(following);
    }
  }
  return loops;
}

// cost(i, j): least sum of added edges that triangulates the loop from i to j.
void triangulate(const std::vector<int>& loop, std::span<const Vec3> x,
                 std::vector<Triangle>& out) {
  const int n = static_cast<int>(loop.size());
  if (n < 3) return;
  std::vector<double> cost(n * n, 0.0);
  std::vector<int> apex(n * n, -1);
  const auto edge = [&](int i, int j) {
    return j - i < 2 || j - i == n - 1 ? 0.0 : (x[loop[i]] - x[loop[j]]).norm();
  };
  for (int gap = 2; gap < n; ++gap)
    for (int i = 0; i + gap < n; ++i) {
      const int j = i + gap;
      double best = INFINITY;
      for (int k = i + 1; k < j; ++k) {
        const double c = cost[i * n + k] + cost[k * n + j] + edge(i, k) + edge(k, j);
        if (c < best) best = c, apex[i * n + j] = k;
      }
      cost[i * n + j] = best;
    }
  std::vector<std::pair<int, int>> open{{0, n - 1}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    const int k = apex[i * n + j];
    out.push_back({loop[i], loop[k], loop[j]});
    open.push_back({i, k});
    open.push_back({k, j});
  }
}

// Twice the signed area of (a, b, p) seen from above.
double side(const Vec3& a, const Vec3& b, double x, double y) {
  return (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x());
}
}  // namespace

std::vector<Triangle> capHoles(std::span<const Triangle> triangles,
                               std::span<const std::uint8_t> skip,
                               std::span<const Vec3> positions) {
  std::vector<Triangle> caps;
  for (const std::vector<int>& loop : holes(triangles, skip)) triangulate(loop, positions, caps);
  return caps;
}

int ColumnIndex::column(double x, double y) const {
  const int i = static_cast<int>(std::floor((x - low_.x()) / cell_m_));
  const int j = static_cast<int>(std::floor((y - low_.y()) / cell_m_));
  return i < 0 || j < 0 || i >= nx_ || j >= ny_ ? -1 : j * nx_ + i;
}

void ColumnIndex::build(std::span<const Triangle> triangles, std::span<const Vec3> positions) {
  triangles_ = triangles;
  positions_ = positions;
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (const Vec3& p : positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  if (positions.empty()) low = high = Vec3::Zero();  // no walls, and nothing inside of them
  low_ = low;
  constexpr int kAcross = 64;  // columns across the longer side, assumed (32 to 256)
  cell_m_ = std::max((high - low).head<2>().maxCoeff() / kAcross, 1e-9);
  nx_ = static_cast<int>((high.x() - low.x()) / cell_m_) + 1;
  ny_ = static_cast<int>((high.y() - low.y()) / cell_m_) + 1;
  const auto visit = [&](auto&& each) {
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      const auto [a, b, c] = std::array{positions[triangles[k][0]], positions[triangles[k][1]],
                                        positions[triangles[k][2]]};
      const Vec3 from = (a.cwiseMin(b).cwiseMin(c) - low_) / cell_m_;
      const Vec3 to = (a.cwiseMax(b).cwiseMax(c) - low_) / cell_m_;
      for (int j = static_cast<int>(from.y()); j <= static_cast<int>(to.y()); ++j)
        for (int i = static_cast<int>(from.x()); i <= static_cast<int>(to.x()); ++i)
          each(j * nx_ + i, static_cast<int>(k));
    }
  };
  start_.assign(nx_ * ny_ + 1, 0);
  visit([&](int column, int) { ++start_[column + 1]; });
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  item_.resize(start_.back());
  std::vector<int> at(start_.begin(), start_.end() - 1);
  visit([&](int column, int triangle) { item_[at[column]++] = triangle; });
}

bool ColumnIndex::inside(const Vec3& p) const {
  const int c = column(p.x(), p.y());
  if (c < 0) return false;
  int crossings = 0;
  for (int k = start_[c]; k < start_[c + 1]; ++k) {
    const Triangle& t = triangles_[item_[k]];
    const Vec3 &a = positions_[t[0]], &b = positions_[t[1]], &d = positions_[t[2]];
    const double u = side(b, d, p.x(), p.y()), v = side(d, a, p.x(), p.y()),
                 w = side(a, b, p.x(), p.y());
    if ((u > 0) != (v > 0) || (v > 0) != (w > 0) || u + v + w == 0) continue;
    const double z = (u * a.z() + v * b.z() + w * d.z()) / (u + v + w);
    crossings += z > p.z();
  }
  return crossings % 2 == 1;
}
}  // namespace swallowclip::bolus
