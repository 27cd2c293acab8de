// SPDX-License-Identifier: MIT
// The time warp: through every event, monotone, C1, with an inverse; what it can't do is refused.
#include "overlay/retime.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "overlay/resimulate.h"

namespace swallowclip::overlay {
namespace {
constexpr double kFrame_s = 1.0 / 30;

/// Increasing events with steps of 0.02 to 0.5 s in both clocks.
std::vector<EventPair> randomPairs(std::mt19937& random) {
  std::uniform_real_distribution<double> step(0.02, 0.5);
  std::vector<EventPair> pairs;
  double study_s = step(random), model_s = step(random);
  const int n = 1 + static_cast<int>(random() % 9);
  for (int i = 0; i < n; ++i) {
    pairs.push_back({std::to_string(i), study_s, model_s});
    study_s += step(random);
    model_s += step(random);
  }
  return pairs;
}
}  // namespace

TEST(Retime, EveryEventWithinHalfAFrameMonotoneAndSmooth) {
  std::mt19937 random(4);
  for (int round = 0; round < 200; ++round) {
    const std::vector<EventPair> pairs = randomPairs(random);
    const auto warp = TimeWarp::make(pairs, kFrame_s);
    ASSERT_TRUE(warp);
    for (const EventPair& p : pairs) {
      EXPECT_NEAR(warp->model_s(p.study_s), p.model_s, 1e-9);
      EXPECT_NEAR(warp->study_s(p.model_s), p.study_s, 1e-6);
    }
    const double h = 1e-4;
    double before = warp->model_s(-1 - h), slope = 1;
    for (double t = -1; t < 6; t += h) {
      const double now = warp->model_s(t);
      EXPECT_GE(now, before - 1e-12);
      const double next = (now - before) / h;
      // C1: the slope changes by no more than the steepest cubic's curvature allows
      EXPECT_LT(std::abs(next - slope), 0.6) << t;
      slope = next;
      before = now;
    }
  }
}

TEST(Retime, UnitSpeedOutside) {
  const auto warp = TimeWarp::make({{"BPM", 2, 1.2}, {"UESC", 3, 1.9}}, kFrame_s);
  ASSERT_TRUE(warp);
  EXPECT_NEAR(warp->model_s(1) - warp->model_s(0.5), 0.5, 1e-9);
  EXPECT_NEAR(warp->model_s(5) - warp->model_s(4), 1, 1e-9);
  EXPECT_NEAR(TimeWarp::shift(0.7).model_s(2), 1.3, 1e-9);
}

TEST(Retime, OneFrameForTwoEvents) {
  // 20 ms apart in the model: both stay within half a frame
  const auto close = TimeWarp::make({{"BPM", 1, 1.20}, {"HYB", 1, 1.22}}, kFrame_s);
  ASSERT_TRUE(close);
  EXPECT_NEAR(close->model_s(1), 1.21, 1e-9);
  const auto far = TimeWarp::make({{"BPM", 1, 1.2}, {"LVC", 1, 1.4}}, kFrame_s);
  ASSERT_FALSE(far);
  EXPECT_NE(far.error().text().find("BPM and LVC share a frame"), std::string::npos);
  const auto crossed = TimeWarp::make({{"BPM", 1, 1.4}, {"HYB", 1.2, 1.2}}, kFrame_s);
  ASSERT_FALSE(crossed);
  EXPECT_NE(crossed.error().text().find("--resimulate"), std::string::npos);
  EXPECT_FALSE(TimeWarp::make({}, kFrame_s));
}

TEST(Retime, StandingStillHasAnInverse) {
  const auto warp = TimeWarp::make({{"BPM", 1, 1}, {"HYB", 1.2, 1}, {"UESC", 2, 1.8}}, kFrame_s);
  ASSERT_TRUE(warp);
  EXPECT_NEAR(warp->model_s(1.1), 1, 1e-9);
  EXPECT_NEAR(warp->study_s(1), 1.1, 1e-3);  // leaving a standstill is flat
}

TEST(Retime, HistoryBetweenItsFrames) {
  frame::History h;
  h.meta.fps = 10;
  h.time_s = {0, 0.1, 0.2};
  frame::StructureTrack soft{"tongue", "muscle", false, {}, {Vec3f(0, 0, 0)}, {}, {}};
  for (const float x : {0.0f, 1.0f, 3.0f}) soft.positions.push_back({Vec3f(x, 0, 0)});
  frame::StructureTrack rigid{"hyoid", "bone", true, {}, {Vec3f(0, 0, 0)}, {}, {}};
  for (const double angle : {0.0, 0.4, 0.8})
    rigid.poses.push_back({Quat(Eigen::AngleAxisd(angle, Vec3::UnitX())), Vec3(0, 0, angle)});
  h.structures = {soft, rigid};
  h.landmarks = {{"ANS", {Vec3f(0, 0, 0), Vec3f(0, 1, 0), Vec3f(0, 2, 0)}}};
  const auto out = retimed(h, TimeWarp::shift(1), {0.5, 1.05, 1.1, 1.175, 9}, 20);
  ASSERT_EQ(out.frames(), 5);
  const float expected[] = {0, 0.5f, 1, 2.5f, 3};
  for (int k = 0; k < 5; ++k)
    EXPECT_NEAR(out.structures[0].positions[k][0].x(), expected[k], 1e-5) << k;
  EXPECT_NEAR(Eigen::AngleAxisd(out.structures[1].poses[1].q).angle(), 0.2, 1e-9);
  EXPECT_NEAR(out.structures[1].poses[3].t.z(), 0.7, 1e-6);
  EXPECT_NEAR(out.landmarks[0].positions[3].y(), 1.75, 1e-5);
}

TEST(Resimulate, TracksFollowTheWarpAndTheirOwnEvents) {
  kinematics::SwallowDef s;
  s.bpm_s = 1.2;
  s.front_m = Curve({-0.6, 0, 0.8}, {0, 0.05, 0.19});
  s.tracks["hyoid_superior"] = {0, 0.25, 0.55, 1.1, 0.014, 1, 0, 1};
  s.tracks["ues"] = {0.2, 0.35, 0.62, 0.76, 0.0086, 1, 0.1, 2};
  // everything 0.3 s later at first, slower by 1.5 until UESC
  const std::vector<EventPair> pairs{{"BPM", 1.5, 1.2}, {"UESC", 2.52, 1.88}};
  const auto moved = movedTo(s, pairs, kFrame_s);
  ASSERT_TRUE(moved);
  const auto& m = moved->swallow;
  EXPECT_NEAR(moved->cue_s, 0.3, 0.06);  // the speed eases before the first event
  EXPECT_NEAR(moved->cue_s + m.bpm_s, 1.5, 1e-6);
  const kinematics::Track& ues = m.tracks.at("ues");
  // UESC is the ues track's offset: 1.2 + 0.1 + 0.2 + 0.56 / 2 = 1.78 in the model
  const auto warp = TimeWarp::make(pairs, kFrame_s);
  EXPECT_NEAR(moved->cue_s + m.bpm_s + ues.offset_s, warp->study_s(1.78), 1e-6);
  EXPECT_EQ(ues.speed, 1);
  EXPECT_NEAR(m.front_m(0), 0.05, 1e-3);
  // HYB against the model's order moves the hyoid alone
  const auto late =
      movedTo(s, {{"BPM", 1.5, 1.2}, {"HYB", 1.7, 1.1}, {"UESC", 2.52, 1.88}}, kFrame_s);
  ASSERT_TRUE(late);
  EXPECT_NEAR(late->swallow.tracks.at("ues").offset_s, ues.offset_s, 1e-6);
  EXPECT_NEAR(
      late->swallow.tracks.at("hyoid_superior").onset_s - m.tracks.at("hyoid_superior").onset_s,
      1.7 - warp->study_s(1.1), 1e-6);
}

// HYB is BPM's own moment in the model: a warp through both would stand still between them and
// hasten what releases the bolus.
TEST(Resimulate, TheBolusAskedLaterComesLater) {
  kinematics::SwallowDef s;
  s.bpm_s = 1.2;
  s.front_m = Curve({-0.6, 0, 0.8}, {0, 0.05, 0.19});
  s.tracks["hyoid_superior"] = {0, 0.25, 0.55, 1.1, 0.014, 1, 0, 1};
  s.tracks["chute"] = {-0.42, -0.05, 0.3, 0.6, 0.012, 1, 0, 1};
  const std::vector<EventPair> pairs{{"tongue_onset", 0.9, 0.933},
                                     {"BPM", 1.2, 1.233},
                                     {"HYB", 1.2, 1.233},
                                     {"LVC", 1.267, 1.3},
                                     {"UESO", 1.467, 1.467}};
  const auto release_s = [&](const std::vector<EventPair>& asked) {
    const auto moved = movedTo(s, asked, kFrame_s);
    EXPECT_TRUE(moved);
    return moved->cue_s + moved->swallow.bpm_s + moved->swallow.tracks.at("chute").peak_s;
  };
  std::vector<EventPair> asked = pairs;
  double before_s = release_s(asked);
  for (int k = 1; k <= 6; ++k) {  // past HYB, past LVC
    asked[1].correction_s = k * kFrame_s / 2;
    const double now_s = release_s(asked);
    EXPECT_GT(now_s, before_s + 0.4 * kFrame_s / 2) << k;
    EXPECT_LT(now_s, before_s + 1.2 * kFrame_s / 2) << k;
    before_s = now_s;
  }
  // corrections of what moves itself leave the bolus alone, as does a rounding error
  asked = pairs;
  asked[2].correction_s = kFrame_s;
  asked[3].correction_s = -kFrame_s;
  EXPECT_NEAR(release_s(asked), release_s(pairs), 1e-9);
  const auto late = movedTo(s, asked, kFrame_s), plain = movedTo(s, pairs, kFrame_s);
  EXPECT_NEAR(late->swallow.tracks.at("hyoid_superior").onset_s -
                  plain->swallow.tracks.at("hyoid_superior").onset_s,
              kFrame_s, 1e-9);
  asked = pairs;
  asked[2].study_s += 1e-15;
  EXPECT_NEAR(release_s(asked), release_s(pairs), 1e-9);
}

TEST(Retime, RoundingDoesNotPartTwoEvents) {
  const auto warp =
      TimeWarp::make({{"tongue", 0.9, 0.9}, {"BPM", 1, 1}, {"HYB", 1 + 1e-15, 1}}, kFrame_s);
  ASSERT_TRUE(warp);
  EXPECT_NEAR(warp->model_s(0.98), 0.98, 1e-3);  // no standstill, nothing hastened
}

}  // namespace swallowclip::overlay
