// SPDX-License-Identifier: MIT
#include "scoring/closures.h"

#include <fmt/format.h>

#include <algorithm>

#include "scoring/clearance.h"
#include "scoring/events.h"

namespace swallowclip::scoring {
namespace {
using frame::History;
using frame::Region;

bool sealed(double ratio, double gap_m, const ScoringRules& r) {
  return ratio < r.sealedRatio || gap_m < r.sealed_m;
}

int narrowest(const std::vector<double>& gap, int from) {
  return static_cast<int>(std::min_element(gap.begin() + from, gap.end()) - gap.begin());
}

int countIn(const frame::BolusTrack& b, int frame, Region region, double before_y) {
  int n = 0;
  for (std::size_t k = 0; k < b.region[frame].size(); ++k)
    n += b.region[frame][k] == region && isThere(b.state[frame][k]) &&
         b.positions[frame][k].y() < before_y;
  return n;
}
constexpr double kAnywhere = 1e9;
}  // namespace

std::optional<int> scoreComponent7(const Component7Measures& m, const ScoringRules& r) {
  if (m.nasal >= r.nasalShare) return 3;
  if (m.nasopharynx >= r.nasalShare) return 2;
  return sealed(m.ratio, m.gap_m, r) ? 0 : 1;
}

ComponentReport measureComponent7(const History& h, const LumenProfile& lumen,
                                  const ScoringRules& rules) {
  ComponentReport out;
  const int rest = cueFrame(h);
  const std::string lack = "the skin has no nasopharyngeal branch";
  Quantity gap{"velar_gap_ratio",
               {},
               "ratio",
               -1,
               "least width of the velopharyngeal port over that at the cue",
               lack};
  Quantity most{
      "nasopharynx_most",        {}, "share", -1, "most of V0 in the nasopharynx at any frame",
      "the history has no bolus"};
  Component7Measures m;
  if (hasBolus(h)) {
    const double all = static_cast<double>(h.bolus.s_m.front().size());
    int at = rest;
    for (int f = 0; f < h.frames(); ++f) {
      const double share = countIn(h.bolus, f, Region::nasopharynx, kAnywhere) / all;
      if (share > m.nasopharynx) m.nasopharynx = share, at = f;
      m.nasal = std::max(m.nasal, countIn(h.bolus, f, Region::nasopharynx, 0) / all);
    }
    set(most, m.nasopharynx, at);
  }
  out.decision.reason = "soft palate: " + lack;
  if (!lumen.port_m.empty() && lumen.port_m[rest] > 0) {
    const int at = narrowest(lumen.port_m, rest);
    m.gap_m = lumen.port_m[at], m.ratio = m.gap_m / lumen.port_m[rest];
    set(gap, m.ratio, at);
    out.decision =
        decide([&](const ScoringRules& r) { return scoreComponent7(m, r); }, rules,
               fmt::format("port {:.2f} mm, {:.3f} of rest; {:.1f} % above it (this scene "
                           "has no nostril, so no score 4)",
                           m.gap_m * 1e3, m.ratio, 100 * m.nasopharynx));
    out.frame = at;
    out.series.push_back(inMillimetres("velar_gap", lumen.port_m));
  }
  out.quantities = {gap, most};
  out.liveSeries = "velar_gap";
  return out;
}

std::optional<int> scoreComponent11(const Component11Measures& m, const ScoringRules& r) {
  if (m.ratio > r.vestibuleNarrow) return 2;
  const bool dry = m.particles < r.leastParticles;
  return sealed(m.ratio, m.gap_m, r) && dry ? 0 : 1;
}

ComponentReport measureComponent11(const History& h, const LumenProfile& lumen,
                                   const ScoringRules& rules) {
  ComponentReport out;
  const int rest = cueFrame(h);
  const std::vector<double> gap = lumen.vestibule_m.empty() ? vestibuleGap_m(h) : lumen.vestibule_m;
  Quantity ratio{"vestibule_narrowest",
                 {},
                 "ratio",
                 -1,
                 "least vestibule width over its width at the cue",
                 "neither a laryngeal branch nor its landmarks"};
  Quantity wet{"airway_at_closure",       {}, "count", -1, "particles in the larynx at that frame",
               "the history has no bolus"};
  out.decision.reason = "vestibular closure: " + ratio.reason;
  if (!gap.empty() && gap[rest] > 0) {
    const int at = narrowest(gap, rest);
    Component11Measures m{gap[at] / gap[rest], gap[at], 0};
    if (hasBolus(h)) {
      m.particles = countIn(h.bolus, at, Region::larynx, kAnywhere);
      set(wet, m.particles, at);
    }
    set(ratio, m.ratio, at);
    out.decision =
        decide([&](const ScoringRules& r) { return scoreComponent11(m, r); }, rules,
               fmt::format("narrowest {:.3f} of rest, {} particles in it", m.ratio, m.particles));
    out.frame = at;
  }
  out.quantities = {ratio, wet};
  out.liveSeries = "vestibule_gap";
  return out;
}
}  // namespace swallowclip::scoring
