// SPDX-License-Identifier: MIT
#include "scene/lumen_file.h"

#include "scene/curves.h"

namespace swallowclip::scene {
namespace {
constexpr double kMm = kMetrePerMm;
}

Result<anatomy::LumenDef> loadLumenDef(const std::filesystem::path& path) {
  auto file = JsonFile::load(path);
  if (!file) return std::unexpected(file.error());
  const JsonNode j = file->root();
  anatomy::LumenDef d;
  const auto length = [&](const char* key, double fallback_m) {
    return j.number(key, 0.01, 400, fallback_m / kMm) * kMm;
  };
  d.length_m = length("length_mm", d.length_m);
  d.velumStart_m = length("velum_start_mm", d.velumStart_m);
  d.uvula_m = length("uvula_mm", d.uvula_m);
  d.wallStart_m = length("wall_start_mm", d.wallStart_m);
  d.epiglottisTip_m = length("epiglottis_tip_mm", d.epiglottisTip_m);
  d.arytenoid_m = length("arytenoid_mm", d.arytenoid_m);
  d.tongueEnd_m = length("tongue_end_mm", d.tongueEnd_m);
  d.uesStart_m = length("ues_start_mm", d.uesStart_m);
  d.rowStep_m = j.number("row_step_mm", 0.5, 5, d.rowStep_m / kMm) * kMm;
  d.closedGap_m = length("closed_gap_mm", d.closedGap_m);
  d.columns = j.integer("columns", 9, 101, d.columns);
  if (d.columns % 2 == 0)
    j.member("columns").fail("must be odd, so that one column lies on the midline", "Add one.");
  std::tie(d.roofY, d.roofZ) = std::tuple_cat(readCurvePair(j, "roof_s_y_z_mm", kMm, kMm));
  std::tie(d.raisedVelumY, d.raisedVelumZ) =
      std::tuple_cat(readCurvePair(j, "raised_velum_s_y_z_mm", kMm, kMm));
  d.halfWidth = readCurve(j, "half_width_s_mm", kMm, kMm);
  d.arch = readCurve(j, "arch_s_mm", kMm, kMm);
  d.restGap = readCurve(j, "rest_gap_s_mm", kMm, kMm);
  d.velumThickness = readCurve(j, "velum_thickness_s_mm", kMm, kMm);
  d.nasalWallY = readCurve(j, "nasal_wall_z_y_mm", kMm, kMm);
  std::tie(d.inletFrontY, d.inletFrontZ) =
      std::tuple_cat(readCurvePair(j, "inlet_depth_front_y_z_mm", 1, kMm));
  std::tie(d.inletBackY, d.inletBackZ) =
      std::tuple_cat(readCurvePair(j, "inlet_depth_back_y_z_mm", 1, kMm));
  d.inletHalfWidth = readCurve(j, "inlet_depth_half_width_mm", 1, kMm);
  const std::vector<std::pair<const char*, double>> order{
      {"velum_start_mm", d.velumStart_m},       {"uvula_mm", d.uvula_m},
      {"wall_start_mm", d.wallStart_m},         {"tongue_end_mm", d.tongueEnd_m},
      {"epiglottis_tip_mm", d.epiglottisTip_m}, {"arytenoid_mm", d.arytenoid_m},
      {"ues_start_mm", d.uesStart_m},           {"length_mm", d.length_m}};
  for (std::size_t i = 1; i < order.size(); ++i)
    if (!(order[i].second > order[i - 1].second))
      j.fail(fmt::format("'{}' must be larger than '{}'", order[i].first, order[i - 1].first),
             "Landmarks of the path come in anatomical order.");
  if (auto done = file->finish(); !done) return std::unexpected(done.error());
  return d;
}

Result<anatomy::SoftDef> loadSoftDef(const std::filesystem::path& path) {
  auto file = JsonFile::load(path);
  if (!file) return std::unexpected(file.error());
  const JsonNode j = file->root();
  anatomy::SoftDef d;
  d.tongueBreadth_m = j.number("tongue_breadth_mm", 20, 100, 51.9) * kMm;
  d.wallThickness_m = j.number("wall_thickness_mm", 0.5, 8, 3) * kMm;
  d.mucosaThickness_m = j.number("mucosa_thickness_mm", 0.3, 5, 1.5) * kMm;
  std::tie(d.tongueFloorY, d.tongueFloorZ) =
      std::tuple_cat(readCurvePair(j, "tongue_floor_s_y_z_mm", kMm, kMm));
  d.tongueHalfWidth = readCurve(j, "tongue_half_width_s_mm", kMm, kMm);
  if (auto done = file->finish(); !done) return std::unexpected(done.error());
  return d;
}
}  // namespace swallowclip::scene
