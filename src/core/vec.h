// SPDX-License-Identifier: MIT
// Linear algebra names used everywhere. Lengths in metres, frame: x patient left, y posterior,
// z superior, origin at the posterior nasal spine.
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace swallowclip {
using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Vec3f = Eigen::Vector3f;
using Mat3 = Eigen::Matrix3d;
using Mat3f = Eigen::Matrix3f;
using Quat = Eigen::Quaterniond;

/// Rigid motion; `apply(p) = q * p + t`. Variables of this type are named target-from-source.
struct Pose {
  Quat q = Quat::Identity();
  Vec3 t = Vec3::Zero();

  Vec3 apply(const Vec3& p) const { return q * p + t; }
  Pose operator*(const Pose& b) const { return {q * b.q, q * b.t + t}; }
  Pose inverse() const {
    const Quat c = q.conjugate();
    return {c, -(c * t)};
  }
};

inline constexpr double kMetrePerMm = 1e-3;
inline constexpr double kPi = 3.14159265358979323846;
}  // namespace swallowclip
