// SPDX-License-Identifier: MIT
#include "scoring/component12.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scoring/events.h"
#include "scoring/midline.h"
#include "scoring/profile.h"
#include "scoring/spine.h"

namespace swallowclip::scoring {
namespace {
using frame::History;
constexpr std::array<const char*, kWallLevels> kLevels{"C2", "C3", "C4"};

/// Tissue of the back wall at one level. It rises with the shortening pharynx.
struct Level {
  std::vector<double> way_m;  ///< [frame] forward of where the wall stood at the cue, same height
  std::vector<double> height_m;  ///< [frame] along the spine
};

Level levelOf(const History& h, const std::vector<int>& wall, double s_m, int rest) {
  const auto nearer = [&](int a, int b) {
    return std::abs(h.skin.s_m[a] - s_m) < std::abs(h.skin.s_m[b] - s_m);
  };
  const int vertex = *std::min_element(wall.begin(), wall.end(), nearer);
  const Spine still = spineAt(h, rest);
  Level out;
  for (int f = 0; f < h.frames(); ++f) {
    const Spine spine = spineAt(h, f);
    const Vec3 now = h.skin.positions[f][vertex].cast<double>();
    out.height_m.push_back(spine.height_m(now));
    out.way_m.push_back(spine.forward_m(now) - crossingForward_m(wall, h.skin.positions[rest],
                                                                 still, out.height_m[f], false));
  }
  return out;
}

/// When a level is farthest forward, between frames: top of the parabola through three of them. The
/// wave needs some three frames from C2 to C4, so whole frames would leave a third to chance.
double crestTime_s(const History& h, const std::vector<double>& way, int most) {
  if (most < 1 || most + 1 >= h.frames()) return h.time_s[most];
  const double a = way[most - 1], b = way[most], c = way[most + 1], bend = a - 2 * b + c;
  if (!(bend < 0)) return h.time_s[most];
  return h.time_s[most] + 0.25 * (a - c) / bend * (h.time_s[most + 1] - h.time_s[most - 1]);
}
}  // namespace

std::optional<int> scoreComponent12(const Component12Measures& m, const ScoringRules& r) {
  const auto all = [&](auto test) { return std::ranges::all_of(m.excursion, test); };
  if (all([&](double e) { return e < r.waveNone; })) return 2;
  const bool runs =
      m.crest_ms && *m.crest_ms >= r.waveSlowest_ms && *m.crest_ms <= r.waveFastest_ms;
  return runs && all([&](double e) { return e >= r.waveFull; }) ? 0 : 1;
}

ComponentReport measureComponent12(const History& h, const ScoringRules& rules) {
  ComponentReport out;
  const int rest = cueFrame(h);
  const std::array normal{rules.normalWallC2_m, rules.normalWallC3_m, rules.normalWallC4_m};
  const std::array level{rules.wallC2_m, rules.wallC3_m, rules.wallC4_m};
  std::vector<int> wall;
  for (int v : findMidline(h.skin).upper)
    if (h.skin.wall[v] == frame::Wall::posterior) wall.push_back(v);
  Component12Measures m;
  std::array<int, kWallLevels> crest{};
  std::array<double, kWallLevels> crest_s{}, crestHeight_m{};
  std::string lack;
  for (int k = 0; k < kWallLevels; ++k) {
    Quantity q{fmt::format("wall_excursion_{}", k + 2),
               {},
               "ratio",
               -1,
               fmt::format("largest way of the back wall at s = {:g} mm (level with {} at rest) "
                           "forward of where it stood, over {:g} mm",
                           level[k] * 1e3, kLevels[k], normal[k] * 1e3),
               "the skin has no midline of the back wall"};
    const Level tissue = wall.empty() ? Level() : levelOf(h, wall, level[k], rest);
    const std::vector<double>& way = tissue.way_m;
    double most = -1;
    for (int f = rest; f < static_cast<int>(way.size()); ++f)
      if (std::isfinite(way[f]) && way[f] > most) most = way[f], crest[k] = f;
    if (most >= 0) {
      m.excursion[k] = most / normal[k];
      set(q, m.excursion[k], crest[k]);
      crest_s[k] = crestTime_s(h, way, crest[k]);
      crestHeight_m[k] = tissue.height_m[crest[k]];
      out.series.push_back(inMillimetres(fmt::format("wall_excursion_{}", kLevels[k]), way));
    } else {
      lack = q.reason;
    }
    out.quantities.push_back(q);
  }
  Quantity speed{
      "wave_crest_speed",
      {},
      "mm/s",
      -1,
      "way down the spine, as the vertebrae see it, from the crest at the tissue of C2 to that at "
      "the tissue of C4 over the time between them",
      "the crests do not run from C2 over C3 to C4"};
  if (lack.empty() && crest_s[0] <= crest_s[1] && crest_s[1] <= crest_s[2] &&
      crest_s[0] < crest_s[2]) {
    m.crest_ms = (crestHeight_m[0] - crestHeight_m[2]) / (crest_s[2] - crest_s[0]);
    set(speed, *m.crest_ms * 1e3, crest[2]);
  }
  out.quantities.push_back(speed);
  if (lack.empty())
    out.decision =
        decide([&](const ScoringRules& r) { return scoreComponent12(m, r); }, rules,
               fmt::format("wall comes {:.2f}, {:.2f}, {:.2f} of normal at C2, C3, C4; {}",
                           m.excursion[0], m.excursion[1], m.excursion[2],
                           m.crest_ms ? fmt::format("crest {:.0f} mm/s", *m.crest_ms * 1e3)
                                      : "crests not downwards"));
  else
    out.decision.reason = "stripping wave: " + lack;
  out.frame = crest[1];
  out.liveSeries = "wall_excursion_C3";
  return out;
}
}  // namespace swallowclip::scoring
