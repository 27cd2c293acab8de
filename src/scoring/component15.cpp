// SPDX-License-Identifier: MIT
#include "scoring/component15.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scoring/events.h"
#include "scoring/midline.h"
#include "scoring/profile.h"
#include "scoring/series.h"
#include "scoring/spine.h"

namespace swallowclip::scoring {
namespace {
using frame::History;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kLevel_m = 1e-3;  // between level lines; assumed, 0.5-2 mm
constexpr int kLeastLevels = 5;    // of 21; assumed, 3-10

struct Chains {
  std::vector<int> tongue, wall;
};

Chains chainsOf(const frame::SkinTrack& skin) {
  const MidlineColumns mid = findMidline(skin);
  Chains c;
  for (int v : mid.lower)
    if (skin.wall[v] == frame::Wall::tongue) c.tongue.push_back(v);
  for (int v : mid.upper)
    if (skin.wall[v] == frame::Wall::posterior) c.wall.push_back(v);
  return c;
}

/// Height between C2 and C3 above C4's corner.
double middleHeight_m(const History& h, const Spine& spine) {
  const auto *above = wholeLandmark(h, "C2_anterior_inferior"),
             *below = wholeLandmark(h, "C3_anterior_superior");
  if (above && below)
    return 0.5 * (spine.height_m(above->positions[0].cast<double>()) +
                  spine.height_m(below->positions[0].cast<double>()));
  return spine.c2c4_m;
}
}  // namespace

TongueBase measureTongueBase(const History& h, int rest, const ScoringRules& rules) {
  TongueBase out;
  const Chains chains = chainsOf(h.skin);
  const int levels = static_cast<int>(std::lround(rules.baseHeight_m / kLevel_m)) + 1;
  const auto tongueAt = [&](int frame, std::vector<double>* gaps) {
    const Spine spine = spineAt(h, frame);
    const double middle = middleHeight_m(h, spine);
    std::vector<double> at;
    for (int k = 0; k < levels; ++k) {
      const double height = middle + (k - 0.5 * (levels - 1)) * kLevel_m;
      at.push_back(crossingForward_m(chains.tongue, h.skin.positions[frame], spine, height, true));
      const double wall =
          crossingForward_m(chains.wall, h.skin.positions[frame], spine, height, false);
      if (gaps && std::isfinite(at.back() - wall)) gaps->push_back(at.back() - wall);
    }
    return at;
  };
  const auto enough = [](const std::vector<double>& x) {
    return static_cast<int>(x.size()) >= kLeastLevels ? median(x) : kNaN;
  };
  const std::vector<double> still = tongueAt(rest, nullptr);
  for (int f = 0; f < h.frames(); ++f) {
    std::vector<double> gaps, travel;
    const std::vector<double> now = tongueAt(f, &gaps);
    for (int k = 0; k < levels; ++k)
      if (std::isfinite(still[k] - now[k])) travel.push_back(still[k] - now[k]);
    out.gap_m.push_back(enough(gaps));
    out.travel_m.push_back(enough(travel));
  }
  return out;
}

std::optional<int> scoreComponent15(const Component15Measures& m, const ScoringRules& r) {
  if (m.travelRatio < r.baseMoves) return 4;
  if (m.ratio > r.narrowRatio) return 3;
  if (m.ratio > r.traceRatio) return 2;
  if (m.ratio >= r.sealedRatio && m.gap_m >= r.sealed_m) return 1;
  return 0;
}

ComponentReport measureComponent15(const History& h, const ScoringRules& rules) {
  ComponentReport out;
  const int rest = cueFrame(h);
  const TongueBase base = measureTongueBase(h, rest, rules);
  int most = -1;
  for (int f = rest; f < h.frames(); ++f)
    if (std::isfinite(base.travel_m[f]) && (most < 0 || base.travel_m[f] > base.travel_m[most]))
      most = f;
  const std::string lack =
      "the skin shows no tongue base before a posterior wall between C2 and C3";
  const std::string where = fmt::format(
      "over {:g} mm of height centred between C2 and C3, at the greatest retraction of the tongue "
      "base (within {:g} mm of it, where the gap is least)",
      rules.baseHeight_m * 1e3, rules.baseTie_m * 1e3);
  Quantity gap{"tongue_base_gap",
               {},
               "mm",
               -1,
               "median AP gap of tongue base and posterior wall " + where,
               lack,
               {}};
  Quantity ratio{
      "tongue_base_gap_ratio", {}, "ratio", -1, "the same over its value at the cue", lack, {}};
  Quantity travel{"tongue_base_travel_ratio",
                  {},
                  "ratio",
                  -1,
                  fmt::format("most that the tongue base has come back since the cue (median over "
                              "the height) over {:g} mm",
                              rules.normalTongueBase_m * 1e3),
                  lack,
                  {}};
  if (most >= 0 && std::isfinite(base.gap_m[rest]) && base.gap_m[rest] > 0) {
    int at = most;
    for (int f = rest; f < h.frames(); ++f)
      if (base.travel_m[f] >= base.travel_m[most] - rules.baseTie_m &&
          (base.gap_m[f] < base.gap_m[at] || !std::isfinite(base.gap_m[at])))
        at = f;
    const Component15Measures m{base.gap_m[at], base.gap_m[at] / base.gap_m[rest],
                                base.travel_m[most] / rules.normalTongueBase_m};
    out.frame = at;
    set(gap, m.gap_m * 1e3, at), set(ratio, m.ratio, at), set(travel, m.travelRatio, most);
    out.decision =
        decide([&](const ScoringRules& r) { return scoreComponent15(m, r); }, rules,
               fmt::format("gap {:.2f} mm, {:.3f} of {:.1f} mm at rest; travel {:.2f} of normal",
                           m.gap_m * 1e3, m.ratio, base.gap_m[rest] * 1e3, m.travelRatio));
  } else {
    out.decision.reason = "tongue base: " + lack;
  }
  out.quantities = {gap, ratio, travel};
  out.liveSeries = "tongue_base_gap";
  out.series = {inMillimetres("tongue_base_gap", base.gap_m),
                inMillimetres("tongue_base_travel", base.travel_m)};
  return out;
}
}  // namespace swallowclip::scoring
