// SPDX-License-Identifier: MIT
#include "scene/side_file.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/digest.h"
#include "core/error.h"

namespace swallowclip::scene {
namespace {
using Json = nlohmann::json;

// Rounded to 6 significant digits: enough for every measure, and steady in print.
Json number(double v) {
  if (!std::isfinite(v)) return nullptr;
  if (v == 0) return 0.0;
  const double scale = std::pow(10.0, 5 - std::floor(std::log10(std::abs(v))));
  return std::round(v * scale) / scale;
}
Json number(const std::optional<double>& v) {
  return v ? number(*v) : Json(nullptr);
}

Json conservationJson(const scoring::Conservation& c) {
  Json j = {{"particles_start", c.particlesStart},
            {"particles_end", c.particlesEnd},
            {"swallowed", c.swallowed},
            {"left_in_oral", c.leftInOral},
            {"left_in_pharynx", c.leftInPharynx},
            {"in_airway", c.inAirway},
            {"in_nasopharynx", c.inNasopharynx},
            {"in_esophagus", c.inEsophagus},
            {"escaped", c.escaped},
            {"swallowed_fraction", number(c.swallowedFraction)},
            {"mean_density_error", number(c.meanDensityError)},
            {"max_density_error", number(c.maxDensityError)},
            {"film_fraction", number(c.filmFraction)},
            {"volume_error", number(c.volumeError)}};
  if (c.coating_m3) {
    j["coated"] = c.coated;
    j["coating_mL"] = number(*c.coating_m3 * 1e6);
  }
  return j;
}

std::uint64_t digestOfAll(const frame::History& h) {
  std::uint64_t all = 0;
  for (int k = 0; k < h.frames(); ++k) {
    const std::uint64_t one = h.digest(k);
    all = stateDigest(&one, sizeof one, all);
  }
  return all;
}
}  // namespace

std::string sideFileText(const frame::History& h, const scoring::Metrics& m) {
  Json j;
  j["component"] = h.meta.component;
  j["score"] = h.meta.score;
  j["bolus"] = h.meta.bolus;
  j["scene"] = h.meta.scene;
  j["swallow"] = h.meta.swallow;
  j["solver"] = h.meta.solver;
  j["frames"] = h.frames();
  j["fps"] = number(h.meta.fps);
  j["duration_s"] = number(h.frames() / h.meta.fps);
  j["version"] = h.meta.program;
  j["inputs_sha256"] = h.meta.inputsSha256;
  j["state_digest"] = fmt::format("{:016x}", digestOfAll(h));
  j["particle_spacing_mm"] = number(h.meta.particleSpacing_m / kMetrePerMm);
  j["max_particle_speed_m_per_s"] = number(h.meta.maxSpeed_ms);
  j["density_error_share_above_10_percent"] = number(h.meta.shareAboveTenPercent);
  j["solver_steps"] = h.meta.steps;
  j["velocity_clamp_hits"] = h.meta.velocityClamps;
  j["scores_measured"] = Json::object();
  for (const auto& [component, score] : m.scores)
    j["scores_measured"][std::to_string(component)] = score ? Json(*score) : Json(nullptr);
  j["score_reasons"] = Json::object();
  for (const auto& [component, reason] : m.reasons)
    j["score_reasons"][std::to_string(component)] = reason;
  j["score_margins"] = Json::object();
  for (const auto& [component, margin] : m.margins)
    j["score_margins"][std::to_string(component)] = {{"share_of_cut", number(margin)},
                                                     {"cut", m.nearestCuts.at(component)},
                                                     {"ambiguous", m.ambiguous.at(component)}};
  j["label_confirmed"] = m.labelConfirmed ? Json(*m.labelConfirmed) : Json(nullptr);
  j["label_reason"] = m.labelReason;
  j["events_s"] = Json::object();
  for (const auto& e : m.events) j["events_s"][e.name] = number(e.time_s);
  j["planned_events_s"] = Json::object();
  for (const auto& e : h.plannedEvents) j["planned_events_s"][e.name] = number(e.time_s);
  j["quantities"] = Json::object();
  for (const auto& q : m.quantities) {
    Json& out = j["quantities"][q.name];
    out = {{"value", number(q.value)}, {"unit", q.unit}};
    if (q.frame >= 0) out["frame"] = q.frame;
    if (!q.cuts.empty()) out["cuts"] = q.cuts;
    out["rule"] = q.rule;
    if (!q.reason.empty()) out["reason"] = q.reason;
  }
  j["bolus_conservation"] = m.conservation ? conservationJson(*m.conservation) : Json(nullptr);
  j["credit"] =
      "Training illustration, not for diagnosis. MBSImP is named only to say what the clip shows.";
  return j.dump(1) + "\n";
}
}  // namespace swallowclip::scene
