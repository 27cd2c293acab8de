// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "fake_swallow.h"
#include "scoring/component4.h"
#include "scoring/measure.h"

namespace swallowclip::scoring {
namespace {
using namespace testing;

constexpr double kFrame_s = 1.0 / 30;

Metrics measured(const FakeSwallow& f, int intended) {
  auto h = makeHistory(f);
  h.meta.component = 4, h.meta.score = intended;
  auto m = measure(h, testRules());
  EXPECT_TRUE(m.has_value());
  return std::move(*m);
}

double value(const Metrics& m, const char* name) {
  const Quantity* q = m.quantity(name);
  EXPECT_TRUE(q && q->value) << name << (q ? ": " + q->reason : " is missing");
  return q && q->value ? *q->value : -1;
}

void expectScore(const Metrics& m, int score) {
  EXPECT_EQ(m.scores.at(4), score) << formatTable(m);
  EXPECT_EQ(m.labelConfirmed, true) << formatTable(m);
}

class WithAndWithoutBolus : public ::testing::TestWithParam<bool> {
 protected:
  FakeSwallow shaped(FakeSwallow f) const {
    if (!GetParam()) f.particles = 0;
    return f;
  }
};
INSTANTIATE_TEST_SUITE_P(Bolus, WithAndWithoutBolus, ::testing::Bool());

TEST_P(WithAndWithoutBolus, BriskSweepIsScoreZero) {
  const Metrics m = measured(shaped(sweepSwallow(0.92, 0.140, 3.2)), 0);
  expectScore(m, 0);
  EXPECT_NEAR(value(m, "initial_delay"), 0.92, kFrame_s);
  EXPECT_NEAR(value(m, "front_speed"), 140, 3);
  EXPECT_EQ(value(m, "reversals"), 0);
  EXPECT_NEAR(value(m, "contact_front_travel"), 100, 2);
}

TEST(Component4, OnsetToRamusAndShareArePlainlyMeasured) {
  const Metrics m = measured(sweepSwallow(0.92, 0.140, 3.2), 0);
  // 2 % of 200 particles are the 4 foremost: the 4th starts at s0 = 20 + 25*196/199 mm and passes
  // 72 mm when the front is at 72 - 2 - 0.6*25*196/199.
  const double front_m = 0.070 - 0.6 * 0.025 * 196 / 199;
  EXPECT_NEAR(value(m, "onset_to_ramus"), (front_m - 0.010) / 0.140, 1.5 * kFrame_s);
  EXPECT_EQ(value(m, "past_ramus"), 1);
}

TEST_P(WithAndWithoutBolus, LateSweepIsScoreOne) {
  const Metrics m = measured(shaped(sweepSwallow(3.9, 0.140, 6.5)), 1);
  expectScore(m, 1);
  EXPECT_NEAR(value(m, "initial_delay"), 3.9, kFrame_s);
}

TEST_P(WithAndWithoutBolus, CreepIsScoreTwoEvenWhenLate) {
  const Metrics m = measured(shaped(sweepSwallow(0.92, 0.035, 5.0)), 2);
  expectScore(m, 2);
  EXPECT_NEAR(value(m, "front_speed"), 35, 1);
  EXPECT_EQ(value(m, "reversals"), 0);
  expectScore(measured(shaped(sweepSwallow(3.0, 0.035, 7.0)), 2), 2);
}

TEST_P(WithAndWithoutBolus, ThreeRockingCyclesAreScoreThree) {
  const Metrics m = measured(shaped(rockingSwallow(0.92, 3, 0.024, 0.012, 0.112, 6)), 3);
  expectScore(m, 3);
  EXPECT_EQ(value(m, "reversals"), 6);
  EXPECT_NEAR(value(m, "initial_delay"), 0.92, 0.1);
  EXPECT_NEAR(value(m, "front_speed"), 112, 4);  // the last advance only
}

TEST(Component4, ThreeReversalsAreThree) {
  // Two cycles that begin backwards; the last way forward goes over into the sweep.
  const Metrics m = measured(rockingSwallow(0.92, 2, 0, -0.012, 0.112, 6), 3);
  EXPECT_EQ(value(m, "reversals"), 3);
  EXPECT_EQ(m.scores.at(4), 3) << formatTable(m);
}

TEST_P(WithAndWithoutBolus, TinyMotionIsScoreFour) {
  const Metrics m = measured(shaped(rockingSwallow(0.92, 3, 0.003, 0.001, 0.0, 6.6)), 4);
  expectScore(m, 4);
  EXPECT_LT(value(m, "contact_front_travel"), 4);
  EXPECT_FALSE(m.event("tongue_onset")->time_s.has_value());
  EXPECT_FALSE(m.quantity("front_speed")->value.has_value());
}

TEST_P(WithAndWithoutBolus, FourIsNotGivenBeforeSixSecondsHavePassed) {
  const Metrics m = measured(shaped(rockingSwallow(0.92, 3, 0.003, 0.001, 0.0, 5.0)), 4);
  EXPECT_FALSE(m.scores.at(4).has_value());
  EXPECT_FALSE(m.labelConfirmed.has_value());
  EXPECT_NE(m.reasons.at(4).find("6 s"), std::string::npos);
}

TEST(Component4, SixSecondsCountFromTheLastCue) {
  auto f = rockingSwallow(0.92, 3, 0.003, 0.001, 0.0, 6.6);
  f.cues_s = {0, 2};
  EXPECT_FALSE(measured(f, 4).scores.at(4).has_value());
}

TEST(Component4, OneAccommodatingPairIsDropped) {
  // Two runs of 5 mm within 0.4 s, then the sweep.
  std::vector<double> t, x;
  for (int i = 0; i <= 60; ++i) {
    t.push_back(i / 30.0);
    double v = 30;
    if (i <= 5)
      v += i;
    else if (i <= 10)
      v += 10 - i;
    else
      v += 2.0 * (i - 10);
    x.push_back(v);
  }
  const auto accommodating = [](double run, double time_s) {
    ScoringRules rules = testRules();
    rules.accommodationRun_m = run, rules.accommodationTime_s = time_s;
    return rules;
  };
  EXPECT_EQ(countReversals(t, x, 61, 4, accommodating(6, 0.4)), 0);
  EXPECT_EQ(countReversals(t, x, 61, 4, accommodating(4.5, 0.4)), 2);
  EXPECT_EQ(countReversals(t, x, 61, 4, accommodating(6, 0.3)), 2);
  EXPECT_EQ(countReversals(t, x, 8, 4, accommodating(4.5, 0.4)), 1);  // BPM between the turns
}

TEST(Component4, SlightPauseIsNotAReversal) {
  auto f = sweepSwallow(0.92, 0.140, 3.2);
  auto clock = [](double t) { return t < 1.1 ? t : std::max(1.1, t - 0.15); };
  const auto sweep = f;
  f.gap_m = [=](double s, double t) { return sweep.gap_m(s, clock(t)); };
  f.particle_m = [=](double s, double t) { return sweep.particle_m(s, clock(t)); };
  const Metrics m = measured(f, 0);
  EXPECT_EQ(m.scores.at(4), 0) << formatTable(m);
}

TEST(Component4, WrongLabelIsNotConfirmed) {
  const Metrics m = measured(sweepSwallow(0.92, 0.140, 3.2), 3);
  EXPECT_EQ(m.labelConfirmed, false);
  EXPECT_NE(m.labelReason.find("measured 0"), std::string::npos);
}

TEST(Component4, SpeedBetweenSlowAndBriskIsAmbiguous) {
  const Metrics m = measured(sweepSwallow(0.92, 0.070, 4), 0);
  EXPECT_EQ(m.scores.at(4), 0);
  EXPECT_TRUE(m.ambiguous.at(4));
  EXPECT_EQ(m.labelConfirmed, false);
}

struct Case {
  Component4Measures m;
  std::optional<int> score;
  bool ambiguous;
};

TEST(Component4, DecisionTable) {
  auto with = [](double travel_mm, double waited_s, int n, std::optional<double> v_mms,
                 std::optional<double> d_s) {
    Component4Measures m;
    m.travel_m = travel_mm * kMm, m.waited_s = waited_s, m.reversals = n, m.delay_s = d_s;
    if (v_mms) m.front_ms = *v_mms * kMm;
    return m;
  };
  const std::vector<Case> cases{
      {with(5, 6.6, 6, {}, {}), 4, false},  {with(9, 6.6, 0, {}, {}), 4, true},
      {with(11, 6.6, 5, {}, {}), 3, true},  {with(5, 3, 0, {}, {}), {}, false},
      {with(90, 3, 2, 30, 4.0), 3, false},  {with(90, 3, 1, 30, 4.0), 2, false},
      {with(90, 3, 1, 55, 4.0), 2, true},   {with(90, 3, 0, 65, 4.0), 1, true},
      {with(90, 3, 0, 79, 1.0), 0, true},   {with(90, 3, 0, 81, 1.0), 0, false},
      {with(90, 3, 0, 140, 2.1), 1, true},  {with(90, 3, 0, 140, 1.9), 0, true},
      {with(90, 3, 0, 140, 2.5), 1, false}, {with(90, 3, 0, 140, {}), {}, false},
      {with(90, 3, 0, {}, 1.0), {}, false}, {Component4Measures{}, {}, false},
  };
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const Decision d = decideComponent4(cases[k].m, testRules());
    EXPECT_EQ(d.score, cases[k].score) << "case " << k << ": " << d.reason;
    EXPECT_EQ(d.ambiguous, cases[k].ambiguous) << "case " << k << ": " << d.reason;
    EXPECT_FALSE(d.reason.empty());
  }
}

TEST(Component4, RearSealOfTheHoldIsNoFrontBeforeItHasOpened) {
  LumenProfile lumen;
  for (int k = 0; k < 6; ++k) lumen.stations.push_back({0.005 * (k + 1), k});
  constexpr double kShut = 0.0001, kOpen = 0.005;
  lumen.gap_m = {{kShut, kOpen, kOpen, kShut, kShut, kOpen},   // held: sealed before and behind
                 {kShut, kShut, kShut, kShut, kShut, kOpen},   // the wave meets the shut seal
                 {kShut, kShut, kShut, kOpen, kOpen, kOpen},   // it opens
                 {kShut, kShut, kShut, kShut, kShut, kOpen}};  // and is swept
  const auto s = contactFront_m(lumen, 0, testRules());
  EXPECT_LT(s[0], 0.010);
  EXPECT_NEAR(s[1], 0.020, 0.0051);
  EXPECT_NEAR(s[2], 0.015, 0.0011);
  EXPECT_NEAR(s[3], 0.025, 0.0011);
}

TEST(Component4, ContactFrontIsBetweenStations) {
  LumenProfile lumen;
  lumen.stations = {{0.005, 0}, {0.010, 1}, {0.015, 2}, {0.020, 3}};
  lumen.gap_m = {{0.0001, 0.0005, 0.0015, 0.0001},   // the contact at 20 mm is not continuous
                 {0.0050, 0.0050, 0.0050, 0.0001},   // nothing at the ridge
                 {0.0050, 0.0005, 0.0005, 0.0001}};  // starts behind the first station
  const auto s = contactFront_m(lumen, 2, testRules());
  EXPECT_NEAR(s[0], 0.0125, 1e-9);
  EXPECT_NEAR(s[1], 0.005, 1e-9);
  EXPECT_NEAR(s[2], 0.020, 1e-9);
}
}  // namespace
}  // namespace swallowclip::scoring
