// SPDX-License-Identifier: MIT
#include "scoring/measure.h"

#include <array>
#include <cmath>

#include "scoring/airway.h"
#include "scoring/bolus_head.h"
#include "scoring/clearance.h"
#include "scoring/closures.h"
#include "scoring/component12.h"
#include "scoring/component13.h"
#include "scoring/component14.h"
#include "scoring/component15.h"
#include "scoring/component4.h"
#include "scoring/component8.h"
#include "scoring/conservation.h"
#include "scoring/events.h"
#include "scoring/excursions.h"
#include "scoring/residue.h"
#include "scoring/residue_area.h"

namespace swallowclip::scoring {
namespace {

using frame::History;

/// Why a component has no score yet: what the history lacks, or that nobody has built its rule.
constexpr std::array<const char*, kComponents + 1> kNotJudged{
    "", "lip closure: the history has no lips or chin",
    "", "mastication: the history holds a fluid bolus, no solid",
    "", "",
    "", "",
    "", "",
    "", "",
    "", "",
    "", "",
    "", "esophageal clearance: the history ends at the UES (s = 180 mm)"};

std::string arrayProblem(const History& h) {
  const std::size_t n = h.time_s.size();
  if (n < 2) return fmt::format("{} frames; at least 2 are needed", n);
  for (std::size_t f = 0; f < n; ++f)
    if (!std::isfinite(h.time_s[f]) || (f > 0 && !(h.time_s[f] > h.time_s[f - 1])))
      return fmt::format("time does not rise at frame {}", f);
  if (!(h.meta.fps > 0)) return fmt::format("{} frames per second", h.meta.fps);
  if (h.skin.positions.size() != n)
    return fmt::format("{} skin frames for {} times", h.skin.positions.size(), n);
  for (const auto& s : h.structures) {
    if ((s.rigid ? s.poses.size() : s.positions.size()) != n)
      return fmt::format("structure {} does not have {} frames", s.name, n);
    for (const auto& p : s.positions)
      if (!s.rigid && p.size() != s.rest.size())
        return fmt::format("structure {} changes its vertex count", s.name);
  }
  const auto& b = h.bolus;
  if (b.s_m.empty()) return "";
  if (b.s_m.size() != n || b.state.size() != n || b.region.size() != n)
    return "bolus arrays do not have as many frames as there are times";
  for (std::size_t f = 0; f < n; ++f)
    if (b.s_m[f].size() != b.s_m[0].size() || b.state[f].size() != b.s_m[0].size() ||
        b.region[f].size() != b.s_m[0].size())
      return fmt::format("the particle count changes at frame {}", f);
  return "";
}

void judgeLabel(Metrics& m) {
  const auto score = m.scores.find(m.component);
  if (score == m.scores.end() || m.score < 0) {
    m.labelReason = "no score was intended";
  } else if (!score->second) {
    m.labelReason = m.reasons[m.component];
  } else if (*score->second != m.score) {
    m.labelConfirmed = false;
    m.labelReason = fmt::format("meant to show {}-{}, measured {} ({})", m.component, m.score,
                                *score->second, m.reasons[m.component]);
  } else {
    m.labelConfirmed = !m.ambiguous[m.component];
    m.labelReason = "as intended";
    if (const auto cut = m.nearestCuts.find(m.component); cut != m.nearestCuts.end())
      m.labelReason +=
          fmt::format(", {:.0f} % from the cut {}", 100 * m.margins[m.component], cut->second);
    if (!*m.labelConfirmed) m.labelReason += ": too near to call";
  }
}

template <class T>
void append(std::vector<T>& to, std::vector<T> from) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

std::vector<Series> bolusSeries(const History& h, const ScoringRules& rules) {
  Series mouth{"oral_share", "share", {}}, pharynx{"pharyngeal_share", "share", {}};
  for (int f = 0; f < h.frames(); ++f) {
    double oral = 0, throat = 0;
    for (std::size_t k = 0; k < h.bolus.state[f].size(); ++k) {
      if (!frame::isThere(h.bolus.state[f][k])) continue;
      const frame::Region r = h.bolus.region[f][k];
      oral += r == frame::Region::oral;
      throat += r == frame::Region::oropharynx || r == frame::Region::hypopharynx;
    }
    const auto all = static_cast<double>(h.bolus.state[f].size());
    mouth.values.push_back(oral / all), pharynx.values.push_back(throat / all);
  }
  return {mouth, pharynx, inMillimetres("bolus_head", bolusHead_m(h.bolus, rules)),
          inMillimetres("bolus_centroid", bolusCentroid_m(h.bolus, rules))};
}

void add(int component, ComponentReport report, Metrics& m) {
  const Decision& d = report.decision;
  m.scores[component] = d.score;
  m.reasons[component] = d.reason;
  if (d.score) {
    m.ambiguous[component] = d.ambiguous;
    if (d.margin) m.margins[component] = *d.margin, m.nearestCuts[component] = d.cut;
  }
  if (report.frame >= 0) m.scoredFrames[component] = report.frame;
  if (!report.liveSeries.empty()) m.liveSeries[component] = report.liveSeries;
  append(m.quantities, std::move(report.quantities));
  append(m.series, std::move(report.series));
}
}  // namespace

Result<Metrics> measure(const History& history, const ScoringRules& rules) {
  if (const std::string problem = arrayProblem(history); !problem.empty())
    return failure("history", problem, "simulate again");
  auto lumen = midlineGaps(history.skin);
  if (!lumen) return std::unexpected(lumen.error());

  Metrics m;
  m.component = history.meta.component, m.score = history.meta.score;
  for (int c = 1; c <= kComponents; ++c) m.scores[c] = std::nullopt, m.reasons[c] = kNotJudged[c];

  const MeasuredEvent bpm = measureBpm(history, rules);
  Component4Report four = measureComponent4(history, *lumen, bpm, rules);
  EventReport events = measureEvents(history, *lumen, four.onset, bpm, rules);
  m.events = std::move(events.events);
  add(4, std::move(four), m);
  append(m.quantities, std::move(events.quantities));
  append(m.series, std::move(events.series));
  const MeasuredEvent* rest = m.event("SwRest");
  const auto residue =
      measureResidue(history, rest->time_s ? std::optional(rest->frame) : std::nullopt, rules);
  const MeasuredEvent &onset = *m.event("tongue_onset"), &hyb = *m.event("HYB");
  add(2, measureComponent2(history, onset, rules), m);
  add(5, measureResidueComponent(5, residue, rules), m);
  add(6, measureComponent6(history, hyb, rules), m);
  add(7, measureComponent7(history, *lumen, rules), m);
  add(8, measureComponent8(history, *lumen, hyb, rules), m);
  add(9, measureComponent9(history, rules), m);
  add(10, measureComponent10(history, rules), m);
  add(11, measureComponent11(history, *lumen, rules), m);
  add(12, measureComponent12(history, rules), m);
  add(13, measureComponent13(history, m.events, rules), m);
  add(14, measureComponent14(history, uesGap_m(history, *lumen, rules), m.events, rules), m);
  add(15, measureComponent15(history, rules), m);
  add(16, measureResidueComponent(16, residue, rules), m);
  Excursions excursions = measureExcursions(history);
  append(m.quantities, std::move(excursions.quantities));
  append(m.series, std::move(excursions.series));
  append(m.quantities, measureAirway(history, rules));
  append(m.quantities, measureResidueAreas(history, residue, rules));
  if (hasBolus(history)) append(m.series, bolusSeries(history, rules));
  append(m.quantities, measureClearance(history, rules));
  if (hasBolus(history))
    m.series.push_back({"past_ramus", "share", shareBeyond(history.bolus, rules.ramus_m)});
  for (Quantity& q : m.quantities)
    for (const RuleField& field : ruleFields())
      if (field.cuts(q.name)) q.cuts.push_back(rules.*field.member / field.scale);
  m.conservation = countParticles(history);
  judgeLabel(m);
  return m;
}
}  // namespace swallowclip::scoring
