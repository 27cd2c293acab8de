// SPDX-License-Identifier: MIT
#include "airway/surface_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace swallowclip::airway {
namespace {

constexpr int kLeafTriangles = 4;
// A group of triangles seen from farther than this many of its radii counts as one dipole.
constexpr double kDipoleRadii = 3;

Vec3 areaVector(const std::array<Vec3, 3>& c) {
  return 0.5 * (c[1] - c[0]).cross(c[2] - c[0]);
}

// Signed solid angle (van Oosterom & Strackee 1983).
double solidAngle(const std::array<Vec3, 3>& corners, const Vec3& p) {
  const Vec3 a = corners[0] - p, b = corners[1] - p, c = corners[2] - p;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)),
                        la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}
}  // namespace

SurfaceSearch::SurfaceSearch(std::span<const Vec3> p, std::span<const Triangle> triangles) {
  std::vector<Vec3> centroids;
  for (const Triangle& t : triangles) {
    corners_.push_back({p[t[0]], p[t[1]], p[t[2]]});
    centroids.push_back((p[t[0]] + p[t[1]] + p[t[2]]) / 3);
  }
  order_.resize(triangles.size());
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.reserve(2 * triangles.size() + 1);
  if (!triangles.empty()) build(0, static_cast<int>(triangles.size()), centroids);
}

// Splits at the median centroid of the longest side; ties by number keep the tree deterministic.
int SurfaceSearch::build(int begin, int end, std::vector<Vec3>& centroids) {
  const int id = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  Node node;
  node.begin = begin;
  node.end = end;
  node.box.setEmpty();
  Eigen::AlignedBox3d middles;
  double area = 0;
  for (int i = begin; i < end; ++i) {
    const auto& c = corners_[order_[i]];
    for (const Vec3& x : c) node.box.extend(x);
    middles.extend(centroids[order_[i]]);
    const Vec3 a = areaVector(c);
    node.areaVector += a;
    node.centre += a.norm() * centroids[order_[i]];
    area += a.norm();
  }
  node.centre = area > 0 ? Vec3(node.centre / area) : Vec3(node.box.center());
  for (int i = begin; i < end; ++i)
    for (const Vec3& x : corners_[order_[i]])
      node.radius_m = std::max(node.radius_m, (x - node.centre).norm());
  if (end - begin > kLeafTriangles) {
    int axis = 0;
    middles.sizes().maxCoeff(&axis);
    const int middle = (begin + end) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](int a, int b) {
                       const double x = centroids[a][axis], y = centroids[b][axis];
                       return x < y || (x == y && a < b);
                     });
    node.left = build(begin, middle, centroids);
    node.right = build(middle, end, centroids);
  }
  nodes_[id] = node;
  return id;
}

template <class Accept>
SurfacePoint SurfaceSearch::search(const Vec3& p, double reach_m, const Accept& accept) const {
  SurfacePoint best;
  if (nodes_.empty()) return best;
  best.distance_m = reach_m;
  double best2 = reach_m * reach_m;
  std::array<int, 64> stack{};
  int size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const Node& node = nodes_[stack[--size]];
    if (node.box.squaredExteriorDistance(p) > best2) continue;
    if (node.left >= 0) {
      const double l = nodes_[node.left].box.squaredExteriorDistance(p);
      const double r = nodes_[node.right].box.squaredExteriorDistance(p);
      stack[size++] = l < r ? node.right : node.left;
      stack[size++] = l < r ? node.left : node.right;
      continue;
    }
    for (int i = node.begin; i < node.end; ++i) {
      const int t = order_[i];
      const auto& c = corners_[t];
      const Vec3 b = closestBarycentric(p, c[0], c[1], c[2]);
      const Vec3 x = b[0] * c[0] + b[1] * c[1] + b[2] * c[2];
      const double d2 = (x - p).squaredNorm();
      if (d2 > best2 || (d2 == best2 && best.triangle >= 0 && t > best.triangle)) continue;
      if (!accept(t)) continue;
      best2 = d2;
      best = {t, b, x, std::sqrt(d2)};
    }
  }
  if (best.triangle < 0) best.distance_m = std::numeric_limits<double>::infinity();
  return best;
}

SurfacePoint SurfaceSearch::nearest(const Vec3& p, double reach_m) const {
  return search(p, reach_m, [](int) { return true; });
}

SurfacePoint SurfaceSearch::nearestOpposed(const Vec3& p, const Vec3& normal) const {
  return search(p, std::numeric_limits<double>::infinity(),
                [&](int t) { return areaVector(corners_[t]).dot(normal) < 0; });
}

double SurfaceSearch::winding(const Vec3& p) const {
  if (nodes_.empty()) return 0;
  double sum = 0;
  std::array<int, 64> stack{};
  int size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const Node& node = nodes_[stack[--size]];
    const Vec3 d = node.centre - p;
    const double r2 = d.squaredNorm(), far = kDipoleRadii * node.radius_m;
    if (r2 > far * far) {
      sum += node.areaVector.dot(d) / (r2 * std::sqrt(r2));
    } else if (node.left >= 0) {
      stack[size++] = node.left;
      stack[size++] = node.right;
    } else {
      for (int i = node.begin; i < node.end; ++i) sum += solidAngle(corners_[order_[i]], p);
    }
  }
  return sum / (4 * kPi);
}
}  // namespace swallowclip::airway
