// SPDX-License-Identifier: MIT
#include "scoring/component4.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scoring/clearance.h"
#include "scoring/events.h"
#include "scoring/series.h"

namespace swallowclip::scoring {
namespace {

using frame::History;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::vector<int> tongueStations(const LumenProfile& lumen) {
  std::vector<int> out;
  for (std::size_t k = 0; k < lumen.stations.size(); ++k)
    if (lumen.stations[k].wall == frame::Wall::tongue) out.push_back(static_cast<int>(k));
  return out;
}

double spread(std::span<const double> x, int begin, int end) {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  for (int i = begin; i < end; ++i)
    if (std::isfinite(x[i])) lo = std::min(lo, x[i]), hi = std::max(hi, x[i]);
  return hi > lo ? hi - lo : 0;
}

/// The frames that the rocking and the onset are judged on: from the cue to where the oral
/// centroid stops meaning anything, and the frame of the (planned) BPM.
struct Window {
  int begin = 0, end = 0;  ///< half open
  int bpm = 0;             ///< `end` when there is none
};

/// What rocks: the oral centroid, or the dorsal high point when there is no bolus.
struct Rocking {
  std::vector<double> raw, smooth;  ///< [frame - begin], without NaN
  double run_m = 0;
  const char* what = "";
};

/// NaN is where no particle is left before the ramus: the nearest earlier value stands in, and
/// before the first one the first. Empty when there is none at all.
std::vector<double> filled(std::span<const double> x) {
  std::vector<double> out(x.begin(), x.end());
  const auto first =
      std::find_if(out.begin(), out.end(), [](double v) { return std::isfinite(v); });
  if (first == out.end()) return {};
  double last = *first;
  for (double& v : out) {
    if (std::isfinite(v)) last = v;
    v = last;
  }
  return out;
}

Window judgedWindow(const History& h, const std::vector<double>& front, const MeasuredEvent& bpm,
                    const ScoringRules& rules) {
  Window w{cueFrame(h), h.frames(), h.frames()};
  if (hasBolus(h)) {
    const auto half = firstFrame(shareBeyond(h.bolus, rules.ramus_m), w.begin,
                                 [&](double share) { return share >= rules.centroidUntilShare; });
    if (half) w.end = *half + 1;
    w.bpm = bpm.time_s ? bpm.frame : w.end;
  } else {
    // Without bolus the plan says when its head would pass; failing that, the contact front does.
    std::optional<int> at;
    for (const auto& e : h.plannedEvents)
      if (e.name == "BPM" && e.time_s <= h.time_s.back()) at = frameAt(h, e.time_s);
    if (!at) at = firstFrame(front, w.begin, [&](double s) { return s >= rules.ramus_m; });
    if (at) w.bpm = *at, w.end = *at + 1;
  }
  w.end = std::max(w.end, std::min(w.begin + 1, h.frames()));
  return w;
}

Rocking rockingOf(const History& h, const Window& w, const std::vector<double>& centroid,
                  const std::vector<double>& dorsal, const ScoringRules& rules) {
  Rocking r;
  auto part = [&](const std::vector<double>& x) {
    return filled(std::span(x).subspan(w.begin, w.end - w.begin));
  };
  if (!centroid.empty()) {
    r.raw = part(centroid);
    r.smooth = zeroPhaseLowPass(r.raw, h.meta.fps, rules.lowPass_Hz);
    r.run_m = rules.reversalRun_m;
    r.what = "mean s of the particles before the ramus (6 Hz zero phase)";
  } else {
    r.raw = r.smooth = part(dorsal);
    r.run_m = rules.dorsalRun_m;
    r.what = "dorsal high point (no bolus)";
  }
  return r;
}

MeasuredEvent findOnset(const History& h, const Window& w, const std::vector<double>& front,
                        const Rocking& rocking, const ScoringRules& rules) {
  MeasuredEvent e{"tongue_onset",
                  {},
                  -1,
                  fmt::format("first advance of the contact front or of the {} after the cue that "
                              "exceeds {:g} mm/s and covers {:g} mm",
                              rocking.what, rules.advanceSpeed_ms * 1e3, rules.advancePath_m * 1e3),
                  "no such advance"};
  const std::span time_s = std::span(h.time_s).subspan(w.begin);
  auto consider = [&](std::span<const double> x) {
    const auto found = advances(time_s.first(x.size()), x, rules.advancePath_m,
                                rules.advanceSpeed_ms, rules.advanceSlack_m);
    if (found.empty() || (e.time_s && *e.time_s <= found.front().onset_s)) return;
    e.time_s = found.front().onset_s;
    e.frame = frameAt(h, *e.time_s);
    e.reason.clear();
  };
  consider(std::span(front).subspan(w.begin));
  consider(rocking.raw);
  return e;
}

/// Slope of the contact front's last advance that belongs to this swallow.
std::optional<double> frontSpeed(const History& h, const Window& w,
                                 const std::vector<double>& front, const ScoringRules& rules) {
  const std::span x = std::span(front).subspan(w.begin);
  const std::span time_s = std::span(h.time_s).subspan(w.begin);
  // Any speed: a creep below the onset's 20 mm/s is still slow, not absent.
  const auto found = advances(time_s, x, rules.advancePath_m, 0.0, rules.advanceSlack_m);
  if (found.empty()) return std::nullopt;
  // One that begins after the bolus has gone is the tongue coming home, unless there is no other.
  const Advance* last = &found.front();
  for (const Advance& a : found)
    if (w.begin + a.begin < w.end) last = &a;
  return pathSlope(time_s, x, last->begin, last->end, rules.slopeFrom, rules.slopeTo);
}

void measureReversals(const History& h, const Window& w, const Rocking& rocking,
                      const ScoringRules& rules, Component4Measures& m) {
  if (rocking.smooth.empty()) return;  // the bolus never was in the mouth
  const std::span time_s = std::span(h.time_s).subspan(w.begin, rocking.smooth.size());
  auto count = [&](double run_m) {
    return countReversals(time_s, rocking.smooth, w.bpm - w.begin, run_m, rules);
  };
  m.reversals = count(rocking.run_m);
  const int fewer = count(rocking.run_m * (1 + rules.ambiguousMargin));
  const int more = count(rocking.run_m * (1 - rules.ambiguousMargin));
  m.reversalsUnsure = (fewer >= rules.repetitiveReversals) != (more >= rules.repetitiveReversals);
}

double lastCue_s(const History& h) {
  return h.meta.cues_s.empty() ? h.meta.cue_s : h.meta.cues_s.back();
}

Quantity quantity(const char* name, std::optional<double> value, double scale, const char* unit,
                  std::string rule, std::string reason) {
  Quantity q{name, {}, unit, -1, std::move(rule), std::move(reason)};
  if (value) q.value = *value * scale, q.reason.clear();
  return q;
}

void addQuantities(const History& h, const MeasuredEvent& bpm, const Rocking& rocking,
                   double frontTravel_m, double dorsalTravel_m, const ScoringRules& rules,
                   Component4Report& out) {
  const Component4Measures& m = out.measures;
  const std::string within =
      fmt::format("from the cue to {:g} s after the last cue", rules.minimalWait_s);
  auto add = [&](Quantity q) { out.quantities.push_back(std::move(q)); };
  add(quantity("initial_delay", m.delay_s, 1, "s", "D_i: cue to tongue onset", out.onset.reason));
  out.quantities.back().frame = out.onset.frame;
  add(quantity("front_speed", m.front_ms, 1e3, "mm/s",
               "v: slope of the contact front between 10 and 90 % of its last advance",
               "the contact front never advances by 10 mm"));
  add(quantity("reversals", m.reversals, 1, "count",
               fmt::format("N: turning points of the {} between runs >= {:g} mm, before BPM, less "
                           "accommodation",
                           rocking.what, rocking.run_m * 1e3),
               "no particle is in the mouth after the cue"));
  std::optional<double> toRamus_s;
  if (bpm.time_s && out.onset.time_s) toRamus_s = *bpm.time_s - *out.onset.time_s;
  add(quantity("onset_to_ramus", toRamus_s, 1, "s", "T_o: tongue onset to BPM",
               bpm.time_s ? out.onset.reason : bpm.reason));
  add(quantity("contact_front_travel", frontTravel_m, 1e3, "mm",
               "range of the rear end of the tongue contact that starts at the ridge, " + within,
               ""));
  add(quantity("dorsal_travel", dorsalTravel_m, 1e3, "mm",
               "range of the s at which the tongue has risen most since the cue, " + within, ""));

  std::optional<double> past;
  const int at = frameAt(h, lastCue_s(h) + rules.minimalWait_s);
  if (hasBolus(h)) past = shareBeyond(h.bolus, rules.ramus_m)[at];
  add(quantity("past_ramus", past, 1, "share",
               fmt::format("P: share of V0 past the ramus {:.2f} s after the last cue{}",
                           h.time_s[at] - lastCue_s(h),
                           m.waited_s < rules.minimalWait_s ? " (the history ends)" : ""),
               "the history has no bolus"));
  out.quantities.back().frame = at;
}

void addSeries(const char* name, const std::vector<double>& x_m, Component4Report& out) {
  if (x_m.empty()) return;
  Series s{name, "mm", x_m};
  for (double& v : s.values) v *= 1e3;
  out.series.push_back(std::move(s));
}
}  // namespace

std::vector<double> contactFront_m(const LumenProfile& lumen, int rest, const ScoringRules& rules) {
  const std::vector<int> tongue = tongueStations(lumen);
  const std::size_t n = tongue.size();
  std::vector<double> out;
  if (n == 0) return out;
  std::vector<char> held(n, 0);  // contact of the holding pose that has not opened yet
  auto s = [&](std::size_t i) { return lumen.stations[tongue[i]].s_m; };
  auto rearEnd_m = [&](const std::vector<double>& g) {
    auto touches = [&](std::size_t i) { return !held[i] && g[tongue[i]] < rules.contactGap_m; };
    std::size_t k = 0;
    while (k < n && s(k) <= rules.ridgeEnd_m && !touches(k)) ++k;
    if (k == n || s(k) > rules.ridgeEnd_m) return s(0);
    while (k + 1 < n && touches(k + 1)) ++k;
    if (k + 1 == n) return s(k);
    const double here = g[tongue[k]], next = std::max(g[tongue[k + 1]], rules.contactGap_m);
    return s(k) + (rules.contactGap_m - here) / (next - here) * (s(k + 1) - s(k));
  };
  const double atRest_m = rearEnd_m(lumen.gap_m[rest]);
  for (std::size_t f = 0; f < lumen.gap_m.size(); ++f) {
    const auto& g = lumen.gap_m[f];
    for (std::size_t i = 0; i < n; ++i) {
      if (static_cast<int>(f) == rest) held[i] = s(i) > atRest_m;
      held[i] = held[i] && g[tongue[i]] < rules.contactGap_m;
    }
    out.push_back(rearEnd_m(g));
  }
  return out;
}

std::vector<double> dorsalHighPoint_m(const LumenProfile& lumen, int rest,
                                      std::span<const double> front, const ScoringRules& rules) {
  const std::vector<int> tongue = tongueStations(lumen);
  std::vector<double> out, rise(tongue.size());
  if (tongue.empty()) return out;
  for (std::size_t f = 0; f < lumen.gap_m.size(); ++f) {
    for (std::size_t i = 0; i < tongue.size(); ++i)
      rise[i] = lumen.gap_m[rest][tongue[i]] - lumen.gap_m[f][tongue[i]];
    const int top = static_cast<int>(std::max_element(rise.begin(), rise.end()) - rise.begin());
    if (rise[top] < rules.dorsalMinRise_m) {
      out.push_back(front[f]);
      continue;
    }
    const double level = rise[top] - rules.dorsalTie_m;
    int a = top, b = top;
    while (a > 0 && rise[a - 1] >= level) --a;
    while (b + 1 < static_cast<int>(rise.size()) && rise[b + 1] >= level) ++b;
    double sum = 0;
    for (int i = a; i <= b; ++i) sum += lumen.stations[tongue[i]].s_m;
    out.push_back(sum / (b - a + 1));
  }
  return out;
}

std::vector<double> oralCentroid_m(const frame::BolusTrack& bolus, const ScoringRules& rules) {
  std::vector<double> out;
  for (std::size_t f = 0; f < bolus.s_m.size(); ++f) {
    double sum = 0;
    int oral = 0;
    for (std::size_t k = 0; k < bolus.s_m[f].size(); ++k) {
      const bool gone = !frame::isThere(bolus.state[f][k]);
      if (gone || bolus.s_m[f][k] > rules.ramus_m) continue;
      sum += bolus.s_m[f][k], ++oral;
    }
    out.push_back(oral > 0 ? sum / oral : kNaN);
  }
  return out;
}

int countReversals(std::span<const double> time_s, std::span<const double> x, int end, double run,
                   const ScoringRules& rules) {
  const std::vector<Run> all = runs(x, run);
  std::size_t first = 0;
  if (all.size() >= 2 && std::abs(all[0].change) < rules.accommodationRun_m &&
      std::abs(all[1].change) < rules.accommodationRun_m &&
      time_s[all[1].end] - time_s[all[0].begin] <= rules.accommodationTime_s)
    first = 2;
  int turns = 0;
  for (std::size_t k = first + 1; k < all.size(); ++k) turns += all[k].begin < end;
  return turns;
}

std::optional<int> scoreComponent4(const Component4Measures& m, const ScoringRules& rules) {
  constexpr double kRounding_s = 1e-6, kBetweenCounts = 0.5;
  if (!m.travel_m) return std::nullopt;
  if (*m.travel_m < rules.minimalTravel_m)
    return m.waited_s < rules.minimalWait_s - kRounding_s ? std::nullopt : std::optional(4);
  if (!m.reversals) return std::nullopt;
  if (*m.reversals > rules.repetitiveReversals - kBetweenCounts) return 3;
  if (!m.front_ms) return std::nullopt;
  if (*m.front_ms < rules.slow_ms) return 2;
  if (!m.delay_s) return std::nullopt;
  return *m.delay_s > rules.delayed_s ? 1 : 0;
}

Decision decideComponent4(const Component4Measures& m, const ScoringRules& rules) {
  Decision d = decide([&](const ScoringRules& r) { return scoreComponent4(m, r); }, rules, "");
  const bool moves = m.travel_m && *m.travel_m >= rules.minimalTravel_m;
  const std::string travel =
      m.travel_m
          ? fmt::format("contact front and dorsal high point travel {:.1f} mm", *m.travel_m * 1e3)
          : "the airway-skin has no tongue midline";
  if (!moves) {
    d.reason = travel;
    if (m.travel_m && !d.score)
      d.reason +=
          fmt::format(", but the history ends {:.2f} s after the last cue; score 4 needs {:g} s",
                      m.waited_s, rules.minimalWait_s);
    return d;
  }
  if (!m.reversals) {
    d.reason = "reversals could not be counted";
    return d;
  }
  d.ambiguous |= m.reversalsUnsure;
  if (d.score == 3) {
    d.reason = fmt::format("{} reversals", *m.reversals);
  } else if (!m.front_ms) {
    d.reason = "the contact front never advances by 10 mm";
  } else {
    d.reason = fmt::format("front speed {:.0f} mm/s", *m.front_ms * 1e3);
    if (d.score == 2) return d;
    d.ambiguous |= *m.front_ms < rules.brisk_ms;
    d.reason = m.delay_s ? fmt::format("onset {:.2f} s after the cue, {}", *m.delay_s, d.reason)
                         : "no productive tongue onset";
  }
  return d;
}

Component4Report measureComponent4(const History& h, const LumenProfile& lumen,
                                   const MeasuredEvent& bpm, const ScoringRules& rules) {
  Component4Report out;
  const int cue = cueFrame(h);
  const std::vector<double> front = contactFront_m(lumen, cue, rules);
  Component4Measures& m = out.measures;
  m.waited_s = h.time_s.back() - lastCue_s(h);
  if (front.empty()) {
    out.decision = decideComponent4(m, rules);
    out.onset = {"tongue_onset", {}, -1, "first productive advance", out.decision.reason};
    return out;
  }
  const std::vector<double> dorsal = dorsalHighPoint_m(lumen, cue, front, rules);
  const std::vector<double> centroid =
      hasBolus(h) ? oralCentroid_m(h.bolus, rules) : std::vector<double>{};

  const int until = frameAt(h, lastCue_s(h) + rules.minimalWait_s) + 1;
  const double frontTravel_m = spread(front, cue, until),
               dorsalTravel_m = spread(dorsal, cue, until);
  m.travel_m = std::max(frontTravel_m, dorsalTravel_m);

  const Window window = judgedWindow(h, front, bpm, rules);
  const Rocking rocking = rockingOf(h, window, centroid, dorsal, rules);
  measureReversals(h, window, rocking, rules, m);
  m.front_ms = frontSpeed(h, window, front, rules);
  out.onset = findOnset(h, window, front, rocking, rules);
  if (out.onset.time_s) m.delay_s = *out.onset.time_s - h.meta.cue_s;
  out.decision = decideComponent4(m, rules);

  out.frame = bpm.frame;
  out.liveSeries = "contact_front";
  addQuantities(h, bpm, rocking, frontTravel_m, dorsalTravel_m, rules, out);
  addSeries("contact_front", front, out);
  addSeries("dorsal_high_point", dorsal, out);
  addSeries("oral_centroid", centroid, out);
  return out;
}
}  // namespace swallowclip::scoring
