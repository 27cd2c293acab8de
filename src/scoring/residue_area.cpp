// SPDX-License-Identifier: MIT
#include "scoring/residue_area.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "scoring/midline.h"
#include "scoring/spine.h"

namespace swallowclip::scoring {
namespace {
using frame::History;
using frame::Wall;

constexpr double kPixel_m = 0.25e-3;  // of the projection; assumed, 0.1-0.5 mm
constexpr const char* kNoBolus = "the history has no bolus";

/// Columns of the skin's moving or fixed sheet: vertices of equal u, s rising.
std::map<int, std::vector<int>> columns(const frame::SkinTrack& skin, bool moving, double from_m,
                                        double to_m, double leastU) {
  std::map<int, std::vector<int>> out;
  for (std::size_t v = 0; v < skin.wall.size(); ++v) {
    const bool tissue = moving ? skin.wall[v] == Wall::tongue || skin.wall[v] == Wall::larynx
                               : skin.wall[v] == Wall::posterior;
    if (!tissue || skin.s_m[v] < from_m || skin.s_m[v] > to_m || std::abs(skin.u[v]) < leastU)
      continue;
    out[static_cast<int>(std::lround(skin.u[v] * 1e4))].push_back(static_cast<int>(v));
  }
  for (auto& [u, column] : out) {
    std::stable_sort(column.begin(), column.end(),
                     [&](int a, int b) { return skin.s_m[a] < skin.s_m[b]; });
    // A branch repeats the s of its rim, with vertices that come after those of the sheet.
    const auto branch = std::unique(column.begin(), column.end(), [&](int a, int b) {
      return skin.s_m[b] - skin.s_m[a] <= kSameStation_m;
    });
    column.erase(branch, column.end());
  }
  return out;
}

Vec2 sagittal(const Vec3f& p) {
  return {p.y(), p.z()};
}
}  // namespace

double projectedArea_m2(const std::vector<Deposit>& drops, double chord_m) {
  std::map<std::pair<int, int>, double> chords;  // pixel -> way through contrast
  for (const Deposit& d : drops) {
    if (d.film_m > 0) continue;
    const double r = std::cbrt(3 * d.volume_m3 / (4 * kPi));
    const int reach = static_cast<int>(std::ceil(r / kPixel_m));
    const int cy = static_cast<int>(std::floor(d.position.y() / kPixel_m));
    const int cz = static_cast<int>(std::floor(d.position.z() / kPixel_m));
    for (int y = cy - reach; y <= cy + reach; ++y)
      for (int z = cz - reach; z <= cz + reach; ++z) {
        const double dy = (y + 0.5) * kPixel_m - d.position.y();
        const double dz = (z + 0.5) * kPixel_m - d.position.z();
        const double left = r * r - dy * dy - dz * dz;
        if (left > 0) chords[{y, z}] += 2 * std::sqrt(left);
      }
  }
  const auto seen =
      std::ranges::count_if(chords, [&](const auto& c) { return c.second >= chord_m; });
  return static_cast<double>(seen) * kPixel_m * kPixel_m;
}

double pocketArea_m2(const std::vector<Vec2>& outline) {
  if (outline.size() < 3) return 0;
  const auto lower = [](const Vec2& a, const Vec2& b) { return a.y() < b.y(); };
  const auto floor = std::min_element(outline.begin(), outline.end(), lower);
  const double before = std::max_element(outline.begin(), floor + 1, lower)->y();
  const double after = std::max_element(floor, outline.end(), lower)->y();
  const double level = std::min(before, after);
  double area = 0;
  for (std::size_t k = 1; k < outline.size(); ++k) {
    double y0 = outline[k - 1].x(), y1 = outline[k].x();
    double d0 = level - outline[k - 1].y(), d1 = level - outline[k].y();
    if (d0 <= 0 && d1 <= 0) continue;
    const double cut = d0 == d1 ? 0 : d0 / (d0 - d1);  // where the outline leaves the level
    if (d0 < 0) y0 += cut * (y1 - y0), d0 = 0;
    if (d1 < 0) y1 = y0 + cut * (y1 - y0), d1 = 0;
    area += 0.5 * (d0 + d1) * (y1 - y0);
  }
  return std::abs(area);
}

double valleculaSpace_m2(const History& h, int frame, const ScoringRules& rules) {
  constexpr double kAbove_m = 8e-3;  // of tongue base before the pocket; assumed, 4-12 mm
  double largest = 0;
  for (const auto& [u, column] :
       columns(h.skin, true, rules.valleculaTop_m - kAbove_m, rules.valleculaEnd_m, 0)) {
    std::vector<Vec2> outline;
    for (int v : column) outline.push_back(sagittal(h.skin.positions[frame][v]));
    largest = std::max(largest, pocketArea_m2(outline));
  }
  return largest;
}

double pyriformSpace_m2(const History& h, int frame, const ScoringRules& rules) {
  // Front wall down, back wall up again: the larynx' side and the pharynx' of the same column.
  const auto front =
      columns(h.skin, true, rules.pyriformTop_m, rules.pyriformEnd_m, rules.pyriformU);
  const auto back =
      columns(h.skin, false, rules.pyriformTop_m, rules.pyriformEnd_m, rules.pyriformU);
  double largest = 0;
  for (const auto& [u, column] : front) {
    const auto wall = back.find(u);
    if (wall == back.end()) continue;
    std::vector<Vec2> outline;
    for (int v : column) outline.push_back(sagittal(h.skin.positions[frame][v]));
    for (auto v = wall->second.rbegin(); v != wall->second.rend(); ++v)
      outline.push_back(sagittal(h.skin.positions[frame][*v]));
    largest = std::max(largest, pocketArea_m2(outline));
  }
  return largest;
}

std::vector<Quantity> measureResidueAreas(const History& h, const std::optional<Residue>& residue,
                                          const ScoringRules& rules) {
  std::vector<Quantity> out;
  const int frame = residue ? residue->frame : -1;
  const auto add = [&](std::string name, double value, const char* unit, std::string rule) {
    Quantity q{std::move(name), {}, unit, -1, std::move(rule), kNoBolus};
    if (residue) q.reason = "no such pocket in this scene", set(q, value, frame);
    out.push_back(std::move(q));
  };
  const double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (int k = 0; k < kLocations; ++k) {
    const auto at = static_cast<Location>(k);
    const double volume = residue ? residue->volume_m3(at) : 0;
    const std::string where = std::string("residue_") + name(at);
    add(where, volume * 1e6, "mL", "left there, particles and film");
    add(where + "_share", residue && residue->offered_m3 > 0 ? volume / residue->offered_m3 : kNaN,
        "share", "of V0");
  }
  const double c2c4_m = residue ? spineAt(h, frame).c2c4_m : 1;
  const auto percent = [&](double area_m2) { return 100 * area_m2 / (c2c4_m * c2c4_m); };
  struct Pocket {
    const char* name;
    Location left, right;
    double space_m2;
  };
  const Pocket pockets[] = {{"valleculae", Location::valleculaLeft, Location::valleculaRight,
                             residue ? valleculaSpace_m2(h, frame, rules) : 0},
                            {"pyriforms", Location::pyriformLeft, Location::pyriformRight,
                             residue ? pyriformSpace_m2(h, frame, rules) : 0}};
  const auto areaOf = [&](auto chosen) {
    std::vector<Deposit> drops;
    if (residue) std::ranges::copy_if(residue->deposits, std::back_inserter(drops), chosen);
    return projectedArea_m2(drops, rules.visibleChord_m);
  };
  double total = areaOf([](const Deposit& d) {
    return componentOf(d.location) == 16 && d.location != Location::valleculaLeft &&
           d.location != Location::valleculaRight && d.location != Location::pyriformLeft &&
           d.location != Location::pyriformRight;
  });
  for (const Pocket& p : pockets) {
    const double area =
        areaOf([&](const Deposit& d) { return d.location == p.left || d.location == p.right; });
    total += area;
    const double full = p.space_m2 > 0 ? area / p.space_m2 : kNaN;
    const std::string name = p.name;
    add(name + "_space", p.space_m2 > 0 ? p.space_m2 * 1e6 : kNaN, "mm2",
        "pocket under the level line through its lower rim, lateral view");
    add(name + "_percent_full", 100 * full, "%", "area of contrast over that of the pocket");
    add(name + "_percent_c2c4", percent(area), "%(C2-4)2", "area of contrast over (C2-C4)^2");
    add(name + "_nrrs", full * 10 * area / (c2c4_m * c2c4_m), "",
        "normalised residue ratio: share full * 10 * area / (C2-C4)^2 (Pearson 2013)");
  }
  add("residue_percent_c2c4", percent(total), "%(C2-4)2",
      "valleculae, pyriforms and the rest of the pharynx together");
  return out;
}
}  // namespace swallowclip::scoring
