// SPDX-License-Identifier: MIT
// Points that go with the tissue around them: mean displacement of their nearest neighbours.
#pragma once
#include <array>
#include <vector>

#include "core/vec.h"

namespace swallowclip::kinematics {

constexpr int kFollowed = 16;  ///< neighbours that carry a point; assumed, 8-32

/// Weights by Franke and Nielson 1980 (modified Shepard), w = ((R - d) / (R d))^2 with R the
/// distance of the farthest neighbour: smooth where one neighbour takes the place of another.
struct Attachment {
  std::array<int, kFollowed> vertex{};
  std::array<double, kFollowed> weight{};
};

/// `candidates` are indices of `points`, kFollowed or more.
Attachment attach(const Vec3& p, const std::vector<Vec3>& points,
                  const std::vector<int>& candidates);

/// Displacement of the attached point while `rest` has moved to `now`, m.
Vec3 follow(const Attachment& a, const std::vector<Vec3>& rest, const std::vector<Vec3>& now);
}  // namespace swallowclip::kinematics
