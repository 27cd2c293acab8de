// SPDX-License-Identifier: MIT
#include "scoring/excursions.h"

#include <fmt/format.h>

#include <algorithm>

#include "scoring/events.h"
#include "scoring/spine.h"

namespace swallowclip::scoring {
namespace {
using frame::History;

struct Body {
  const char *name, *landmark, *structure;
};
constexpr Body kHyoid{"hyoid", "hyoid_body_centre", "hyoid"};
constexpr Body kLarynx{"larynx", "thyroid_notch", "thyroid"};

int largestAfter(const std::vector<double>& x, int from) {
  return static_cast<int>(std::max_element(x.begin() + from, x.end()) - x.begin());
}
}  // namespace

Excursions measureExcursions(const History& h) {
  Excursions out;
  const int rest = cueFrame(h);
  for (const Body& body : {kHyoid, kLarynx}) {
    const Displacement moved = displacementOf(h, body.landmark, body.structure, rest);
    const auto add = [&](const char* way, const std::vector<double>& x) {
      const std::string name = fmt::format("{}_{}", body.name, way);
      const std::string lack =
          fmt::format("no landmark {} and no rigid structure {}", body.landmark, body.structure);
      Quantity mm{
          name, {}, "mm", -1, "largest displacement since the cue, relative to the vertebrae",
          lack};
      Quantity share{name + "_c2c4",
                     {},
                     "%C2-C4",
                     -1,
                     "the same as a share of the distance from C2 to C4",
                     lack};
      if (!x.empty()) {
        const int at = largestAfter(x, rest);
        set(mm, x[at] * 1e3, at);
        set(share, 100 * x[at] / spineAt(h, at).c2c4_m, at);
        out.series.push_back(inMillimetres(name, x));
      }
      out.quantities.push_back(std::move(mm));
      out.quantities.push_back(std::move(share));
    };
    add("anterior", moved.anterior_m);
    add("superior", moved.superior_m);
  }
  return out;
}

std::optional<int> scoreComponent9(double ratio, const ScoringRules& r) {
  return ratio >= r.hyoidFull ? 0 : ratio >= r.hyoidNone ? 1 : 2;
}

ComponentReport measureComponent9(const History& h, const ScoringRules& rules) {
  ComponentReport out;
  const int rest = cueFrame(h);
  const Displacement moved = displacementOf(h, kHyoid.landmark, kHyoid.structure, rest);
  Quantity ratio{
      "hyoid_anterior_ratio",
      {},
      "ratio",
      -1,
      fmt::format("H: forward travel at the frame of the largest hyoid displacement over "
                  "{:g} mm",
                  rules.normalHyoidAnterior_m * 1e3),
      "no hyoid"};
  out.decision.reason = "hyoid excursion: no landmark hyoid_body_centre and no structure hyoid";
  if (!moved.anterior_m.empty()) {
    const int at = largestAfter(moved.magnitude_m(), rest);
    const double value = moved.anterior_m[at] / rules.normalHyoidAnterior_m;
    set(ratio, value, at);
    out.decision = decide([&](const ScoringRules& r) { return scoreComponent9(value, r); }, rules,
                          fmt::format("H {:.2f}", value));
    out.frame = at;
  }
  out.quantities = {ratio};
  out.liveSeries = "hyoid_anterior";
  return out;
}

std::optional<int> scoreComponent10(double angle, const ScoringRules& r) {
  return angle >= r.inverted_rad ? 0 : angle >= r.turned_rad ? 1 : 2;
}

ComponentReport measureComponent10(const History& h, const ScoringRules& rules) {
  ComponentReport out;
  const std::vector<double> angle = epiglottisAngle_rad(h);
  Quantity most{"epiglottis_angle_max",
                {},
                "deg",
                -1,
                "largest angle of petiole to tip from superior, backwards, after the cue",
                "no landmarks epiglottis_petiole and epiglottis_tip_cartilage"};
  out.decision.reason = "epiglottic movement: " + most.reason;
  if (!angle.empty()) {
    const int at = largestAfter(angle, cueFrame(h));
    const double degrees = angle[at] * 180 / kPi;
    set(most, degrees, at);
    out.decision = decide([&](const ScoringRules& r) { return scoreComponent10(angle[at], r); },
                          rules, fmt::format("turns to {:.0f} degrees", degrees));
    out.frame = at;
  }
  out.quantities = {most};
  out.liveSeries = "epiglottis_angle";
  return out;
}
}  // namespace swallowclip::scoring
