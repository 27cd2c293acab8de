// SPDX-License-Identifier: MIT
#include "anatomy/oral_mucosa.h"

#include <algorithm>
#include <cmath>

#include "anatomy/rigid_parts.h"
#include "core/curve.h"

namespace swallowclip::anatomy {
namespace {
constexpr double kClear_m = 5e-5;     // never in front of the vault; assumed, 0.02-0.1 mm
constexpr double kInBone_m = 1.2e-3;  // the hidden back, above the bone's face; assumed, 1-2 mm
constexpr double kRugaHalf_m = 9e-4;  // half breadth of a ruga at 1/e; assumed, 0.6-1.2 mm
constexpr double kRugaSweep = 0.18;   // rugae run this much forwards per metre sideways; assumed
constexpr double kRaphe_m = 1.2e-3;   // half breadth of the median raphe; assumed, 0.8-1.6 mm
constexpr double kPapilla_m = 5e-4;   // how far gum papillae reach towards the tips; assumed

double bump(double x) {
  return std::exp(-x * x);
}
}  // namespace

double palateRecess_m(const PalateDef& palate, double x_m, double y_m) {
  if (palate.rugaeY_m.empty()) return kClear_m;
  const double x = std::abs(x_m), share = x / interpolate(palate.halfWidth_m, y_m);
  double crest = 0;
  for (std::size_t k = 0; k < palate.rugaeY_m.size(); ++k) {
    // wavy and unlike each other, as rugae are
    const double wave = 7e-4 * std::sin(x / 2.1e-3 + 1.7 * static_cast<double>(k));
    const double at = palate.rugaeY_m[k] - kRugaSweep * x + wave;
    const double reach = 0.62 + 0.12 * std::cos(2.3 * static_cast<double>(k));
    crest = std::max(crest, bump((y_m - at) / kRugaHalf_m) * smoothstep((x - 0.6e-3) / 1e-3) *
                                (1 - smoothstep((share - reach) / 0.2)));
  }
  crest = std::max(crest, 0.8 * bump(x / kRaphe_m));
  const double front = palate.rugaeY_m.front(), back = palate.rugaeY_m.back();
  const double zone = plateau(y_m, front - 4e-3, front - 1.5e-3, back + 2e-3, back + 7e-3) *
                      (1 - smoothstep((share - 0.7) / 0.3));
  const double raphe = 0.25 * (1 - zone);  // a shallow groove either side all the way back
  return kClear_m + palate.rugaDepth_m *
                        (zone * (1 - crest) + raphe * (1 - bump(x / kRaphe_m)) * bump(x / 6e-3));
}

Result<HalfSurface> palateMucosa(const PalateDef& palate) {
  if (palate.oralMidline_m.size() < 2 || palate.halfWidth_m.empty())
    return usageError("structure " + palate.mucosaName, "the palate has no midline or half width",
                      "give oral_midline_yz_mm and half_width_yw_mm");
  constexpr int kAcross = 11;  // points from the raphe to the lingual crest, on either face
  const double front = palate.oralMidline_m.front().x() + 1.5e-3, back = 0;
  const double fineTo = palate.rugaeY_m.empty() ? front : palate.rugaeY_m.back() + 3e-3;
  HalfSurface surface;
  std::vector<Ring> rows;
  for (double y = front; y < back + 1e-9; y += y < fineTo ? 1e-3 : 4e-3) {
    const double w = 1.02 * interpolate(palate.halfWidth_m, y);
    std::vector<Vec3> row;
    for (int k = 0; k < kAcross; ++k) {
      const double x = w * k / (kAcross - 1);
      const double z = palateMucosaZ_m(palate, x, y) + palateRecess_m(palate, x, y);
      row.push_back({x, y, std::max(z, palate.lowest_m - palate.mucosa_m)});
    }
    for (int k = kAcross - 1; k >= 0; --k) {
      const double x = w * k / (kAcross - 1), z = palateMucosaZ_m(palate, x, y);
      row.push_back(
          {x, y, std::max(z, palate.lowest_m - palate.mucosa_m) + palate.mucosa_m + kInBone_m});
    }
    rows.push_back(surface.addRow(row));
  }
  surface.loft(rows, false, {});
  surface.capFold(Ring(rows.front().rbegin(), rows.front().rend()));  // faces forwards
  surface.capFold(rows.back());
  return surface;
}

Result<HalfSurface> gum(const DentalArchDef& arch) {
  const auto places = toothPlaces(arch);
  if (!places) return std::unexpected(places.error());
  const PlanCurve plan(arch.lingualPlan_m);
  const double up = arch.upper ? -1 : 1;  // towards the tips
  HalfSurface surface;
  std::vector<Ring> rows;
  const double end = places->back().s_m + arch.teeth.back().width_m / 2 + 1.5e-3;
  const int count = 2 + static_cast<int>(arch.teeth.size()) * 3;
  for (int r = 0; r < count; ++r) {
    const double s = end * r / (count - 1);
    // depth and neck of the arch here, from the two teeth around it; how far between teeth
    std::size_t next = 0;
    while (next < places->size() && (*places)[next].s_m < s) ++next;
    const std::size_t a = next > 0 ? next - 1 : 0, b = std::min(next, places->size() - 1);
    const double from = (*places)[a].s_m, to = (*places)[b].s_m;
    const double f = b > a ? smoothstep((s - from) / (to - from)) : 0;
    const double depth = (1 - f) * arch.teeth[a].depth_m + f * arch.teeth[b].depth_m;
    const double neck = (1 - f) * (*places)[a].cervix.z() + f * (*places)[b].cervix.z();
    double off = std::min(std::abs(s - from) / arch.teeth[a].width_m,
                          std::abs(to - s) / arch.teeth[b].width_m);
    if (next == 0) off = (from - s) / arch.teeth[0].width_m;  // before the first: the midline
    off = std::min(1.0, 2 * std::abs(off));
    const double margin = neck + up * (arch.gumMargin_m + kPapilla_m * (4 * off * off - 1));
    const double thin = r + 1 == count ? 0.5 : 1;
    // (outwards from the lingual face, towards the tip from the margin), round the band
    const std::vector<Vec2> kBand{{0.45, -6.5e-3},    {-0.4e-3, -5.2e-3}, {-0.5e-3, -2.6e-3},
                                  {-0.3e-3, -0.6e-3}, {0.2e-3, 0},        {1.6e-3, -0.8e-3},
                                  {-1.6e-3, -0.8e-3}, {-0.1e-3, 0},       {1.1e-3, -0.7e-3},
                                  {2.0e-3, -2.8e-3},  {2.3e-3, -5.6e-3}};
    const auto [p, along] = plan.at(s);
    const Vec2 outwards(along.y(), -along.x());
    std::vector<Vec3> row;
    for (std::size_t k = 0; k < kBand.size(); ++k) {
      const double r0 = k == 0 ? 0.45 * depth : k < 6 ? kBand[k].x() : depth + kBand[k].x();
      const double out = 0.5 * depth + thin * (r0 - 0.5 * depth);
      row.push_back(
          {p.x() + out * outwards.x(), p.y() + out * outwards.y(), margin + up * kBand[k].y()});
      if (r == 0) row.back().x() = 0;
    }
    rows.push_back(surface.addRow(row));
  }
  surface.loft(rows, true, {});
  Vec3 pole = Vec3::Zero();
  for (int v : rows.back()) pole += surface.position(v) / static_cast<double>(rows.back().size());
  surface.capPole(rows.back(), true, surface.addVertex(pole), true);
  return surface;
}
}  // namespace swallowclip::anatomy
