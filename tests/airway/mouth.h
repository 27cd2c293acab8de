// SPDX-License-Identifier: MIT
// A box-shaped mouth: a soft tongue below, a rigid palate above, a second rigid velum behind, and
// the lumen between them.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "../biomech/shapes.h"
#include "airway/airway_skin.h"

namespace swallowclip::test {

inline constexpr std::uint8_t kPalate = 0, kTongue = 3;
inline constexpr double kHeight_m = 0.008;
inline const Vec3 kLow(-0.015, 0, 0), kHigh(0.015, 0.06, kHeight_m);

inline airway::BindSkin mouthSkin(int refinements = 4) {
  airway::BindSkin skin;
  skin.mesh = refinedBox(kLow, kHigh, refinements);
  for (const Vec3& p : skin.mesh.positions) {
    skin.wall.push_back(p.z() > kHeight_m / 2 ? kPalate : kTongue);
    skin.s_m.push_back(p.y());
    skin.u.push_back(p.x() / kHigh.x());
    skin.branch.push_back(0);
  }
  return skin;
}

inline airway::SkinningDef mouthWalls() {
  airway::SkinningDef def;
  def.walls = {{kPalate, {"palate", "velum"}}, {kTongue, {"tongue"}}};
  return def;
}

/// `tongue(frame, rest)` and `rigid(frame)` move the structures.
template <class Tongue, class Rigid>
kinematics::MeshSequence mouth(int frames, Tongue&& tongue, Rigid&& rigid) {
  kinematics::MeshSequence s;
  s.start_s = -0.1;
  s.structures.push_back(sequenceOf(
      "tongue", false, refinedBox({-0.02, -0.005, -0.02}, {0.02, 0.065, 0}, 4), frames, tongue));
  const auto moved = [&](int k, std::vector<Vec3> p) { return applied(rigid(k), p); };
  s.structures.push_back(sequenceOf("palate", true,
                                    refinedBox({-0.02, -0.005, kHeight_m}, {0.02, 0.03, 0.012}, 3),
                                    frames, moved));
  s.structures.push_back(sequenceOf(
      "velum", true, refinedBox({-0.02, 0.03, kHeight_m}, {0.02, 0.065, 0.012}, 3), frames, moved));
  return s;
}

/// A bump of the tongue that travels from front to back and rises by up to `height_m`; it fades
/// towards the rim of the mouth, where the skin is sewn to the palate.
inline kinematics::MeshSequence squeezingMouth(int frames, double height_m) {
  return mouth(
      frames,
      [=](int k, std::vector<Vec3> p) {
        for (Vec3& x : p) {
          const double d = (x.y() - 0.06 * k / (frames - 1)) / 0.01, across = x.x() / 0.013;
          const double along = std::sin(kPi * std::clamp((x.y() - 0.004) / 0.052, 0.0, 1.0));
          const double fade = std::max(0.0, 1 - across * across) * along;
          if (x.z() > -1e-9) x.z() += height_m * fade * std::exp(-d * d);
        }
        return p;
      },
      [](int) { return Pose{}; });
}
}  // namespace swallowclip::test
