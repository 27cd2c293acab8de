// SPDX-License-Identifier: MIT
// Small closed meshes with known volumes, and motions with known answers.
#pragma once
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "core/tri_mesh.h"
#include "kinematics/mesh_sequence.h"

namespace swallowclip::test {

inline TriMesh box(const Vec3& low, const Vec3& high) {
  TriMesh m;
  for (int k = 0; k < 8; ++k)
    m.positions.push_back(
        {k & 1 ? high.x() : low.x(), k & 2 ? high.y() : low.y(), k & 4 ? high.z() : low.z()});
  m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return m;
}

/// Every triangle cut in four; `onSphere` puts new vertices on the unit sphere.
inline TriMesh refined(const TriMesh& m, bool onSphere) {
  TriMesh out;
  out.positions = m.positions;
  std::map<std::pair<int, int>, int> middle;
  const auto half = [&](int a, int b) {
    auto [it, isNew] = middle.try_emplace({std::min(a, b), std::max(a, b)}, 0);
    if (isNew) {
      it->second = static_cast<int>(out.positions.size());
      const Vec3 p = (m.positions[a] + m.positions[b]) / 2;
      out.positions.push_back(onSphere ? Vec3(p.normalized()) : p);
    }
    return it->second;
  };
  for (const Triangle& t : m.triangles) {
    const int a = half(t[0], t[1]), b = half(t[1], t[2]), c = half(t[2], t[0]);
    out.triangles.insert(out.triangles.end(),
                         {{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}});
  }
  return out;
}

inline TriMesh refinedBox(const Vec3& low, const Vec3& high, int times) {
  TriMesh m = box(low, high);
  for (int i = 0; i < times; ++i) m = refined(m, false);
  return m;
}

/// From an octahedron; axes of the given half lengths.
inline TriMesh ellipsoid(const Vec3& half, int times, const Vec3& centre = Vec3::Zero()) {
  TriMesh m;
  m.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  m.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                 {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int i = 0; i < times; ++i) m = refined(m, true);
  for (Vec3& p : m.positions) p = p.cwiseProduct(half) + centre;
  return m;
}

inline Pose poseAt(double angle_rad, const Vec3& axis, const Vec3& shift) {
  return {Quat(Eigen::AngleAxisd(angle_rad, axis.normalized())), shift};
}

inline std::vector<Vec3> applied(const Pose& pose, std::vector<Vec3> points) {
  for (Vec3& p : points) p = pose.apply(p);
  return points;
}

/// frames[k] = motion(k) of the rest mesh.
template <class Motion>
kinematics::StructureSequence sequenceOf(const std::string& name, bool rigid, const TriMesh& rest,
                                         int frames, Motion&& motion) {
  kinematics::StructureSequence s{
      name, rigid ? "bone" : "muscle", rigid, rest.triangles, rest.positions, {}};
  for (int k = 0; k < frames; ++k) s.frames.push_back(motion(k, rest.positions));
  return s;
}
}  // namespace swallowclip::test
