// SPDX-License-Identifier: MIT
// Closed test bodies and a preset lit so that pixel values are known exactly.
#pragma once
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "core/image.h"
#include "frame/history.h"
#include "render/render_preset.h"

namespace swallowclip::render::test {

inline const std::string kShaders = std::string(SWALLOWCLIP_SOURCE_DIR) + "/shaders";

/// Ellipsoid of `n` x 2n quads around `centre`, metres, closed.
inline frame::StructureTrack ellipsoid(const std::string& name, const std::string& material,
                                       const Vec3f& centre, const Vec3f& radii, int n,
                                       int frames = 1) {
  frame::StructureTrack s;
  s.name = name;
  s.material = material;
  s.poses.assign(frames, Pose{});
  const int m = 2 * n;
  s.rest.push_back(centre + Vec3f(0, 0, radii.z()));
  for (int i = 1; i < n; ++i)
    for (int k = 0; k < m; ++k) {
      const double a = kPi * i / n, b = 2 * kPi * k / m;
      s.rest.push_back(centre + radii.cwiseProduct(Vec3(std::sin(a) * std::cos(b),
                                                        std::sin(a) * std::sin(b), std::cos(a))
                                                       .cast<float>()));
    }
  s.rest.push_back(centre - Vec3f(0, 0, radii.z()));
  const int last = static_cast<int>(s.rest.size()) - 1;
  const auto at = [&](int i, int k) {
    return i == 0 ? 0 : i == n ? last : 1 + (i - 1) * m + k % m;
  };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < m; ++k) {
      const int a = at(i, k), b = at(i + 1, k), c = at(i + 1, k + 1), d = at(i, k + 1);
      if (i + 1 < n) s.triangles.push_back({a, b, c});
      if (i > 0) s.triangles.push_back({a, c, d});
    }
  return s;
}

inline frame::StructureTrack box(const std::string& name, const Vec3f& low, const Vec3f& high) {
  frame::StructureTrack s;
  s.name = name;
  s.material = "bone";
  s.poses.assign(1, Pose{});
  for (int i = 0; i < 8; ++i)
    s.rest.push_back(
        {i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z()});
  for (const auto& q : {std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}, std::array{0, 1, 5, 4},
                        std::array{2, 6, 7, 3}, std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}}) {
    s.triangles.push_back({q[0], q[1], q[2]});
    s.triangles.push_back({q[0], q[2], q[3]});
  }
  return s;
}

/// Ambient light only, no occlusion, no outline, no captions: a surface shows its own colour.
inline RenderPreset flatPreset(int width, int height) {
  RenderPreset p;
  p.name = "flat";
  p.width = width;
  p.height = height;
  p.sectionOutline_m = 0;
  p.toneMap = false;
  p.ao.strength = 0;
  p.light.shadow = false;
  p.light.key.intensity = p.light.fill.intensity = 0;
  p.light.ambientTop_srgb = p.light.ambientBottom_srgb = Colour(1, 1, 1);
  p.light.ambientIntensity = 1;
  p.caption.on = false;
  p.background.top_srgb = p.background.bottom_srgb = Colour(0, 0, 0);
  Material m;
  m.baseColour_srgb = Colour(0.8f, 0.4f, 0.2f);
  m.sectionColour_srgb = Colour(0.2f, 0.6f, 0.3f);
  m.specular = 0;
  m.roughness = 1;
  p.fallback = p.bolus = m;
  ViewDef side;  // from patient left, posterior to the right, 100 mm high
  side.projection = Projection::orthographic;
  side.eye_m = {0.3, 0, 0};
  side.target_m = {0, 0, 0};
  side.orthoHeight_m = 0.1;
  p.views["side"] = side;
  return p;
}

inline frame::History still(std::vector<frame::StructureTrack> structures) {
  frame::History h;
  h.time_s = {0};
  h.structures = std::move(structures);
  return h;
}

/// Cubic lattice of fluid particles with spacing dx filling an ellipsoid.
inline std::vector<Vec3f> lattice(const Vec3f& centre, const Vec3f& radii, float dx) {
  std::vector<Vec3f> out;
  const Eigen::Vector3i n = (radii / dx).array().ceil().cast<int>();
  for (int x = -n.x(); x <= n.x(); ++x)
    for (int y = -n.y(); y <= n.y(); ++y)
      for (int z = -n.z(); z <= n.z(); ++z) {
        const Vec3f p =
            dx * Vec3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
        if (p.cwiseQuotient(radii).squaredNorm() <= 1) out.push_back(centre + p);
      }
  return out;
}
}  // namespace swallowclip::render::test
