// SPDX-License-Identifier: MIT
#include "library/clip_check.h"

#include "core/file.h"
#include "data.h"
#include "video/frame_sink.h"
#include "video/png.h"

namespace swallowclip::library {
namespace {
namespace fs = std::filesystem;

Image grey(int width, int height, std::uint8_t value) {
  Image image(width, height);
  for (std::size_t k = 0; k < image.rgba.size(); ++k)
    if (k % 4 != 3) image.rgba[k] = value;
  return image;
}

class ClipCheck : public testing::Test {
 protected:
  ClipCheck() {
    video::Mp4Def def;
    def.path = clip;
    def.width = 64;
    def.height = 48;
    auto sink = video::makeMp4Sink(def).value();
    for (int k = 0; k < 24; ++k) EXPECT_TRUE(sink->push(grey(64, 48, 10 * k)));
    EXPECT_TRUE(sink->finish());
    EXPECT_TRUE(video::writePng(grey(64, 48, 99), folder / "c.png"));
    EXPECT_TRUE(writeFile(folder / "c.vtt", "WEBVTT\n\n00:00.000 --> 00:00.800\ncue\n"));
  }
  swallowclip::test::Scratch folder;
  fs::path clip = folder / "c.mp4";
  SheetDef sheet{4, 3, 32};
};

TEST_F(ClipCheck, EveryFrameIsReadAndTheSheetShowsThemInOrder) {
  const auto facts = readBack(clip, 24, 30, sheet, folder.path());
  ASSERT_TRUE(facts) << facts.error().text();
  EXPECT_EQ(facts->frames, 24);
  EXPECT_EQ(facts->width, 64);
  const auto image = video::readPng(folder / "sheet.png");
  ASSERT_TRUE(image);
  EXPECT_EQ(image->width, 4 * 32);
  EXPECT_EQ(image->height, 3 * 24);
  for (int tile = 0; tile < 12; ++tile)  // the second frame of each pair; H.264 is lossy
    EXPECT_NEAR(image->row(tile / 4 * 24 + 12)[4 * (tile % 4 * 32 + 16)], 10 * (2 * tile + 1), 3)
        << tile;
  EXPECT_EQ(video::readPng(folder / "thumb.png")->width, 64);
}

TEST_F(ClipCheck, WhatIsNotAsItMustBeIsTold) {
  const auto problem = [&](int frames, double fps) {
    const auto facts = readBack(clip, frames, fps, sheet, folder.path());
    return facts ? "" : facts.error().text();
  };
  EXPECT_NE(problem(25, 30).find("24 frames, 25 expected"), std::string::npos);
  EXPECT_NE(problem(24, 60).find("frame 1 comes at"), std::string::npos);
  ASSERT_TRUE(video::writePng(grey(32, 48, 9), folder / "c.png"));
  EXPECT_NE(problem(24, 30).find("32 x 48"), std::string::npos);
  ASSERT_TRUE(video::writePng(grey(64, 48, 9), folder / "c.png"));
  ASSERT_TRUE(writeFile(folder / "c.vtt", "no chapters"));
  EXPECT_NE(problem(24, 30).find("no chapter track"), std::string::npos);
  fs::resize_file(clip, fs::file_size(clip) - 200);
  EXPECT_NE(problem(24, 30), "");
  fs::remove(clip);
  EXPECT_NE(problem(24, 30).find("no such file"), std::string::npos);
}

TEST(VisibleDifference, IsNoneForEqualAndSmallForNoiseAndLargeForOthers) {
  Image a(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      for (int c = 0; c < 3; ++c)
        a.row(y)[4 * x + c] = static_cast<std::uint8_t>((x * 5 + y * 3) % 200);
  EXPECT_DOUBLE_EQ(visibleDifference(a, a), 0);
  Image noisy = a, turned = a;
  for (std::size_t k = 0; k < noisy.rgba.size(); ++k)
    if (k % 4 != 3) noisy.rgba[k] = static_cast<std::uint8_t>(noisy.rgba[k] + k % 2);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      for (int c = 0; c < 3; ++c) turned.row(y)[4 * x + c] = a.row(x)[4 * (63 - y) + c];
  EXPECT_LT(visibleDifference(a, noisy), 0.01);
  EXPECT_GT(visibleDifference(a, turned), 0.5);
  EXPECT_DOUBLE_EQ(visibleDifference(a, grey(32, 64, 0)), 1);
}

TEST(Shrink, KeepsTheMean) {
  Image a(64, 48);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) a.row(y)[4 * x] = static_cast<std::uint8_t>(4 * x);
  const Image b = shrink(a, 16);
  EXPECT_EQ(b.height, 12);
  EXPECT_EQ(b.row(0)[0], (0 + 4 + 8 + 12) / 4);
  EXPECT_EQ(shrink(a, 500).width, 64);
}
}  // namespace
}  // namespace swallowclip::library
