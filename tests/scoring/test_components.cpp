// SPDX-License-Identifier: MIT
// Every component's quantity on swallows whose answer is known beforehand.
#include <gtest/gtest.h>

#include "fake_swallow.h"
#include "scoring/airway.h"
#include "scoring/bolus_head.h"
#include "scoring/component12.h"
#include "scoring/component13.h"
#include "scoring/component14.h"
#include "scoring/component15.h"
#include "scoring/component8.h"
#include "scoring/excursions.h"
#include "scoring/measure.h"
#include "scoring/residue_area.h"
#include "scoring/spine.h"

namespace swallowclip::scoring {
namespace {
using namespace testing;
constexpr double kFrame_s = 1.0 / 30;

/// A spine that leans back by 10 degrees, C2 to C4 40 mm.
void addSpine(frame::History& h) {
  const double lean = 10 * kPi / 180;
  const Vec3 low(0, 0.05, -0.08);
  addLandmark(h, "C4_anterior_inferior", [=](double) { return low; });
  addLandmark(h, "C2_anterior_inferior",
              [=](double) { return Vec3(low + 0.040 * Vec3(0, std::sin(lean), std::cos(lean))); });
}

TEST(Spine, DisplacementsAreAlongAndAcrossTheSpine) {
  auto h = makeHistory({.duration_s = 1, .particles = 0});
  addSpine(h);
  const double lean = 10 * kPi / 180;
  const Vec3 up(0, std::sin(lean), std::cos(lean)), forward(0, -std::cos(lean), std::sin(lean));
  addLandmark(h, "hyoid_body_centre",
              [&](double t) { return Vec3(t * (0.016 * up + 0.012 * forward)); });
  const Excursions e = measureExcursions(h);
  const auto at = [&](const char* name) {
    for (const Quantity& q : e.quantities)
      if (q.name == name) return q.value.value_or(std::nan(""));
    return std::nan("");
  };
  EXPECT_NEAR(at("hyoid_superior"), 16, 1e-4);
  EXPECT_NEAR(at("hyoid_anterior"), 12, 1e-4);
  EXPECT_NEAR(at("hyoid_superior_c2c4"), 40, 1e-3);
  EXPECT_NEAR(at("hyoid_anterior_c2c4"), 30, 1e-3);
  EXPECT_TRUE(std::isnan(at("larynx_anterior")));
}

TEST(Spine, EpiglottisTurnsFromUprightOverLevelToInverted) {
  auto h = makeHistory({.duration_s = 1, .particles = 0});
  addLandmark(h, "epiglottis_petiole", [](double) { return Vec3(0, 0.01, -0.08); });
  addLandmark(h, "epiglottis_tip_cartilage", [](double t) {
    const double turn = (25 + 110 * t) * kPi / 180;
    return Vec3(0, 0.01 + 0.03 * std::sin(turn), -0.08 + 0.03 * std::cos(turn));
  });
  const auto angle = epiglottisAngle_rad(h);
  EXPECT_NEAR(angle.front() * 180 / kPi, 25, 1e-3);
  EXPECT_NEAR(angle.back() * 180 / kPi, 135, 1e-3);
  EXPECT_EQ(measureComponent10(h, testRules()).decision.score, 0);
  EXPECT_EQ(measureComponent10(h, testRules()).frame, 30);
}

TEST(Component8, JudgedWhereTheEpiglottisIsLevel) {
  FakeSwallow f{.duration_s = 2, .particles = 0};
  auto h = makeHistory(f);
  const double rise_m = 0.5 * testRules().normalRiseHorizontal_m;
  addLandmark(h, "thyroid_notch", [=](double t) { return Vec3(0, 0, rise_m * ramp(t, 0, 1)); });
  addLandmark(h, "epiglottis_petiole", [](double) { return Vec3::Zero(); });
  addLandmark(h, "epiglottis_tip_cartilage", [](double t) {
    const double turn = (20 + 100 * ramp(t, 0, 2)) * kPi / 180;  // level at 1.4 s
    return Vec3(0, 0.03 * std::sin(turn), 0.03 * std::cos(turn));
  });
  const ComponentReport r = measureComponent8(h, {}, {}, testRules());
  // Level within the 5 degrees that count as level: 1.3 s.
  EXPECT_NEAR(h.time_s[r.frame], 1.3, 1.5 * kFrame_s);
  EXPECT_NEAR(*r.quantities[0].value, 0.5, 1e-4);
}

TEST(Component8, DecisionTable) {
  const ScoringRules& rules = testRules();
  const auto score = [&](double rise, double gap) { return scoreComponent8({rise, gap}, rules); };
  EXPECT_EQ(score(1.0, 0.01), 0);
  EXPECT_EQ(score(1.0, 0.30), 1);
  EXPECT_EQ(score(0.7, 0.01), 1);
  EXPECT_EQ(score(0.7, 0.60), 2);
  EXPECT_EQ(score(0.3, 0.01), 2);
  EXPECT_EQ(score(0.3, 0.99), 2);  // 3 needs no rise, whatever the gap
  EXPECT_EQ(score(0.05, 0.99), 3);
}

TEST(Component15, GapAndTravelAreExact) {
  // Gap 10 mm to 3 mm, of which the wall gives 2 mm: the tongue comes back by 5 mm.
  const auto gap = [](double, double t) { return 0.010 - 0.007 * ramp(t, 0.5, 1.0); };
  const auto wall = [](double, double t) { return 0.002 * ramp(t, 0.5, 1.0); };
  const auto h = uprightPharynx(gap, wall);
  const ComponentReport r = measureComponent15(h, testRules());
  EXPECT_EQ(r.decision.score, 2) << r.decision.reason;
  EXPECT_NEAR(*r.quantities[0].value, 3.0, 1e-4);
  EXPECT_NEAR(*r.quantities[1].value, 0.3, 1e-5);
  EXPECT_NEAR(*r.quantities[2].value, 5.0 / 7.0, 1e-5);
  EXPECT_NEAR(h.time_s[r.frame], 1.0, 2 * kFrame_s);
  // 0.3 is twice the cut of 0.15 and 40 % below that of 0.50.
  EXPECT_NEAR(*r.decision.margin, 0.4, 1e-4);
  EXPECT_EQ(r.decision.cut, "gap_rule.narrow_ratio");
}

TEST(Component15, EveryScoreFromItsGap) {
  for (const auto& [least_mm, score] :
       std::vector<std::pair<double, int>>{{0.1, 0}, {0.9, 1}, {3, 2}, {7, 3}, {9.9, 4}}) {
    const auto h = uprightPharynx(
        [&](double, double t) { return 0.010 - (10 - least_mm) * kMm * ramp(t, 0.5, 1); },
        [](double, double) { return 0.0; });
    EXPECT_EQ(measureComponent15(h, testRules()).decision.score, score) << least_mm << " mm";
  }
}

TEST(Component12, CrestsOfAKnownWave) {
  // A 3 mm bulge, 30 mm long, runs down the wall at 150 mm/s.
  const auto wave = [](double s, double t) {
    const double d = (s - (0.080 + 0.150 * (t - 0.3))) / 0.015;
    return std::abs(d) < 1 ? 0.003 * std::pow(1 - d * d, 2) : 0.0;
  };
  const auto h = uprightPharynx([](double, double) { return 0.010; }, wave);
  const ComponentReport r = measureComponent12(h, testRules());
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(*r.quantities[k].value, 1.0, 0.08) << k;
  // 37 mm in 0.247 s; a tenth of a frame at either end.
  EXPECT_NEAR(*r.quantities[3].value, 150, 150 * 0.2 * kFrame_s / 0.247);
  EXPECT_EQ(r.decision.score, 0) << r.decision.reason;
}

TEST(Component12, TheWaveIsTimedAgainstTheVertebraeNotTheRisingTissue) {
  // The same wave in tissue, while the tissue rises at 30 mm/s: 120 mm/s for the vertebrae.
  const auto wave = [](double s, double t) {
    const double d = (s - (0.080 + 0.150 * (t - 0.3))) / 0.015;
    return std::abs(d) < 1 ? 0.003 * std::pow(1 - d * d, 2) : 0.0;
  };
  auto h = uprightPharynx([](double, double) { return 0.010; }, wave);
  for (int k = 0; k < h.frames(); ++k)
    for (auto& p : h.skin.positions[k]) p.z() += static_cast<float>(0.030 * h.time_s[k]);
  EXPECT_NEAR(*measureComponent12(h, testRules()).quantities[3].value, 120, 5);
}

TEST(Component13, WidthOfTheOpenLumenOnEachSide) {
  FakeSwallow f{.duration_s = 1, .particles = 0};
  auto h = makeHistory(f);
  // From 0.5 s on the left wall stands 25 % farther out, over all levels.
  for (int k = 15; k < h.frames(); ++k)
    for (auto& p : h.skin.positions[k])
      if (p.x() > 0) p.x() *= 1.25f;
  const std::vector<MeasuredEvent> events{
      {"UESO", 0.4, 12, "", ""}, {"MPC", 0.7, 21, "", ""}, {"UESC", 0.9, 27, "", ""}};
  const ComponentReport r = measureComponent13(h, events, testRules());
  // Open by 0.5 mm up to 0.5 mm from the edges of 10 and 12.5 mm.
  EXPECT_NEAR(*r.quantities[0].value, 12.0 / 9.5 - 1, 1e-5);
  EXPECT_NEAR(*r.quantities[1].value, 0.0, 1e-5);
  EXPECT_EQ(r.decision.score, 2) << r.decision.reason;
}

TEST(Component13, PouchesAndBowingAreToldApartByTheirHeight) {
  std::vector<double> levels, rest, pouch, bowed;
  for (double s = 0.092; s < 0.1455; s += 0.0015) {
    levels.push_back(s), rest.push_back(0.014);
    pouch.push_back(0.014 + (std::abs(s - 0.118) < 0.004 ? 0.004 : 0.0));
    bowed.push_back(0.014 + (std::abs(s - 0.118) < 0.012 ? 0.004 : 0.0));
  }
  // 4 mm less their mean over 30 mm, of which 8 mm bulge.
  EXPECT_NEAR(pouchDepth_m(levels, pouch, rest, testRules()), 0.004 * (1 - 8.0 / 30), 0.0003);
  EXPECT_EQ(pouchDepth_m(levels, bowed, rest, testRules()), 0);
  EXPECT_NEAR(bulge(levels, bowed, rest, 0.015), 4.0 / 14, 1e-6);
  EXPECT_LT(bulge(levels, pouch, rest, 0.015), 0.65 * 4.0 / 14);
}

TEST(Component13, DecisionTable) {
  const auto score = [&](double left, double right, double k, double pouch, double shortening) {
    return scoreComponent13({left, right, k, pouch * kMm, shortening}, testRules());
  };
  EXPECT_EQ(score(0.01, 0.02, 0.1, 0, 1), 0);
  EXPECT_EQ(score(0.01, 0.02, 0.1, 4, 1), 1);
  EXPECT_EQ(score(0.01, 0.02, 0.4, 0, 1), 1);
  EXPECT_EQ(score(0.01, 0.02, 0.1, 0, 0.5), 1);
  EXPECT_EQ(score(0.01, 0.30, 0.4, 0, 0.8), 2);
  EXPECT_EQ(score(0.30, 0.01, 0.4, 0, 0.8), 2);
  EXPECT_EQ(score(0.30, 0.20, 0.9, 0, 0.5), 3);
  EXPECT_FALSE(score(0.09, -0.05, 0.1, 0, 1).has_value());
}

TEST(Component14, WorstOfThree) {
  const auto score = [&](double d, double t, std::optional<double> o) {
    return scoreComponent14({d, t, o}, testRules());
  };
  EXPECT_EQ(score(1, 1, 0.01), 0);
  EXPECT_EQ(score(0.6, 1, 0.01), 1);
  EXPECT_EQ(score(1, 0.6, 0.01), 1);
  EXPECT_EQ(score(1, 1, 0.2), 1);
  EXPECT_EQ(score(0.3, 1, 0.01), 2);
  EXPECT_EQ(score(1, 1, 0.6), 2);
  EXPECT_EQ(score(0.05, 0, 0.6), 2);
  EXPECT_EQ(score(0.05, 0, 0.99), 3);
}

TEST(Component14, TheNormalWidthGrowsWithTheVolume) {
  frame::History h = makeHistory(FakeSwallow{});
  std::vector<double> ues_m(h.frames(), 8.6e-3);
  const auto ratio = [&](double volume_m3) {
    h.bolus.particleVolume_m3 = volume_m3 / h.bolus.s_m.front().size();
    return *measureComponent14(h, ues_m, {}, testRules()).quantities[0].value;
  };
  EXPECT_NEAR(ratio(5e-6), 1, 1e-6);
  EXPECT_NEAR(ratio(20e-6), std::pow(4, -testRules().uesGrowth), 1e-6);
}

TEST(BolusHead, HeadTailAndInitiation) {
  // A plug of 200 particles over 25 mm that moves at 35 mm/s from 20 mm on.
  FakeSwallow f{.duration_s = 3.8};
  f.particle_m = [](double s0, double t) { return s0 + 0.035 * t; };
  const auto h = makeHistory(f);
  const auto head = bolusHead_m(h.bolus, testRules());
  const auto centre = bolusCentroid_m(h.bolus, testRules());
  for (int k = 0; k < h.frames(); ++k) {
    // The 4th of 200 particles: 0.025 * 196 / 199 from the rear.
    EXPECT_NEAR(head[k], 0.020 + 0.025 * 196 / 199 + 0.035 * h.time_s[k], 1e-6);
    EXPECT_NEAR(centre[k], 0.0325 + 0.035 * h.time_s[k], 1e-6);
  }
  for (const auto& [s_mm, score] :
       std::vector<std::pair<double, int>>{{70, 0}, {100, 1}, {115, 2}, {140, 3}})
    EXPECT_EQ(scoreComponent6(s_mm * kMm, testRules()), score) << s_mm;
  EXPECT_EQ(scoreComponent6({}, testRules()), 4);
}

TEST(BolusHead, HeldBolusThatSpills) {
  EXPECT_EQ(scoreComponent2({0.0, 0.0}, testRules()), 0);
  EXPECT_EQ(scoreComponent2({0.1, 0.0}, testRules()), 1);
  EXPECT_EQ(scoreComponent2({0.1, 0.2}, testRules()), 2);
  EXPECT_EQ(scoreComponent2({0.0, 0.7}, testRules()), 3);
}

TEST(Airway, ScaleByDepthAndClearance) {
  using enum AirwayDepth;
  EXPECT_EQ(penetrationAspiration(none, true, true), 1);
  EXPECT_EQ(penetrationAspiration(aboveFolds, true, true), 2);
  EXPECT_EQ(penetrationAspiration(aboveFolds, false, true), 3);
  EXPECT_EQ(penetrationAspiration(atFolds, true, true), 4);
  EXPECT_EQ(penetrationAspiration(atFolds, false, true), 5);
  EXPECT_EQ(penetrationAspiration(belowFolds, false, true), 6);
  EXPECT_EQ(penetrationAspiration(belowFolds, false, false), 8);
}

TEST(Airway, DepthIsReadAgainstTheMovingFolds) {
  auto h = makeHistory({.duration_s = 1});
  for (const char* name : {"arytenoid_vocal_process_L", "arytenoid_vocal_process_R"})
    addLandmark(h, name, [](double t) { return Vec3(0, 0.02, -0.095 + 0.02 * t); });
  const auto put = [&](int frame, int k, double above_m) {
    h.bolus.region[frame][k] = frame::Region::larynx;
    h.bolus.positions[frame][k] =
        Vec3(0, 0.02, -0.095 + 0.02 * h.time_s[frame] + above_m).cast<float>();
  };
  const auto pas = [&] { return *measureAirway(h, testRules())[0].value; };
  EXPECT_EQ(pas(), 1);
  put(10, 0, 0.010);
  EXPECT_EQ(pas(), 1) << "one particle is none";
  put(10, 1, 0.010);
  EXPECT_EQ(pas(), 2);
  put(12, 0, 0.0005), put(12, 1, 0.0009);
  EXPECT_EQ(pas(), 4);
  put(14, 0, -0.002), put(14, 1, -0.002);
  EXPECT_EQ(pas(), 6);
  put(30, 0, -0.02);
  EXPECT_EQ(pas(), 8);
  EXPECT_NEAR(*measureAirway(h, testRules())[1].value, 2 * 5.0 / 200, 1e-9);
}
}  // namespace
}  // namespace swallowclip::scoring
