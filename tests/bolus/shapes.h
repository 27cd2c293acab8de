// SPDX-License-Identifier: MIT
// Closed surfaces with known answers for the bolus tests: a box and a tube that closes behind a
// travelling wave.
#pragma once
#include <algorithm>
#include <cmath>
#include <map>

#include "bolus/wall_motion.h"

namespace swallowclip::bolus::testing {

struct Mesh {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
};

/// Axis-aligned box, faces out, cut into squares of about `edge_m`.
inline Mesh box(const Vec3& low, const Vec3& high, double edge_m) {
  Mesh m;
  const Vec3 size = high - low;
  Eigen::Vector3i n;
  for (int k = 0; k < 3; ++k) n[k] = std::max(1, static_cast<int>(std::ceil(size[k] / edge_m)));
  std::map<std::array<int, 3>, int> known;
  auto vertex = [&](std::array<int, 3> at) {
    auto [it, isNew] = known.try_emplace(at, static_cast<int>(m.positions.size()));
    if (isNew)
      m.positions.push_back(
          low + Vec3(size.x() * at[0] / n.x(), size.y() * at[1] / n.y(), size.z() * at[2] / n.z()));
    return it->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (int i = 0; i < n[u]; ++i)
        for (int j = 0; j < n[v]; ++j) {
          auto corner = [&](int di, int dj) {
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

inline WallMotion still(const Mesh& m) {
  WallMotion w;
  w.triangles = m.triangles;
  w.at = [p = m.positions](double, std::vector<Vec3>& x, std::vector<Vec3>& v) {
    x = p;
    v.assign(p.size(), Vec3::Zero());
  };
  return w;
}

/// Tube along x with elliptic section (half width y, half height z), s = x. From t = 0 a wave
/// closes its height behind x = front0 + speed t, over a ramp, to half the least gap.
struct TubeDef {
  double length_m = 0.1, halfWidth_m = 8e-3, halfHeight_m = 5e-3;
  double front0_m = -0.02, ramp_m = 0.02, speed_ms = 0.15, leastGap_m = 1e-4;
  double edge_m = 1.5e-3;
};

inline WallMotion closingTube(const TubeDef& d) {
  const int rings = static_cast<int>(std::ceil(d.length_m / d.edge_m)) + 1;
  const int around =
      static_cast<int>(std::ceil(kPi * (d.halfWidth_m + d.halfHeight_m) / d.edge_m / 2)) * 2;
  WallMotion w;
  auto id = [=](int ring, int k) { return ring * around + k % around; };
  for (int r = 0; r + 1 < rings; ++r)
    for (int k = 0; k < around; ++k) {
      w.triangles.push_back({id(r, k), id(r + 1, k), id(r + 1, k + 1)});
      w.triangles.push_back({id(r, k), id(r + 1, k + 1), id(r, k + 1)});
    }
  const int first = rings * around, last = first + 1;
  for (int k = 0; k < around; ++k) {
    w.triangles.push_back({first, id(0, k), id(0, k + 1)});
    w.triangles.push_back({last, id(rings - 1, k + 1), id(rings - 1, k)});
  }
  // seen along x the ring runs from y to z; flip so that triangles face out
  for (Triangle& t : w.triangles) std::swap(t[1], t[2]);
  for (int r = 0; r < rings; ++r)
    for (int k = 0; k < around; ++k) {
      w.s_m.push_back(d.length_m * r / (rings - 1));
      w.wall.push_back(k * 2 < around ? 0 : 1);
    }
  w.s_m.push_back(0);
  w.s_m.push_back(d.length_m);
  w.wall.insert(w.wall.end(), 2, 2);
  w.at = [=](double t, std::vector<Vec3>& x, std::vector<Vec3>& v) {
    x.resize(first + 2);
    v.assign(first + 2, Vec3::Zero());
    const double least = d.leastGap_m / 2;
    for (int r = 0; r < rings; ++r) {
      const double s = d.length_m * r / (rings - 1);
      const double u = std::clamp((s - d.front0_m - d.speed_ms * t) / d.ramp_m, 0.0, 1.0);
      const double height = least + (d.halfHeight_m - least) * u * u * (3 - 2 * u);
      const double rate = (d.halfHeight_m - least) * 6 * u * (1 - u) * -d.speed_ms / d.ramp_m;
      for (int k = 0; k < around; ++k) {
        const double a = 2 * kPi * k / around;
        x[id(r, k)] = {s, d.halfWidth_m * std::cos(a), height * std::sin(a)};
        v[id(r, k)] = {0, 0, rate * std::sin(a)};
      }
    }
    x[first] = {0, 0, 0};
    x[last] = {d.length_m, 0, 0};
  };
  return w;
}
}  // namespace swallowclip::bolus::testing
