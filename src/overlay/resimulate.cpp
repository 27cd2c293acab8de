// SPDX-License-Identifier: MIT
#include "overlay/resimulate.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace swallowclip::overlay {
namespace {
using kinematics::SwallowDef;
using kinematics::Track;

constexpr int kFrontKnots = 80;        // resampled contact front: every 18 ms; assumed, 40 to 200
constexpr double kLeastStep_s = 1e-4;  // between two of its knots
constexpr double kCrowded_s = 0.1;     // between events of the model; assumed, 0.07 to 0.13

/// Bolus before bone before the rest: what the warp honours first when not all agree.
const std::vector<std::string>& priority() {
  static const std::vector<std::string> names{"BPM",          "HYB",    "UESO", "UESC",   "LVC",
                                              "tongue_onset", "SwRest", "MPC",  "LVCoff", "UESMax"};
  return names;
}

struct Anchor {
  const char *event, *track;
  double Track::*key;
};
constexpr Anchor kAnchors[] = {
    {"HYB", "hyoid_superior", &Track::onset_s}, {"HYB", "hyoid_anterior", &Track::onset_s},
    {"LVC", "arytenoid", &Track::peak_s},       {"LVCoff", "arytenoid", &Track::hold_s},
    {"UESO", "ues", &Track::onset_s},           {"UESMax", "ues", &Track::peak_s},
    {"UESC", "ues", &Track::offset_s}};

bool movesItself(const std::string& name) {
  return std::ranges::any_of(kAnchors, [&](const Anchor& a) { return name == a.event; });
}

/// Whether a warp through `taken` had better leave `p` out. Between two events that are one moment
/// of the model but two of the study it would stand still and, being smooth, hasten what comes just
/// before: asked later, the bolus would come earlier. Near ones bend it in the same way, which is
/// needless where `p` can move on its own.
bool crowds(const EventPair& p, const std::vector<EventPair>& taken, double frame_s) {
  const double near_s = movesItself(p.name) ? kCrowded_s : frame_s / 2;
  return std::ranges::any_of(taken, [&](const EventPair& q) {
    return std::abs(p.model_s - q.model_s) < near_s &&
           (movesItself(p.name) || std::abs(p.study_s - q.study_s) > kSameTime_s);
  });
}

/// What has tracks of its own is corrected there: the warp does not go along, else mending the
/// hyoid's burst would move the bolus.
Result<TimeWarp> agreeingWarp(std::vector<EventPair> pairs, double frame_s) {
  for (EventPair& p : pairs)
    if (!movesItself(p.name)) p.study_s += p.correction_s;
  std::vector<EventPair> taken;
  std::optional<TimeWarp> warp;
  for (const std::string& name : priority())
    for (const EventPair& p : pairs) {
      if (p.name != name || crowds(p, taken, frame_s)) continue;
      std::vector<EventPair> more = taken;
      more.push_back(p);
      if (auto made = TimeWarp::make(more, frame_s)) {
        warp = *made;
        taken = more;
      }
    }
  if (!warp) return TimeWarp::make(pairs, frame_s);  // says what is wrong
  return *warp;
}

/// Order of a track's keys restored after one of them was set: its neighbours give way.
void order(Track& t, double Track::*set) {
  double Track::*const keys[] = {&Track::onset_s, &Track::peak_s, &Track::hold_s, &Track::offset_s};
  const auto at = std::ranges::find(keys, set) - keys;
  for (auto i = at - 1; i >= 0; --i) t.*keys[i] = std::min(t.*keys[i], t.*keys[i + 1]);
  for (auto i = at + 1; i < 4; ++i) t.*keys[i] = std::max(t.*keys[i], t.*keys[i - 1]);
}
}  // namespace

Result<MovedSwallow> movedTo(const SwallowDef& from, const std::vector<EventPair>& pairs,
                             double frame_s) {
  const auto warp = agreeingWarp(pairs, frame_s);
  if (!warp) return std::unexpected(warp.error());
  MovedSwallow moved{from, warp->study_s(0)};
  SwallowDef& to = moved.swallow;
  const auto map = [&](double model_s) { return warp->study_s(model_s) - moved.cue_s; };
  to.bpm_s = map(from.bpm_s);
  to.duration_s = map(from.duration_s);
  for (double& cue : to.cues_s) cue = map(cue);
  to.rockStart_s = map(from.rockStart_s);
  for (auto& [name, t] : to.tracks) {
    const Track old = t;
    const auto key = [&](double value_s) {
      return map(from.bpm_s + old.delay_s + old.onset_s + (value_s - old.onset_s) / old.speed) -
             to.bpm_s;
    };
    t.onset_s = key(old.onset_s);
    t.peak_s = key(old.peak_s);
    t.hold_s = key(old.hold_s);
    t.offset_s = key(old.offset_s);
    t.delay_s = 0;
    t.speed = 1;
  }
  std::vector<double> x, y;
  for (int i = 0; i <= kFrontKnots; ++i) {
    const double tau =
        from.front_m.front() + (from.front_m.back() - from.front_m.front()) * i / kFrontKnots;
    const double at = map(from.bpm_s + tau) - to.bpm_s;
    x.push_back(x.empty() ? at : std::max(at, x.back() + kLeastStep_s));
    y.push_back(from.front_m(tau));
  }
  to.front_m = Curve(x, y);
  for (const EventPair& p : pairs) {
    const double late_s = p.study_s + p.correction_s - moved.cue_s - map(p.model_s);
    for (const Anchor& a : kAnchors)
      if (p.name == a.event)
        if (const auto found = to.tracks.find(a.track); found != to.tracks.end()) {
          found->second.*a.key += late_s;
          order(found->second, a.key);
        }
  }
  return moved;
}
}  // namespace swallowclip::overlay
