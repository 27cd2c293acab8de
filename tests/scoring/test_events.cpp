// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "fake_swallow.h"
#include "scoring/clearance.h"
#include "scoring/conservation.h"
#include "scoring/events.h"
#include "scoring/measure.h"

namespace swallowclip::scoring {
namespace {
using namespace testing;

constexpr double kFrame_s = 1.0 / 30;

/// UES 8.6 mm from 1.4 to 1.6 s, shut from above by 1.9 s; pharynx narrowest at 1.75 s.
double fullGap_m(double s, double t) {
  if (s > 0.1499) {
    const double shut_s = 1.6 + 0.3 * (s - 0.150) / 0.030;
    return 0.1 * kMm + 8.5 * kMm * ramp(t, 1.3, 1.4) * (1 - ramp(t, shut_s - 0.05, shut_s));
  }
  if (s > 0.0849) return 10 * kMm * (1 - 0.95 * ramp(t, 1.2, 1.75) * (1 - ramp(t, 1.85, 2.2)));
  return sweptGap_m(s, sweep_m(t, 0.92, 0.140));
}

void addBody(frame::History& h) {
  frame::StructureTrack hyoid;
  hyoid.name = "hyoid";
  hyoid.rest = {Vec3f(0.01f, 0, 0), Vec3f(-0.01f, 0, 0)};
  frame::LandmarkTrack left{"arytenoid_apex_L", {}}, right{"arytenoid_apex_R", {}},
      petiole{"epiglottis_petiole", {}};
  for (double t : h.time_s) {
    Pose pose;
    // 9 mm/s pre-rise from 0.8 s, 60 mm/s burst from 1.2 to 1.45 s, home by 2.5 s.
    pose.t.z() = 0.009 * std::clamp(t - 0.8, 0.0, 0.4) + 0.060 * std::clamp(t - 1.2, 0.0, 0.25);
    pose.t.z() *= 1 - ramp(t, 1.9, 2.5);
    hyoid.poses.push_back(pose);
    const float gap =
        static_cast<float>(12 * kMm * (1 - ramp(t, 1.2, 1.35) * (1 - ramp(t, 1.9, 2.1))));
    left.positions.push_back(Vec3f(0.003f, gap, 0));
    right.positions.push_back(Vec3f(-0.003f, gap, 0));
    petiole.positions.push_back(Vec3f::Zero());
  }
  h.structures.push_back(hyoid);
  h.landmarks = {left, right, petiole};
}

frame::History fullHistory() {
  FakeSwallow f = sweepSwallow(0.92, 0.140, 3.2);
  f.gap_m = fullGap_m;
  auto h = makeHistory(f);
  addBody(h);
  h.plannedEvents = {{"tip_press", 0.6}};
  return h;
}

double at(const Metrics& m, const char* name) {
  const MeasuredEvent* e = m.event(name);
  EXPECT_TRUE(e && e->time_s) << name << (e ? ": " + e->reason : " is missing");
  return e && e->time_s ? *e->time_s : -1;
}

TEST(Events, WholeSwallowIsTimedWithinAFrame) {
  const Metrics m = measure(fullHistory(), testRules()).value();
  EXPECT_NEAR(at(m, "tongue_onset"), 0.92, kFrame_s);
  EXPECT_NEAR(at(m, "HYB"), 1.2, kFrame_s);
  EXPECT_NEAR(at(m, "LVC"), 1.35, kFrame_s);
  EXPECT_NEAR(at(m, "LVCoff"), 1.9, 1.5 * kFrame_s);
  EXPECT_NEAR(at(m, "UESO"), 1.3 + 0.1 * 1.4 / 8.5, kFrame_s);
  EXPECT_NEAR(at(m, "UESMax"), 1.4, 1.01 * kFrame_s);
  EXPECT_NEAR(at(m, "MPC"), 1.8, 0.06);
  EXPECT_NEAR(at(m, "UESC"), 1.9, kFrame_s);
  EXPECT_NEAR(at(m, "SwRest"), 2.5, 2 * kFrame_s);
  EXPECT_NEAR(m.quantity("ues_max_gap")->value.value(), 8.6, 0.01);
  EXPECT_NEAR(m.quantity("pcr")->value.value(), 0.05, 0.02);
  EXPECT_NEAR(m.quantity("oral_transit")->value.value(), at(m, "BPM") - 0.6, 1e-9);
  EXPECT_GT(m.quantity("pharyngeal_transit")->value.value(), 0.2);
  for (std::size_t k = 1; k < m.events.size(); ++k)
    EXPECT_LE(m.events[k - 1].time_s.value(), m.events[k].time_s.value());
}

TEST(Events, BpmIsTheFirstFrameOfTheHead) {
  const auto h = fullHistory();
  const MeasuredEvent bpm = measureBpm(h, testRules());
  const auto share = shareBeyond(h.bolus, 0.072);
  ASSERT_GT(bpm.frame, 0);
  EXPECT_GE(share[bpm.frame], 0.02);
  EXPECT_LT(share[bpm.frame - 1], 0.02);
}

TEST(Events, HyoidLandmarkGoesBeforeTheStructure) {
  auto h = fullHistory();
  frame::LandmarkTrack body{"hyoid_body_centre", {}};
  for (double t : h.time_s)
    body.positions.push_back(Vec3f(0, 0, t < 1.5 ? 0.f : static_cast<float>(0.1 * (t - 1.5))));
  h.landmarks.push_back(body);
  const Metrics m = measure(h, testRules()).value();
  EXPECT_NEAR(at(m, "HYB"), 1.5, kFrame_s);
}

TEST(Events, WhatCannotBeJudgedSaysWhy) {
  FakeSwallow f = sweepSwallow(0.92, 0.140, 3.2);
  f.particles = 0;
  const Metrics m = measure(makeHistory(f), testRules()).value();
  for (const char* name : {"BPM", "HYB", "LVC", "LVCoff", "SwRest", "UESC"}) {
    ASSERT_TRUE(m.event(name)) << name;
    EXPECT_FALSE(m.event(name)->time_s.has_value()) << name;
    EXPECT_FALSE(m.event(name)->reason.empty()) << name;
  }
  EXPECT_FALSE(m.conservation.has_value());
  for (const auto& q : m.quantities) {
    EXPECT_EQ(q.value.has_value(), q.reason.empty()) << q.name << ": " << q.reason;
    EXPECT_FALSE(q.rule.empty()) << q.name;
  }
  for (int c = 1; c <= kComponents; ++c) EXPECT_FALSE(m.reasons.at(c).empty()) << c;
}

TEST(Events, VestibuleThatClosesAfter180Milliseconds) {
  for (const double fps : {30.0, 60.0, 120.0}) {
    FakeSwallow f = sweepSwallow(0.92, 0.140, 3.2);
    f.gap_m = fullGap_m, f.fps = fps;
    auto h = makeHistory(f);
    addBody(h);
    for (auto& l : h.landmarks)  // sealed below 3 % of 12 mm, 0.18 s after the burst at 1.2 s
      for (std::size_t k = 0; l.name != "epiglottis_petiole" && k < h.time_s.size(); ++k)
        l.positions[k].y() =
            static_cast<float>(12 * kMm * (1 - ramp(h.time_s[k], 1.2, 1.2 + 0.18 / 0.97)) +
                               12 * kMm * ramp(h.time_s[k], 1.9, 2.1));
    const Metrics m = measure(h, testRules()).value();
    EXPECT_NEAR(m.quantity("time_to_lvc")->value.value(), 0.18, 1.01 / fps) << fps << " frames/s";
    EXPECT_NEAR(at(m, "LVC"), 1.38, 1.01 / fps);
  }
}

TEST(Events, ClosureOfASeries) {
  const std::vector<double> gap{12e-3, 6e-3, 0.5e-3, 0.2e-3, 0.1e-3, 0.4e-3, 6e-3};
  const Closure c = measureClosure(gap, 0, testRules());
  // 3 % of 12 mm is 0.36 mm.
  EXPECT_EQ(c.closed, 3);
  EXPECT_EQ(c.reopened, 5);
  EXPECT_NEAR(c.narrowest, 0.1 / 12, 1e-12);
  EXPECT_FALSE(measureClosure(std::vector<double>{5e-3, 4e-3}, 0, testRules()).closed.has_value());
}

TEST(Conservation, CountsEveryParticleOnce) {
  auto h = fullHistory();
  const int last = h.frames() - 1;
  auto put = [&](int k, frame::Region region, double s_m, frame::ParticleState state) {
    h.bolus.region[last][k] = region;
    h.bolus.s_m[last][k] = static_cast<float>(s_m);
    h.bolus.state[last][k] = state;
  };
  using frame::ParticleState, frame::Region;
  put(0, Region::oral, 0.03, ParticleState::film);
  put(1, Region::oropharynx, 0.10, ParticleState::fluid);
  put(2, Region::hypopharynx, 0.14, ParticleState::fluid);
  put(3, Region::larynx, 0.13, ParticleState::fluid);
  put(4, Region::nasopharynx, 0.06, ParticleState::fluid);
  put(5, Region::esophagus, 0.16, ParticleState::film);
  h.ledger[last] = {.start = 200, .fluid = 4, .film = 2, .swallowed = 194, .escaped = 0};
  const Conservation c = countParticles(h).value();
  EXPECT_TRUE(c.balanced());
  EXPECT_EQ(c.leftInOral, 1);
  EXPECT_EQ(c.leftInPharynx, 2);
  EXPECT_EQ(c.inAirway, 1);
  EXPECT_EQ(c.inNasopharynx, 1);
  EXPECT_EQ(c.inEsophagus, 1);
  EXPECT_EQ(c.swallowed, 194);
  EXPECT_DOUBLE_EQ(c.swallowedFraction, 0.97);
  EXPECT_DOUBLE_EQ(c.filmFraction, 0.01);
  EXPECT_EQ(c.volumeError, 0);
  const Metrics m = measure(h, testRules()).value();
  EXPECT_DOUBLE_EQ(m.quantity("left_in_oral")->value.value(), 1 / 200.0);
  EXPECT_DOUBLE_EQ(m.quantity("left_in_larynx")->value.value(), 1 / 200.0);
  h.ledger[last].fluid = 3;  // one is lost without being counted as escaped
  EXPECT_FALSE(countParticles(h)->balanced());
  EXPECT_DOUBLE_EQ(countParticles(h)->volumeError, 199 / 200.0 - 1);
}

TEST(Clearance, HalfOfTheBolusPassesTheRamus) {
  const Metrics m = measure(fullHistory(), testRules()).value();
  // The middle particle passes 72 mm with the front at 72 - 2 - 7.5 mm.
  EXPECT_NEAR(m.quantity("t50_past_ramus")->value.value(), 0.92 + 0.0525 / 0.140, kFrame_s);
}

TEST(Measure, RefusesBrokenHistories) {
  EXPECT_FALSE(measure({}, testRules()).has_value());
  auto h = fullHistory();
  h.time_s[5] = h.time_s[4];
  EXPECT_FALSE(measure(h, testRules()).has_value());
  h = fullHistory();
  h.bolus.s_m[3].pop_back();
  EXPECT_FALSE(measure(h, testRules()).has_value());
  h = fullHistory();
  h.bolus.region.pop_back();
  EXPECT_FALSE(measure(h, testRules()).has_value());
  h = fullHistory();
  h.structures[0].poses.pop_back();
  const auto r = measure(h, testRules());
  ASSERT_FALSE(r.has_value());
  EXPECT_NE(r.error().problem.find("hyoid"), std::string::npos);
}

TEST(Measure, TableNamesEverything) {
  auto h = fullHistory();
  h.meta.component = 4, h.meta.score = 0;
  const Metrics m = measure(h, testRules()).value();
  const std::string table = formatTable(m);
  for (const auto& q : m.quantities) EXPECT_NE(table.find(q.name), std::string::npos) << q.name;
  for (const auto& e : m.events) EXPECT_NE(table.find(e.name), std::string::npos) << e.name;
  EXPECT_NE(table.find("Label: confirmed"), std::string::npos) << table;
  EXPECT_EQ(table, formatTable(measure(h, testRules()).value()));
}
}  // namespace
}  // namespace swallowclip::scoring
