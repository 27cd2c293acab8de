// SPDX-License-Identifier: MIT
// ASPEKT events as measured, not as planned. Each is judged on frames, so its time is a frame's;
// one that cannot be judged has no time and says why.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "frame/history.h"
#include "scoring/lumen.h"
#include "scoring/metrics.h"
#include "scoring/rules.h"

namespace swallowclip::scoring {

/// First frame at or after the cue; 0 when the history starts later.
int cueFrame(const frame::History& history);

/// First frame at or after a time; the last one when the history ends earlier.
int frameAt(const frame::History& history, double time_s);

/// First frame at which the leading share of V0 has passed the ramus.
MeasuredEvent measureBpm(const frame::History& history, const ScoringRules& rules);

/// [frame] how fast a structure's fastest point moves (m/s, central differences).
std::vector<double> structureSpeed(const frame::StructureTrack& track,
                                   std::span<const double> time_s);

/// Closure and reopening of any gap series (m): sealed below `rules.sealed_m` or below
/// `rules.sealedRatio` of its value at frame `rest`. Returns {closed, reopened}; no reopening
/// without closure.
struct Closure {
  std::optional<int> closed, reopened;
  double narrowest = 0;  ///< least ratio to rest
};
Closure measureClosure(std::span<const double> gap_m, int rest, const ScoringRules& rules);

/// [frame] stand-in for the vestibule gap where the skin has no laryngeal branch: mean arytenoid
/// apex to epiglottic petiole. Empty when a landmark lacks.
std::vector<double> vestibuleGap_m(const frame::History& history);

/// [frame] gap between the arytenoids and the epiglottic petiole: least width of the vestibule at
/// the petiole's height at the cue; without a branch the stand-in above.
std::vector<double> petioleGap_m(const frame::History& history, const LumenProfile& lumen);

/// [frame] gap at the narrowest level of the UES; empty when the skin has no midline there.
std::vector<double> uesGap_m(const frame::History& history, const LumenProfile& lumen,
                             const ScoringRules& rules);

struct EventReport {
  std::vector<MeasuredEvent> events;  ///< tongue_onset, BPM, HYB, LVC, UESO, UESMax, MPC, UESC,
                                      ///< LVCoff, SwRest
  std::vector<Quantity> quantities;   ///< transits, intervals, UES width and time, PCR
  std::vector<Series> series;
};

/// `onset` and `bpm` come from component 4 and measureBpm.
EventReport measureEvents(const frame::History& history, const LumenProfile& lumen,
                          const MeasuredEvent& onset, const MeasuredEvent& bpm,
                          const ScoringRules& rules);
}  // namespace swallowclip::scoring
