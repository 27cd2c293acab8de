// SPDX-License-Identifier: MIT
#include "scoring/events.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scoring/clearance.h"
#include "scoring/series.h"
#include "scoring/spine.h"

namespace swallowclip::scoring {
namespace {

using frame::History;

constexpr int kSpeedSamples = 500;  ///< vertices tried per structure; assumed, 100-5000

MeasuredEvent found(std::string name, std::string rule, const History& h, std::optional<int> frame,
                    std::string otherwise) {
  MeasuredEvent e{std::move(name), {}, -1, std::move(rule), std::move(otherwise)};
  if (frame) e.time_s = h.time_s[*frame], e.frame = *frame, e.reason.clear();
  return e;
}

std::vector<double> pointSpeed(std::span<const double> time_s, std::span<const Vec3> x) {
  const int n = static_cast<int>(x.size());
  std::vector<double> v(n, 0.0);
  for (int i = 0; n > 1 && i < n; ++i) {
    const int a = std::max(0, i - 1), b = std::min(n - 1, i + 1);
    v[i] = (x[b] - x[a]).norm() / (time_s[b] - time_s[a]);
  }
  return v;
}

/// Hyoid speed from its landmark, else from its rigid pose; empty when the history has neither.
std::vector<double> hyoidSpeed(const History& h) {
  std::vector<Vec3> x;
  if (const auto* body = wholeLandmark(h, "hyoid_body_centre")) {
    for (const Vec3f& p : body->positions) x.push_back(p.cast<double>());
    return pointSpeed(h.time_s, x);
  }
  for (const auto& s : h.structures) {
    if (s.name != "hyoid" || !s.rigid || s.rest.empty()) continue;
    Vec3 centre = Vec3::Zero();
    for (const Vec3f& p : s.rest) centre += p.cast<double>() / static_cast<double>(s.rest.size());
    for (const Pose& pose : s.poses) x.push_back(pose.apply(centre));
    return pointSpeed(h.time_s, x);
  }
  return {};
}

MeasuredEvent measureHyb(const History& h, const ScoringRules& rules) {
  const std::string rule = fmt::format("first frame after the cue with hyoid speed > {:g} mm/s",
                                       rules.hyoidBurst_ms * 1e3);
  const std::vector<double> speed = hyoidSpeed(h);
  if (speed.empty())
    return found("HYB", rule, h, {}, "no landmark hyoid_body_centre and no rigid structure hyoid");
  return found("HYB", rule, h,
               firstFrame(speed, cueFrame(h), [&](double v) { return v > rules.hyoidBurst_ms; }),
               "the hyoid never moves that fast");
}

void addVestibule(const History& h, const LumenProfile& lumen, const ScoringRules& rules,
                  EventReport& out) {
  const bool fromSkin = !lumen.vestibule_m.empty();
  const std::vector<double> gap = fromSkin ? lumen.vestibule_m : vestibuleGap_m(h);
  const std::string closing =
      fmt::format("{} below {:g} of its width at the cue, or {:g} mm",
                  fromSkin ? "narrowest midline width of the airway-skin's laryngeal branch"
                           : "arytenoid apex (mean of both) to petiole",
                  rules.sealedRatio, rules.sealed_m * 1e3);
  const std::string opening = "first later frame at which it is no longer so";
  if (gap.empty()) {
    const std::string lack =
        "the skin has no laryngeal branch, and there are no landmarks arytenoid_apex_L, "
        "arytenoid_apex_R and epiglottis_petiole";
    out.events.push_back(found("LVC", closing, h, {}, lack));
    out.events.push_back(found("LVCoff", opening, h, {}, lack));
    return;
  }
  const Closure c = measureClosure(gap, cueFrame(h), rules);
  out.events.push_back(
      found("LVC", closing, h, c.closed, fmt::format("narrowest ratio is {:.2f}", c.narrowest)));
  out.events.push_back(found("LVCoff", opening, h, c.reopened,
                             c.closed ? "still closed when the history ends" : "never closed"));
  Series series{"vestibule_gap", "mm", gap};
  for (double& g : series.values) g *= 1e3;
  out.series.push_back(series);
}

void addUes(const History& h, const LumenProfile& lumen, const ScoringRules& rules,
            EventReport& out) {
  const auto [a, b] = lumen.range(rules.uesTop_m, rules.uesEnd_m);
  const std::string at =
      fmt::format("midline gap over s {:g}-{:g} mm: ", rules.uesTop_m * 1e3, rules.uesEnd_m * 1e3);
  const std::string open =
      fmt::format("first frame with {:g} mm or more at the narrowest level", rules.uesOpen_m * 1e3);
  const std::string widest = "frame at which the narrowest level is widest";
  const std::string shut = "first frame after UESMax with every level below the open width";
  std::vector<double> narrow = uesGap_m(h, lumen, rules), wide;
  for (int f = 0; a < b && f < h.frames(); ++f)
    wide.push_back(*std::max_element(lumen.gap_m[f].begin() + a, lumen.gap_m[f].begin() + b));
  const std::string lack = narrow.empty() ? "the skin has no midline there" : "it never opens";
  const auto ueso = firstFrame(narrow, cueFrame(h), [&](double g) { return g >= rules.uesOpen_m; });
  std::optional<int> uesMax, uesc;
  if (ueso) {
    uesMax =
        static_cast<int>(std::max_element(narrow.begin() + *ueso, narrow.end()) - narrow.begin());
    uesc = firstFrame(wide, *uesMax, [&](double g) { return g < rules.uesOpen_m; });
  }
  out.events.push_back(found("UESO", at + open, h, ueso, lack));
  out.events.push_back(found("UESMax", at + widest, h, uesMax, lack));
  out.events.push_back(
      found("UESC", at + shut, h, uesc, ueso ? "still open when the history ends" : lack));
  Quantity width{"ues_max_gap", {}, "mm", uesMax.value_or(-1), at + widest, lack};
  if (uesMax) width.value = narrow[*uesMax] * 1e3, width.reason.clear();
  out.quantities.push_back(width);
  for (double& g : narrow) g *= 1e3;
  if (!narrow.empty()) out.series.push_back({"ues_gap", "mm", narrow});
}

void addConstriction(const History& h, const LumenProfile& lumen, const ScoringRules& rules,
                     EventReport& out) {
  const std::string rule =
      fmt::format("frame of the least midsagittal lumen area over s {:g}-{:g} mm, after the cue",
                  rules.pharynxTop_m * 1e3, rules.pharynxEnd_m * 1e3);
  const auto [a, b] = lumen.range(rules.pharynxTop_m, rules.pharynxEnd_m);
  Quantity ratio{"pcr",
                 {},
                 "ratio",
                 -1,
                 "midsagittal lumen area at MPC over that at the cue",
                 "the skin has no midline there"};
  if (b - a < 2) {
    out.events.push_back(found("MPC", rule, h, {}, ratio.reason));
    out.quantities.push_back(ratio);
    return;
  }
  Series area{"pharyngeal_area", "mm2", {}};
  for (int f = 0; f < h.frames(); ++f)
    area.values.push_back(1e6 *
                          midlineArea_m2(lumen, h.skin, f, rules.pharynxTop_m, rules.pharynxEnd_m));
  const int cue = cueFrame(h);
  const int mpc = static_cast<int>(std::min_element(area.values.begin() + cue, area.values.end()) -
                                   area.values.begin());
  // A pharynx that never narrows has no constriction to time.
  const bool narrows = area.values[mpc] < 0.99 * area.values[cue];
  out.events.push_back(found("MPC", rule, h, narrows ? std::optional(mpc) : std::nullopt,
                             "the pharynx never narrows by more than 1 %"));
  if (area.values[cue] > 0)
    ratio.frame = mpc, ratio.value = area.values[mpc] / area.values[cue], ratio.reason.clear();
  out.quantities.push_back(ratio);
  Quantity share{
      "mpc_percent_c2c4", {}, "%(C2-4)2", -1, "midsagittal lumen area at MPC over (C2-C4)^2", ""};
  const double c2c4_mm = spineAt(h, mpc).c2c4_m * 1e3;
  set(share, 100 * area.values[mpc] / (c2c4_mm * c2c4_mm), mpc);
  out.quantities.push_back(share);
  out.series.push_back(std::move(area));
}

MeasuredEvent measureRest(const History& h, std::optional<int> uesc, const ScoringRules& rules) {
  const std::string rule =
      fmt::format("first frame after UESC from which every structure moves < {:g} mm/s for {:g} s",
                  rules.restSpeed_ms * 1e3, rules.restHold_s);
  if (!uesc) return found("SwRest", rule, h, {}, "UESC is not known");
  if (h.structures.empty()) return found("SwRest", rule, h, {}, "the history has no structures");
  std::vector<double> fastest(h.frames(), 0.0);
  for (const auto& s : h.structures) {
    const std::vector<double> v = structureSpeed(s, h.time_s);
    for (std::size_t f = 0; f < v.size(); ++f) fastest[f] = std::max(fastest[f], v[f]);
  }
  constexpr double kRounding_s = 1e-9;
  for (int f = *uesc, since = f; f < h.frames(); ++f) {
    if (fastest[f] >= rules.restSpeed_ms)
      since = f + 1;
    else if (h.time_s[f] - h.time_s[since] >= rules.restHold_s - kRounding_s)
      return found("SwRest", rule, h, since, "");
  }
  return found("SwRest", rule, h, {}, "something still moves when the history ends");
}

std::optional<double> timeOf(std::span<const MeasuredEvent> events, std::string_view name) {
  for (const auto& e : events)
    if (e.name == name) return e.time_s;
  return std::nullopt;
}

void addIntervals(const History& h, const ScoringRules& rules, EventReport& out) {
  auto interval = [&](const char* name, std::optional<double> from, std::optional<double> to,
                      std::string rule) {
    Quantity q{name, {}, "s", -1, std::move(rule), "one of its two events is not known"};
    if (from && to) q.value = *to - *from, q.reason.clear();
    out.quantities.push_back(q);
  };
  auto at = [&](std::string_view name) { return timeOf(out.events, name); };
  interval("swallow_reaction_time", at("BPM"), at("HYB"), "BPM to HYB");
  interval("time_to_lvc", at("HYB"), at("LVC"), "HYB to LVC");
  interval("lvc_duration", at("LVC"), at("LVCoff"), "LVC to LVCoff");
  interval("ues_open_duration", at("UESO"), at("UESC"), "UESO to UESC");

  std::optional<double> tip_s;
  for (const auto& e : h.plannedEvents)
    if (e.name == "tip_press") tip_s = e.time_s;
  interval("oral_transit", tip_s ? tip_s : at("tongue_onset"), at("BPM"),
           tip_s ? "planned tip press to BPM" : "tongue onset to BPM (no tip press planned)");

  // The tail is that of what this swallow carries through; what stays behind is residue.
  const std::vector<double> past = shareBeyond(h.bolus, rules.uesEnd_m);
  const auto uesc = at("UESC");
  const double through = past.empty() ? 0.0 : past[uesc ? frameAt(h, *uesc) : h.frames() - 1];
  std::optional<int> tail;
  if (through >= rules.throughShare)
    tail = firstFrame(past, 0, [&](double s) { return s >= rules.tailShare * through; });
  interval("pharyngeal_transit", at("BPM"), tail ? std::optional(h.time_s[*tail]) : std::nullopt,
           fmt::format("BPM to the first frame with {:g} % of what has passed s = {:g} mm by UESC "
                       "past it",
                       rules.tailShare * 100, rules.uesEnd_m * 1e3));
  if (!tail)
    out.quantities.back().reason =
        hasBolus(h)
            ? fmt::format("less than {:g} % of the bolus passes the UES", rules.throughShare * 100)
            : "the history has no bolus";
}
}  // namespace

int frameAt(const History& h, double time_s) {
  constexpr double kRounding_s = 1e-6;  // times are decimal fractions of a second
  int f = 0;
  while (f + 1 < h.frames() && h.time_s[f] < time_s - kRounding_s) ++f;
  return f;
}

int cueFrame(const History& h) {
  return frameAt(h, h.meta.cue_s);
}

MeasuredEvent measureBpm(const History& h, const ScoringRules& rules) {
  const std::string rule = fmt::format("first frame with {:g} % of V0 past the ramus, s = {:g} mm",
                                       rules.headShare * 100, rules.ramus_m * 1e3);
  if (!hasBolus(h)) return found("BPM", rule, h, {}, "the history has no bolus");
  return found("BPM", rule, h,
               firstFrame(shareBeyond(h.bolus, rules.ramus_m), 0,
                          [&](double share) { return share >= rules.headShare; }),
               "the bolus head never passes the ramus");
}

std::vector<double> structureSpeed(const frame::StructureTrack& track,
                                   std::span<const double> time_s) {
  const int n = static_cast<int>(track.rigid ? track.poses.size() : track.positions.size());
  std::vector<double> out(n, 0.0);
  const int vertices = static_cast<int>(track.rest.size());
  const int stride = std::max(1, vertices / kSpeedSamples);
  for (int i = 0; n > 1 && i < n; ++i) {
    const int a = std::max(0, i - 1), b = std::min(n - 1, i + 1);
    double farthest = 0;
    for (int v = 0; v < vertices; v += stride) {
      const Vec3 rest = track.rest[v].cast<double>();
      const Vec3 step = track.rigid
                            ? Vec3(track.poses[b].apply(rest) - track.poses[a].apply(rest))
                            : Vec3((track.positions[b][v] - track.positions[a][v]).cast<double>());
      farthest = std::max(farthest, step.norm());
    }
    out[i] = farthest / (time_s[b] - time_s[a]);
  }
  return out;
}

Closure measureClosure(std::span<const double> gap_m, int rest, const ScoringRules& rules) {
  Closure c;
  const double rest_m = gap_m[rest];
  auto sealed = [&](double g) { return g < rules.sealed_m || g < rules.sealedRatio * rest_m; };
  c.closed = firstFrame(gap_m, rest, sealed);
  if (c.closed) c.reopened = firstFrame(gap_m, *c.closed, [&](double g) { return !sealed(g); });
  const double least = *std::min_element(gap_m.begin() + rest, gap_m.end());
  c.narrowest = rest_m > 0 ? least / rest_m : 0;
  return c;
}

std::vector<double> vestibuleGap_m(const History& h) {
  const auto *left = wholeLandmark(h, "arytenoid_apex_L"),
             *right = wholeLandmark(h, "arytenoid_apex_R"),
             *petiole = wholeLandmark(h, "epiglottis_petiole");
  std::vector<double> gap;
  if (!left || !right || !petiole) return gap;
  for (int f = 0; f < h.frames(); ++f)
    gap.push_back((0.5f * (left->positions[f] + right->positions[f]) - petiole->positions[f])
                      .cast<double>()
                      .norm());
  return gap;
}

std::vector<double> petioleGap_m(const History& h, const LumenProfile& lumen) {
  constexpr double kAround_m = 4e-3;  // of the petiole's height; assumed, 3-6 mm
  const auto* petiole = wholeLandmark(h, "epiglottis_petiole");
  std::vector<std::size_t> at;
  const int rest = cueFrame(h);
  for (std::size_t k = 0; petiole && k < lumen.vestibuleFront.size(); ++k) {
    const double z = h.skin.positions[rest][lumen.vestibuleFront[k]].z();
    if (std::abs(z - petiole->positions[rest].z()) <= kAround_m) at.push_back(k);
  }
  if (at.empty()) return vestibuleGap_m(h);
  std::vector<double> out;
  for (const auto& gaps : lumen.vestibuleGap_m) {
    double least = gaps[at.front()];
    for (std::size_t k : at) least = std::min(least, gaps[k]);
    out.push_back(least);
  }
  return out;
}

std::vector<double> uesGap_m(const History& h, const LumenProfile& lumen,
                             const ScoringRules& rules) {
  const auto [a, b] = lumen.range(rules.uesTop_m, rules.uesEnd_m);
  std::vector<double> narrow;
  for (int f = 0; a < b && f < h.frames(); ++f)
    narrow.push_back(*std::min_element(lumen.gap_m[f].begin() + a, lumen.gap_m[f].begin() + b));
  return narrow;
}

EventReport measureEvents(const History& h, const LumenProfile& lumen, const MeasuredEvent& onset,
                          const MeasuredEvent& bpm, const ScoringRules& rules) {
  EventReport out;
  out.events = {onset, bpm, measureHyb(h, rules)};
  addVestibule(h, lumen, rules, out);
  addUes(h, lumen, rules, out);
  addConstriction(h, lumen, rules, out);
  const auto uesc = timeOf(out.events, "UESC");
  out.events.push_back(
      measureRest(h, uesc ? std::optional(frameAt(h, *uesc)) : std::nullopt, rules));
  addIntervals(h, rules, out);
  // In the order in which they happened; what was not found goes last.
  std::stable_sort(out.events.begin(), out.events.end(), [](const auto& a, const auto& b) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    return a.time_s.value_or(kNever) < b.time_s.value_or(kNever);
  });
  return out;
}
}  // namespace swallowclip::scoring
