// SPDX-License-Identifier: MIT
// The normal swallow's motion as it is measured: plausible paths, the required order of events, and
// the reference values that the rules take from it.
#include "pipeline/confirm.h"
#include "pipeline/simulation.h"
#include "run.h"

namespace swallowclip::pipeline {
namespace {
class NormalSwallow : public test::Run {
 protected:
  void SetUp() override {
    options.bolus = "none";
    options.jobs = 2;
    const auto history = simulateSwallow(options, 0, 30, notes);
    ASSERT_TRUE(history) << history.error().text();
    auto measured = measureHistory(options.scenesFolder(), *history);
    ASSERT_TRUE(measured) << measured.error().text();
    metrics = std::move(*measured);
  }
  double value(const char* name) const {
    const auto* q = metrics.quantity(name);
    EXPECT_TRUE(q && q->value) << name;
    return q && q->value ? *q->value : std::nan("");
  }
  scoring::Metrics metrics;
};

TEST_F(NormalSwallow, MovesAsHealthyAdultsDo) {
  // Ranges of study means, clinical-reference section 2.
  const std::tuple<const char*, double, double> ranges[] = {
      {"hyoid_anterior", 7.6, 18.0},     {"hyoid_superior", 5.8, 25.0},
      {"larynx_superior", 21.1, 33.9},   {"larynx_anterior", 3.4, 8.2},
      {"time_to_lvc", 0.05, 0.30},       {"lvc_duration", 0.31, 1.07},
      {"ues_open_duration", 0.21, 0.67}, {"pcr", 0, 0.14}};
  for (const auto& [name, low, high] : ranges) {
    EXPECT_GE(value(name), low) << name;
    EXPECT_LE(value(name), high) << name;
  }
  // One frame's leave.
  double before = -1;
  for (const char* name :
       {"tongue_onset", "HYB", "LVC", "UESO", "UESMax", "MPC", "UESC", "LVCoff", "SwRest"}) {
    const auto* e = metrics.event(name);
    ASSERT_TRUE(e && e->time_s) << name;
    EXPECT_GE(*e->time_s, before - 1.0 / 30) << name;
    before = *e->time_s;
  }
}

TEST_F(NormalSwallow, IsWhatTheRulesCallNormal) {
  for (const char* name : {"larynx_rise_ratio", "ues_diameter_ratio", "ues_open_ratio"})
    EXPECT_NEAR(value(name), 1, 0.05) << name;
  for (const char* name : {"wall_excursion_2", "wall_excursion_3", "wall_excursion_4",
                           "shortening_ratio", "hyoid_anterior_ratio"})
    EXPECT_NEAR(value(name), 1, 0.15) << name;
  for (int component : {4, 8, 9, 10, 11, 12, 13, 14, 15}) {
    EXPECT_EQ(metrics.scores.at(component), 0)
        << component << ": " << metrics.reasons.at(component);
    // The epiglottis is folded to 123 degrees, 7 % beyond inverted.
    EXPECT_EQ(metrics.ambiguous.at(component), component == 10) << component;
  }
}
}  // namespace
}  // namespace swallowclip::pipeline
