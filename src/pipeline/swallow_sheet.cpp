// SPDX-License-Identifier: MIT
#include "pipeline/swallow_sheet.h"

#include <algorithm>
#include <cmath>

#include "pipeline/components.h"

namespace swallowclip::pipeline {
namespace {
using frame::History;
using plot::Band;
using plot::Panel;
using scoring::Metrics;

enum Colour { blue, vermillion, green, pink, orange, sky, dark };

std::optional<double> eventTime(const Metrics& m, const char* name) {
  const auto* e = m.event(name);
  return e ? e->time_s : std::nullopt;
}

plot::Series line(const History& h, const Metrics& m, const char* name, const char* label,
                  Colour colour) {
  plot::Series out{label, {}, false, colour};
  if (const auto* s = m.find(name))
    for (int f = 0; f < h.frames(); ++f) out.points.push_back({h.time_s[f], s->values[f]});
  return out;
}

Panel linesOf(std::string title, std::string yLabel, double height_px,
              std::vector<plot::Series> series) {
  Panel p{.title = std::move(title), .yLabel = std::move(yLabel), .height_px = height_px};
  for (auto& s : series)
    if (!s.points.empty()) p.series.push_back(std::move(s));
  return p;
}

class Gantt {
 public:
  Gantt(const History& h, const Metrics& m) : h_(h), m_(m) {}

  /// From one measured event to another.
  void between(const char* label, const char* from, const char* to, Colour colour) {
    const auto a = eventTime(m_, from), b = eventTime(m_, to);
    if (a) add(label, *a, b.value_or(h_.time_s.back()), colour, b ? "" : " (to the end)");
  }
  /// The longest stretch over which a series passes a test.
  template <class Test>
  void while_(const char* label, const char* series, Test test, Colour colour) {
    const auto* s = m_.find(series);
    if (!s) return;
    int best = 0, from = 0, since = -1;
    for (int f = 0; f <= h_.frames(); ++f) {
      const bool holds = f < h_.frames() && std::isfinite(s->values[f]) && test(s->values[f]);
      if (holds && since < 0) since = f;
      if (!holds && since >= 0) {
        if (f - since > best) best = f - since, from = since;
        since = -1;
      }
    }
    if (best > 1) add(label, h_.time_s[from], h_.time_s[from + best - 1], colour, "");
  }
  std::vector<Band> bands;

 private:
  void add(const char* label, double from, double to, Colour colour, const char* note) {
    bands.push_back({label, from, to, colour, fmt::format("{:.2f} s{}", to - from, note)});
  }
  const History& h_;
  const Metrics& m_;
};

Panel ganttOf(const History& h, const Metrics& m) {
  constexpr double kSome = 0.02;      // share that counts as there: the bolus head's
  constexpr double kMoved_mm = 2;     // beyond the hyoid's slow pre-rise
  constexpr double kTouching_mm = 1;  // as the contact front
  Gantt g(h, m);
  const auto some = [](double share) { return share >= kSome; };
  const auto moved = [](double mm) { return mm > kMoved_mm; };
  const auto touching = [](double mm) { return mm < kTouching_mm; };
  g.while_("bolus in the mouth", "oral_share", some, orange);
  g.between("tongue drives it back", "tongue_onset", "BPM", vermillion);
  g.while_("velum shuts the nose", "velar_gap", touching, pink);
  g.while_("bolus in the pharynx", "pharyngeal_share", some, orange);
  g.while_("hyoid forward", "hyoid_anterior", moved, blue);
  g.while_("larynx up", "larynx_superior", moved, blue);
  g.between("vestibule closed", "LVC", "LVCoff", pink);
  g.while_("tongue base on the wall", "tongue_base_gap", touching, vermillion);
  g.between("UES open", "UESO", "UESC", green);
  return {.height_px = 24.0 * static_cast<double>(std::max<std::size_t>(g.bands.size(), 1)),
          .bands = std::move(g.bands)};
}

Panel residueOf(const History& h, const Metrics& m) {
  Panel p{.title = "Left behind when the swallow is over", .yLabel = "mL"};
  constexpr const char* kMouth[] = {"floor_of_mouth", "palate", "tongue", "lateral_sulcus_left",
                                    "lateral_sulcus_right"};
  constexpr const char* kThroat[] = {"tongue_base",     "vallecula_left",      "vallecula_right",
                                     "pharyngeal_wall", "aryepiglottic_folds", "pyriform_left",
                                     "pyriform_right"};
  const auto add = [&](const char* where, Colour colour) {
    const std::string name = std::string("residue_") + where;
    const auto *ml = m.quantity(name), *share = m.quantity(name + "_share");
    if (!ml || !ml->value) return;
    std::string label = where;
    std::replace(label.begin(), label.end(), '_', ' ');
    const double percent = share && share->value ? 100 * *share->value : 0;
    p.amounts.push_back(
        {label, *ml->value,
         *ml->value > 0 ? fmt::format("{:.2f} mL, {:.1f} %", *ml->value, percent) : "none",
         colour});
  };
  for (const char* where : kMouth) add(where, orange);
  for (const char* where : kThroat) add(where, blue);
  // The residue rule's film and pool, so that a drop does not look like a lake.
  const double offered_mL =
      h.bolus.s_m.empty()
          ? 0
          : 1e6 * h.bolus.particleVolume_m3 * static_cast<double>(h.bolus.s_m.front().size());
  if (offered_mL > 0) p.levels = {{0.01 * offered_mL, "1 %"}, {0.05 * offered_mL, "5 %"}};
  p.height_px = 17.0 * static_cast<double>(p.amounts.size());
  return p;
}

std::string titleOf(const History& h) {
  const Component* c = findComponent(h.meta.component);
  if (c && h.meta.score >= 0 && h.meta.score <= c->highestScore())
    return fmt::format("{}, score {}: {}", c->title, h.meta.score, c->scores[h.meta.score]);
  return h.meta.swallow;
}

std::string scoresOf(const Metrics& m) {
  std::string out = "Measured:";
  for (const auto& [component, score] : m.scores)
    if (score) out += fmt::format("  {}-{}", component, *score);
  if (const auto* pas = m.quantity("pas"); pas && pas->value)
    out += fmt::format("   PAS {:g}", *pas->value);
  return out;
}
}  // namespace

plot::Figure swallowSheet(const History& h, const Metrics& m) {
  plot::Figure f;
  f.title = titleOf(h);
  f.subtitle =
      fmt::format("{}  ·  {}", h.meta.bolus == "none" ? "no bolus" : h.meta.bolus, scoresOf(m));
  f.xLabel = "time from the cue (s)";
  for (const auto& e : m.events) {
    std::string words = e.name;
    std::replace(words.begin(), words.end(), '_', ' ');
    if (e.time_s) f.marks.push_back({*e.time_s, words});
  }
  f.panels.push_back(ganttOf(h, m));
  Panel path = linesOf("Along the path", "s (mm)", 190,
                       {line(h, m, "contact_front", "tongue contact front", vermillion),
                        line(h, m, "bolus_head", "bolus head", sky),
                        line(h, m, "bolus_centroid", "bolus centroid", orange)});
  path.levels = {{72, "mandibular ramus"}, {110, "valleculae"}, {150, "UES"}};
  f.panels.push_back(std::move(path));
  f.panels.push_back(linesOf("Displacement", "mm", 150,
                             {line(h, m, "hyoid_anterior", "hyoid forward", blue),
                              line(h, m, "hyoid_superior", "hyoid up", sky),
                              line(h, m, "larynx_anterior", "larynx forward", green),
                              line(h, m, "larynx_superior", "larynx up", dark)}));
  f.panels.push_back(linesOf("Widths", "mm", 150,
                             {line(h, m, "ues_gap", "UES", green),
                              line(h, m, "tongue_base_gap", "tongue base to wall", vermillion),
                              line(h, m, "petiole_gap", "vestibule", pink),
                              line(h, m, "velar_gap", "velum to wall", blue)}));
  if (Panel residue = residueOf(h, m); !residue.amounts.empty())
    f.panels.push_back(std::move(residue));
  f.footer = fmt::format("{}  ·  {}  ·  inputs {}", h.meta.program, m.labelReason,
                         h.meta.inputsSha256.substr(0, 12));
  return f;
}
}  // namespace swallowclip::pipeline
