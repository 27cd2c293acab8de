// SPDX-License-Identifier: MIT
#include "verify/domain_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace swallowclip::verify {

TriMesh boxMesh(const Vec3& low, const Vec3& high, double edge_m) {
  TriMesh m;
  const Vec3 size = high - low;
  std::array<int, 3> n{};
  for (int k = 0; k < 3; ++k)
    n[k] = std::max(1, static_cast<int>(std::ceil(size[k] / edge_m - 1e-9)));
  std::map<std::array<int, 3>, int> known;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [it, isNew] = known.try_emplace(at, static_cast<int>(m.positions.size()));
    if (isNew)
      m.positions.push_back(
          low + Vec3(size.x() * at[0] / n[0], size.y() * at[1] / n[1], size.z() * at[2] / n[2]));
    return it->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (int i = 0; i < n[u]; ++i)
        for (int j = 0; j < n[v]; ++j) {
          const auto corner = [&](int di, int dj) {
            std::array<int, 3> at{};
            at[axis] = side * n[axis];
            at[u] = i + di;
            at[v] = j + dj;
            return vertex(at);
          };
          const int a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (side == 1) {
            m.triangles.push_back({a, b, c});
            m.triangles.push_back({a, c, d});
          } else {
            m.triangles.push_back({a, c, b});
            m.triangles.push_back({a, d, c});
          }
        }
    }
  return m;
}

TriMesh roundMesh(int axis, double radius_m, double from_m, double to_m, double edge_m) {
  TriMesh m;
  const int around = std::max(12, static_cast<int>(std::ceil(2 * kPi * radius_m / edge_m)));
  const int along = std::max(1, static_cast<int>(std::ceil((to_m - from_m) / edge_m - 1e-9)));
  const int rings = std::max(1, static_cast<int>(std::ceil(radius_m / edge_m)));
  const double corner_m = radius_m * std::sqrt(2 * kPi / around / std::sin(2 * kPi / around));
  const auto ring = [&](double r, double at) {
    const int first = static_cast<int>(m.positions.size());
    for (int k = 0; k < around; ++k) {
      Vec3 p;
      p[axis] = at;
      p[(axis + 1) % 3] = r * std::cos(2 * kPi * k / around);
      p[(axis + 2) % 3] = r * std::sin(2 * kPi * k / around);
      m.positions.push_back(p);
    }
    return first;
  };
  // Rings from the centre of one end, out, along the side, and in to the centre of the other end.
  const auto centre = [&](double at) {
    Vec3 p = Vec3::Zero();
    p[axis] = at;
    m.positions.push_back(p);
    return static_cast<int>(m.positions.size()) - 1;
  };
  const int low = centre(from_m);
  std::vector<int> start;
  for (int k = 1; k < rings; ++k) start.push_back(ring(corner_m * k / rings, from_m));
  for (int k = 0; k <= along; ++k)
    start.push_back(ring(corner_m, from_m + (to_m - from_m) * k / along));
  for (int k = rings - 1; k >= 1; --k) start.push_back(ring(corner_m * k / rings, to_m));
  const int high = centre(to_m);
  for (int k = 0; k < around; ++k) {
    const int next = (k + 1) % around;
    m.triangles.push_back({low, start.front() + next, start.front() + k});
    m.triangles.push_back({high, start.back() + k, start.back() + next});
    for (std::size_t r = 0; r + 1 < start.size(); ++r) {
      const int a = start[r] + k, b = start[r] + next, c = start[r + 1] + next,
                d = start[r + 1] + k;
      m.triangles.push_back({a, b, c});
      m.triangles.push_back({a, c, d});
    }
  }
  return m;
}
}  // namespace swallowclip::verify
