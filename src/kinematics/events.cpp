// SPDX-License-Identifier: MIT
#include "kinematics/events.h"

#include <algorithm>

namespace swallowclip::kinematics {

std::vector<std::pair<std::string, double>> plannedEvents(const SwallowDef& d) {
  std::vector<std::pair<std::string, double>> events;
  for (std::size_t i = 0; i < d.cues_s.size(); ++i)
    events.push_back({i == 0 ? "cue" : "second cue", d.cues_s[i]});
  const auto time = [&](const char* track, double Track::*key) {
    const Track& t = d.track(track);
    return d.bpm_s + t.delay_s + t.onset_s + (t.*key - t.onset_s) / t.speed;
  };
  const auto add = [&](const char* name, const char* track, double Track::*key) {
    if (d.track(track).amplitude > 0.1) events.push_back({name, time(track, key)});
  };
  if (d.frontAmplitude > 0) {
    events.push_back({"tip_press", d.bpm_s + d.front_m.front()});
    add("HYB", "hyoid_superior", &Track::onset_s);
    events.push_back({"BPM", time("hyoid_superior", &Track::onset_s)});
  }
  add("LVC", "arytenoid", &Track::peak_s);
  add("UESO", "ues", &Track::onset_s);
  add("UESMax", "ues", &Track::peak_s);
  add("UESC", "ues", &Track::offset_s);
  add("LVCoff", "arytenoid", &Track::hold_s);
  add("SwRest", "pharynx_return", &Track::peak_s);
  std::stable_sort(events.begin(), events.end(),
                   [](const auto& a, const auto& b) { return a.second < b.second; });
  return events;
}
}  // namespace swallowclip::kinematics
