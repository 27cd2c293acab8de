// SPDX-License-Identifier: MIT
#include "overlay/retime.h"

#include <algorithm>
#include <cmath>

namespace swallowclip::overlay {
namespace {
constexpr double kBeyond_s = 1e4;  // how far unit speed goes on; longer than any clip
constexpr double kEase_s = 0.3;    // in which the speed at an outer event becomes 1; assumed, 0.1-1
}  // namespace

std::vector<EventPair> pairEvents(const Marks& marks, const study::StudyInfo& study,
                                  const scoring::Metrics& metrics) {
  std::vector<EventPair> pairs;
  for (const StudyEvent& e : marks.events)
    if (const scoring::MeasuredEvent* m = metrics.event(e.name); m && m->time_s)
      pairs.push_back({e.name, study.time_s[static_cast<std::size_t>(e.frame)], *m->time_s});
  return pairs;
}

Result<TimeWarp> TimeWarp::make(std::vector<EventPair> pairs, double frame_s) {
  if (pairs.empty())
    return usageError("events file", "no marked event happens in the model's swallow",
                      "Mark one that does, e.g. BPM, or choose another swallow.");
  std::ranges::stable_sort(pairs, {}, &EventPair::study_s);
  std::vector<double> x, y;
  for (std::size_t i = 0; i < pairs.size();) {
    std::size_t end = i;
    double mean_s = 0;
    for (; end < pairs.size() && pairs[end].study_s - pairs[i].study_s <= kSameTime_s; ++end)
      mean_s += pairs[end].model_s;
    mean_s /= static_cast<double>(end - i);
    for (std::size_t k = i; k < end; ++k)
      if (std::abs(pairs[k].model_s - mean_s) > frame_s / 2 + 1e-9)
        return usageError(
            "events file",
            fmt::format("{} and {} share a frame, but lie {:.3f} s apart in the model",
                        pairs[i].name, pairs[end - 1].name,
                        std::abs(pairs[end - 1].model_s - pairs[i].model_s)),
            "Leave one of them out.");
    if (!y.empty() && mean_s < y.back())
      return usageError("events file",
                        fmt::format("{} comes after {} in the study, but before it in the model",
                                    pairs[i].name, pairs[i - 1].name),
                        "Leave one of them out, or let --resimulate move the motion itself.");
    x.push_back(pairs[i].study_s);
    y.push_back(mean_s);
    i = end;
  }
  TimeWarp warp;
  for (const double further_s : {kEase_s, kBeyond_s}) {
    x.insert(x.begin(), x.front() - further_s);
    y.insert(y.begin(), y.front() - further_s);
    x.push_back(x.back() + further_s);
    y.push_back(y.back() + further_s);
  }
  warp.curve_ = Curve(x, y);
  return warp;
}

TimeWarp TimeWarp::shift(double shift_s) {
  TimeWarp warp;
  warp.curve_ = Curve({shift_s - kBeyond_s, shift_s + kBeyond_s}, {-kBeyond_s, kBeyond_s});
  return warp;
}

double TimeWarp::study_s(double model_s) const {
  const auto edge = [&](bool upper) {  // first study time with model above (or not below) model_s
    double low = curve_.front(), high = curve_.back();
    for (int i = 0; i < 80; ++i) {
      const double middle = 0.5 * (low + high), value = curve_(middle);
      (value > model_s || (!upper && value >= model_s) ? high : low) = middle;
    }
    return 0.5 * (low + high);
  };
  return 0.5 * (edge(false) + edge(true));
}

namespace {
/// Two neighbouring frames and the share of the later one.
struct Between {
  std::size_t a = 0, b = 0;
  float share = 0;
  std::size_t nearest() const { return share < 0.5f ? a : b; }
};

Between locate(const std::vector<double>& time_s, double t_s) {
  if (t_s <= time_s.front()) return {0, 0, 0};
  if (t_s >= time_s.back()) return {time_s.size() - 1, time_s.size() - 1, 0};
  const auto after = std::ranges::upper_bound(time_s, t_s) - time_s.begin();
  const auto b = static_cast<std::size_t>(after), a = b - 1;
  return {a, b, static_cast<float>((t_s - time_s[a]) / (time_s[b] - time_s[a]))};
}

std::vector<Vec3f> mix(const std::vector<std::vector<Vec3f>>& frames, const Between& at) {
  std::vector<Vec3f> out = frames[at.a];
  if (at.a == at.b) return out;
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += at.share * (frames[at.b][i] - out[i]);
  return out;
}

Pose mix(const Pose& a, const Pose& b, double share) {
  return {a.q.slerp(share, b.q), a.t + share * (b.t - a.t)};
}
}  // namespace

frame::History retimed(const frame::History& m, const TimeWarp& warp,
                       const std::vector<double>& study_s, double fps) {
  frame::History h;
  h.meta = m.meta;
  h.meta.fps = fps;
  h.time_s = study_s;
  h.meta.cue_s = warp.study_s(m.meta.cue_s);
  for (double& cue : h.meta.cues_s) cue = warp.study_s(cue);
  for (const frame::Event& e : m.plannedEvents)
    h.plannedEvents.push_back({e.name, warp.study_s(e.time_s)});
  for (const auto& s : m.structures)
    h.structures.push_back({s.name, s.material, s.rigid, s.triangles, s.rest, {}, {}});
  for (const auto& l : m.landmarks) h.landmarks.push_back({l.name, {}});
  h.skin = {m.skin.triangles, m.skin.wall, m.skin.s_m, m.skin.u, {}, {}, {}};
  h.bolus.particleVolume_m3 = m.bolus.particleVolume_m3;
  for (const double t : study_s) {
    const Between at = locate(m.time_s, warp.model_s(t));
    for (std::size_t i = 0; i < m.structures.size(); ++i) {
      const auto& from = m.structures[i];
      if (from.rigid)
        h.structures[i].poses.push_back(mix(from.poses[at.a], from.poses[at.b], at.share));
      else
        h.structures[i].positions.push_back(mix(from.positions, at));
    }
    for (std::size_t i = 0; i < m.landmarks.size(); ++i) {
      const auto& p = m.landmarks[i].positions;
      h.landmarks[i].positions.push_back(p[at.a] + at.share * (p[at.b] - p[at.a]));
    }
    if (!m.skin.positions.empty()) h.skin.positions.push_back(mix(m.skin.positions, at));
    if (!m.skin.velocities.empty()) h.skin.velocities.push_back(mix(m.skin.velocities, at));
    if (!m.skin.film_m.empty()) h.skin.film_m.push_back(m.skin.film_m[at.nearest()]);
    if (!m.bolus.positions.empty()) {
      const std::size_t n = at.nearest();
      h.bolus.positions.push_back(mix(m.bolus.positions, at));
      h.bolus.velocities.push_back(mix(m.bolus.velocities, at));
      h.bolus.densityRatio.push_back(m.bolus.densityRatio[n]);
      h.bolus.state.push_back(m.bolus.state[n]);
      h.bolus.region.push_back(m.bolus.region[n]);
      h.bolus.s_m.push_back(m.bolus.s_m[n]);
      if (!m.bolus.lentShare.empty()) h.bolus.lentShare.push_back(m.bolus.lentShare[n]);
    }
    if (!m.ledger.empty()) h.ledger.push_back(m.ledger[at.nearest()]);
  }
  return h;
}
}  // namespace swallowclip::overlay
