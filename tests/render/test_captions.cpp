// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "render/captions.h"

namespace swallowclip::render {
namespace {

int changed(const Image& a, const Image& b, int y0, int y1) {
  int n = 0;
  for (int y = y0; y < y1; ++y)
    for (int x = 0; x < a.width * 4; ++x) n += a.row(y)[x] != b.row(y)[x];
  return n;
}

CaptionText words() {
  CaptionText t;
  t.title = "MBSImP component 4, score 0: brisk tongue motion";
  t.subtitle = "5 mL, honey";
  t.viewLabel = "Oblique tongue view";
  t.events = {{"Oral transit", 0.2}, {"UES opening", 0.9}};
  t.time_s = 0.5;
  t.duration_s = 2;
  return t;
}

TEST(Captions, LeaveTheMiddleOfThePictureAlone) {
  const Image plain(640, 360);
  Image image = plain;
  ASSERT_TRUE(drawCaptions(image, {}, words()).has_value());
  EXPECT_GT(changed(image, plain, 0, 60), 500);
  EXPECT_GT(changed(image, plain, 300, 360), 500);
  EXPECT_EQ(changed(image, plain, 90, 270), 0);
}

TEST(Captions, BarMovesWithTime) {
  Image early(640, 360), late(640, 360);
  CaptionText t = words();
  ASSERT_TRUE(drawCaptions(early, {}, t).has_value());
  t.time_s = 1.5;
  ASSERT_TRUE(drawCaptions(late, {}, t).has_value());
  EXPECT_GT(changed(early, late, 330, 360), 100);
}

TEST(Captions, OffAndTinyPicturesAreFine) {
  CaptionDef off;
  off.on = false;
  const Image plain(64, 64);
  Image image = plain;
  ASSERT_TRUE(drawCaptions(image, off, words()).has_value());
  EXPECT_EQ(image.rgba, plain.rgba);
  Image tiny(16, 16);
  EXPECT_TRUE(drawCaptions(tiny, {}, words()).has_value());
}

TEST(Captions, ALongTitleIsSetSmallerAndNotCut) {
  CaptionDef def;
  def.size_px = 15;
  CaptionText one = words(), other = one;
  one.title = "MBSImP component 10, score 0: the laryngeal vestibule closes whole a";
  other.title = one.title;
  other.title.back() = 'b';  // its last letter is seen
  Image a(854, 480), b(854, 480);
  ASSERT_TRUE(drawCaptions(a, def, one).has_value());
  ASSERT_TRUE(drawCaptions(b, def, other).has_value());
  EXPECT_GT(changed(a, b, 0, 60), 5);
}

TEST(Captions, AcceptsAnyText) {
  Image image(320, 180);
  CaptionText t = words();
  t.title = std::string("broken \xff utf-8 ") + std::string(4000, 'x');
  EXPECT_TRUE(drawCaptions(image, {}, t).has_value());
}
}  // namespace
}  // namespace swallowclip::render
