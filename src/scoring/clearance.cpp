// SPDX-License-Identifier: MIT
#include "scoring/clearance.h"

#include <fmt/format.h>

#include <array>

#include "scoring/series.h"

namespace swallowclip::scoring {
namespace {
using frame::ParticleState;
using frame::Region;

constexpr const char* kNoBolus = "the history has no bolus";

struct RegionName {
  Region region;
  const char* name;
};
// Own words, so that a table never depends on how the file spells a region.
constexpr std::array<RegionName, 6> kResidueRegions{{{Region::oral, "oral"},
                                                     {Region::oropharynx, "oropharynx"},
                                                     {Region::hypopharynx, "hypopharynx"},
                                                     {Region::nasopharynx, "nasopharynx"},
                                                     {Region::larynx, "larynx"},
                                                     {Region::esophagus, "esophagus"}}};
}  // namespace

bool hasBolus(const frame::History& history) {
  return !history.bolus.s_m.empty() && !history.bolus.s_m.front().empty();
}

std::vector<double> shareBeyond(const frame::BolusTrack& bolus, double s_m) {
  std::vector<double> out;
  for (std::size_t f = 0; f < bolus.s_m.size(); ++f) {
    int beyond = 0;
    const int n = static_cast<int>(bolus.s_m[f].size());
    if (n == 0) return {};
    for (int k = 0; k < n; ++k)
      beyond += bolus.state[f][k] == ParticleState::swallowed || bolus.s_m[f][k] > s_m;
    out.push_back(static_cast<double>(beyond) / n);
  }
  return out;
}

std::vector<Quantity> measureClearance(const frame::History& history, const ScoringRules& rules) {
  std::vector<Quantity> out;
  Quantity t50{"t50_past_ramus",
               {},
               "s",
               -1,
               fmt::format("first frame with at least half of V0 past s = {:g} mm, from the cue",
                           rules.ramus_m * 1e3),
               kNoBolus};
  const bool bolus = hasBolus(history);
  if (bolus) {
    const auto half = firstFrame(shareBeyond(history.bolus, rules.ramus_m), 0,
                                 [](double share) { return share >= 0.5; });
    t50.reason = half ? "" : "less than half of V0 passes the ramus";
    if (half) t50.frame = *half, t50.value = history.time_s[*half] - history.meta.cue_s;
  }
  out.push_back(t50);

  const int last = history.frames() - 1;
  Quantity gone{
      "swallowed", {}, "share", -1, "share of V0 past the lower end of the UES at the end",
      kNoBolus};
  if (bolus) set(gone, shareBeyond(history.bolus, rules.uesEnd_m)[last], last);
  out.push_back(gone);
  for (const RegionName& r : kResidueRegions) {
    Quantity q{std::string("left_in_") + r.name,
               {},
               "share",
               last,
               "share of V0 in the region at the last frame, fluid and film",
               kNoBolus};
    if (bolus) {
      int left = 0;
      const auto& state = history.bolus.state[last];
      for (std::size_t k = 0; k < state.size(); ++k)
        left += isThere(state[k]) && history.bolus.region[last][k] == r.region;
      q.value = static_cast<double>(left) / static_cast<double>(state.size());
      q.reason.clear();
    }
    out.push_back(q);
  }
  return out;
}
}  // namespace swallowclip::scoring
