// SPDX-License-Identifier: MIT
#include "overlay/report.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace swallowclip::overlay {
namespace {
std::string jsonNumber(const std::optional<double>& x) {
  return x && std::isfinite(*x) ? fmt::format("{:.6g}", *x) : "null";
}
}  // namespace

std::vector<EventRow> eventRows(const Marks& marks, const study::StudyInfo& study,
                                const scoring::Metrics& model, const TimeWarp& warp) {
  std::vector<EventRow> rows;
  for (const StudyEvent& e : marks.events) {
    EventRow row{e.name, study.time_s[static_cast<std::size_t>(e.frame)], {}, {}};
    if (const scoring::MeasuredEvent* m = model.event(e.name); m && m->time_s) {
      row.model_s = m->time_s;
      row.retimed_s = warp.study_s(*m->time_s);
    }
    rows.push_back(row);
  }
  return rows;
}

TruthReport compare(const Registration& found, const DemoTruth& truth, const frame::History& model,
                    const Clock& clock) {
  TruthReport r;
  double sum = 0;
  int count = 0;
  const auto frames = truth.place.size();
  for (std::size_t f = 0; f < frames; ++f) {
    const Similarity is = found.at(static_cast<double>(f));
    r.angle_deg =
        std::max(r.angle_deg, std::abs(is.angle_rad - truth.place[f].angle_rad) * 180 / kPi);
    for (const LandmarkKind& kind : landmarkKinds()) {
      const frame::LandmarkTrack* track = model.landmark(kind.name);
      if (!kind.fixed || !track) continue;
      const Vec3f& p = track->positions[static_cast<std::size_t>(clock.clipFrameOf[f])];
      const Vec2 plane(p.y(), -p.z());
      sum += (is.apply(plane) - truth.place[f].apply(plane)).squaredNorm();
      ++count;
    }
  }
  r.rms_px = std::sqrt(sum / std::max(1, count));
  r.scale_percent = 100 * std::abs(found.scale() / truth.place[0].scale - 1);
  r.turned_deg =
      (found.at(static_cast<double>(frames - 1)).angle_rad - found.at(0).angle_rad) * 180 / kPi;
  return r;
}

std::string sideText(const study::StudyInfo& study, const Clock& clock,
                     const std::vector<EventRow>& rows, const Registration& registration,
                     const frame::Meta& model, bool resimulated,
                     const std::optional<TruthReport>& truth) {
  std::string text = fmt::format(
      "{{\n  \"statement\": \"Synthetic: simulated swallow, drawn for training. Not for "
      "diagnosis.\",\n  \"version\": \"swallowclip {}\",\n",
      SWALLOWCLIP_VERSION);
  text += fmt::format(
      "  \"study\": {{\"kind\": \"{}\", \"frames\": {}, \"width_px\": {}, \"height_px\": {}, "
      "\"pulses_per_s\": {}, \"frame_times_from\": \"{}\", \"warnings\": [{}]}},\n",
      study.kind, study.frames(), study.width, study.height, jsonNumber(study.rate_hz()),
      study.timing,
      study.warnings.empty() ? "" : fmt::format("\"{}\"", fmt::join(study.warnings, "\", \"")));
  text += fmt::format("  \"frames\": {},\n  \"fps\": {},\n", clock.time_s.size(),
                      jsonNumber(clock.rate.hz()));
  text += fmt::format(
      "  \"model\": {{\"swallow\": \"{}\", \"bolus\": \"{}\", \"component\": {}, \"score\": {}, "
      "\"inputs_sha256\": \"{}\", \"retimed\": \"{}\"}},\n  \"events\": [",
      model.swallow, model.bolus, model.component, model.score, model.inputsSha256,
      resimulated ? "simulated again" : "warped");
  for (const EventRow& r : rows)
    text += fmt::format(
        "{}\n    {{\"name\": \"{}\", \"study_s\": {}, \"model_s\": {}, \"retimed_s\": {}}}",
        &r == rows.data() ? "" : ",", r.name, jsonNumber(r.study_s), jsonNumber(r.model_s),
        jsonNumber(r.retimed_s));
  int outliers = 0, used = 0;
  for (const PointPair& p : registration.pairs()) (p.outlier ? outliers : used) += 1;
  text += fmt::format(
      "\n  ],\n  \"registration\": {{\"pixels_per_mm\": {}, \"residual_rms_px\": {}, "
      "\"residual_rms_mm\": {}, \"points\": {}, \"left_out\": {}, \"follows_head\": {}, "
      "\"patient_per_model\": {}}}",
      jsonNumber(registration.scale() * kMetrePerMm), jsonNumber(registration.rms_px()),
      jsonNumber(registration.rms_mm()), used, outliers, registration.followsMotion(),
      jsonNumber(registration.patientPerModel()));
  if (truth)
    text += fmt::format(
        ",\n  \"truth\": {{\"rms_px\": {}, \"scale_percent\": {}, \"angle_deg\": {}, "
        "\"turned_deg\": {}}}",
        jsonNumber(truth->rms_px), jsonNumber(truth->scale_percent), jsonNumber(truth->angle_deg),
        jsonNumber(truth->turned_deg));
  return text + "\n}\n";
}

std::vector<std::string> noteLines(const std::vector<EventRow>& rows,
                                   const Registration& registration, double frame_s,
                                   const std::optional<TruthReport>& truth) {
  std::vector<std::string> lines;
  for (const EventRow& r : rows) {
    if (!r.retimed_s) {
      lines.push_back(fmt::format("{}: not in the model's swallow, left out", r.name));
      continue;
    }
    const double off = std::abs(*r.retimed_s - r.study_s) / frame_s;
    if (off > 0.5) lines.push_back(fmt::format("{}: {:.2f} frames off", r.name, off));
  }
  std::vector<std::string> outliers;
  for (const PointPair& p : registration.pairs())
    if (p.outlier && std::ranges::any_of(landmarkKinds(), [&](const LandmarkKind& k) {
          return k.fixed && p.name == k.name;
        }))
      outliers.push_back(p.name + (p.frame >= 0 ? fmt::format(" at frame {}", p.frame) : ""));
  if (!outliers.empty())
    lines.push_back(fmt::format("left out as outliers: {}", fmt::join(outliers, ", ")));
  lines.push_back(fmt::format("registration: residual {:.2f} px = {:.2f} mm RMS, {:.2f} pixels/mm",
                              registration.rms_px(), registration.rms_mm(),
                              registration.scale() * kMetrePerMm));
  if (truth)
    lines.push_back(fmt::format(
        "against the truth: {:.2f} px RMS, scale {:.2f} %, angle within {:.2f} deg, turned {:.2f} "
        "deg",
        truth->rms_px, truth->scale_percent, truth->angle_deg, truth->turned_deg));
  return lines;
}
}  // namespace swallowclip::overlay
