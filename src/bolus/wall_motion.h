// SPDX-License-Identifier: MIT
// What the fluid knows of the body: one closed triangle surface around it, moving in time.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "core/tri_mesh.h"

namespace swallowclip::bolus {

/// Closed surface around the fluid, triangles facing OUT of the fluid's domain. Topology is
/// constant. Fluid never changes the motion (one-way coupling).
struct WallMotion {
  std::vector<Triangle> triangles;
  std::vector<std::uint8_t> wall;  ///< [vertex] anatomical side; same number = same sheet
  std::vector<double> s_m, u;      ///< [vertex] path coordinates; may be empty outside the body
  /// [vertex] label of the branch: 0 main lumen, 1 nasopharynx, 2 larynx, 3 and 4 the mouths of 1
  /// and 2 (their first millimetres); may be empty.
  std::vector<std::uint8_t> branch;
  /// Positions (m) and velocities (m/s) of all vertices at time t (s). Velocity is the exact time
  /// derivative of position; position is C1 in t.
  std::function<void(double t_s, std::vector<Vec3>& positions, std::vector<Vec3>& velocities)> at;
  bool standsStill = false;  ///< at any time as at any other
  /// True while the mouth of a branch (1 or 2) is shut lip to lip; may be empty. Its tube is then
  /// no wall for fluid outside it: the lips meet, nothing flows into the slit between them.
  std::function<bool(double t_s, int branch)> sealed;
};
}  // namespace swallowclip::bolus
