// SPDX-License-Identifier: MIT
// The demonstration, whose truth is known, from its study to its clip. Minutes: ctest -L slow.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "run.h"
#include "video/png.h"
#include "video/video_reader.h"

namespace swallowclip::overlay {
namespace {
nlohmann::json sideOf(const test::Scratch& scratch) {
  auto text = readFile(scratch / "clip.json");
  EXPECT_TRUE(text);
  return nlohmann::json::parse(text.value_or("{}"));
}
/// With a bolus its events (BPM) are among those to be met.
class Demo : public testing::TestWithParam<const char*> {
 protected:
  Demo() {
    o.bolus = GetParam();
    o.overlay.demo = true;
    o.overlay.layout = "superimposed";
  }
  test::Scratch scratch;
  pipeline::RunOptions o = options(scratch);
  Said said;
};
INSTANTIATE_TEST_SUITE_P(Bolus, Demo, testing::Values("none", "thin"),
                         [](const auto& tested) { return tested.param; });
}  // namespace

// Acceptance, on the demonstration's truth: events within half a frame, 1 px RMS, 0.5 % scale, a
// head that turns by 5 degrees followed.
TEST_P(Demo, AgreesWithItsTruth) {
  const auto done = overlay(o, said);
  ASSERT_TRUE(done) << done.error().text();
  const nlohmann::json side = sideOf(scratch);
  EXPECT_LT(side["truth"]["rms_px"], 1.0);
  EXPECT_LT(side["truth"]["scale_percent"], 0.5);
  EXPECT_NEAR(side["truth"]["turned_deg"].get<double>(), 5, 0.7);
  ASSERT_GE(side["events"].size(), 5u);
  for (const auto& e : side["events"]) {
    ASSERT_FALSE(e["retimed_s"].is_null()) << e;
    EXPECT_NEAR(e["retimed_s"].get<double>(), e["study_s"].get<double>(), 0.5 / 30) << e;
  }
  EXPECT_EQ(side["study"]["warnings"].size(), 0u);
  auto reader = video::VideoReader::open(scratch / "clip.mp4");
  ASSERT_TRUE(reader);
  EXPECT_EQ((*reader)->info().frames, side["frames"].get<int>());
  auto vtt = readFile(scratch / "clip.vtt");
  ASSERT_TRUE(vtt);
  EXPECT_NE(vtt->find("HYB"), std::string::npos);
  EXPECT_TRUE(video::readPng(scratch / "clip.png"));
}

TEST_P(Demo, MovedMotionMeetsTheStudysEvents) {
  o.overlay.resimulate = true;
  const auto done = overlay(o, said);
  ASSERT_TRUE(done) << done.error().text();
  const nlohmann::json side = sideOf(scratch);
  EXPECT_EQ(side["events"].size(), o.bolus == "none" ? 9u : 10u);
  for (const auto& e : side["events"]) {  // measured anew on the moved motion
    ASSERT_FALSE(e["retimed_s"].is_null()) << e;
    EXPECT_NEAR(e["retimed_s"].get<double>(), e["study_s"].get<double>(), 0.5 / 30) << e;
  }
}
}  // namespace swallowclip::overlay
