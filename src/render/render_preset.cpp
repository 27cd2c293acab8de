// SPDX-License-Identifier: MIT
#include "render/render_preset.h"

#include <fmt/format.h>

namespace swallowclip::render {

const Material& RenderPreset::materialFor(const std::string& structure,
                                          const std::string& material) const {
  if (auto it = structures.find(structure); it != structures.end()) return it->second;
  if (auto it = materials.find(material); it != materials.end()) return it->second;
  return fallback;
}

const char* consistencyOf(double viscosity_Pas) {
  return kConsistencies[(viscosity_Pas >= 0.05) + (viscosity_Pas >= 0.35) +
                        (viscosity_Pas >= 1.75)];
}

const Material& RenderPreset::bolusFor(double viscosity_Pas) const {
  const auto it = bolusByConsistency.find(consistencyOf(viscosity_Pas));
  return it == bolusByConsistency.end() ? bolus : it->second;
}

namespace {
std::string validateView(const std::string& name, const ViewDef& v) {
  const Vec3 gaze = v.eye_m - v.target_m;
  if (gaze.norm() < 1e-6 || gaze.normalized().cross(v.up).norm() < 1e-6)
    return fmt::format("view '{}': eye, target and up must span a plane", name);
  if (v.fovY_rad <= 0 || v.fovY_rad >= kPi || v.orthoHeight_m <= 0)
    return fmt::format("view '{}': the field of view must be 0..180 deg and a height > 0", name);
  for (const ClipRule& c : v.cuts)
    if (c.normal.norm() < 1e-6) return fmt::format("view '{}': a cut has no direction", name);
  for (const auto& [structure, opacity] : v.ghosted)
    if (opacity < 0 || opacity > 1)
      return fmt::format("view '{}': opacity of '{}' is {}, not 0..1", name, structure, opacity);
  return "";
}
}  // namespace

std::string RenderPreset::validate() const {
  if (width < 16 || height < 16 || width > 8192 || height > 8192 || width % 2 || height % 2)
    return fmt::format("picture of {} x {}: both must be even and 16..8192", width, height);
  if (fps < 30) return fmt::format("{} frames/s: below 30 the pulse rate changes scores", fps);
  if (ao.taps < 4 || ao.taps > 32) return fmt::format("ao taps {} not in 4..32", ao.taps);
  if (light.shadowMap_px < 64 || light.shadowMap_px > 4096)
    return fmt::format("shadow map of {} px not in 64..4096", light.shadowMap_px);
  if (light.key.direction.norm() < 1e-6f || light.fill.direction.norm() < 1e-6f)
    return "a light has no direction";
  if (fluoro.black <= fluoro.white)
    return fmt::format("fluoro window from {} to {}: black must lie deeper than white",
                       fluoro.white, fluoro.black);
  if (views.empty()) return "no views";
  for (const auto& [key, view] : views)
    if (auto wrong = validateView(key, view); !wrong.empty()) return wrong;
  return "";
}
}  // namespace swallowclip::render
