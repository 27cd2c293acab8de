// SPDX-License-Identifier: MIT
#include <cmath>

#include "core/file.h"
#include "video/video_fixtures.h"
#include "video/vtt.h"

namespace swallowclip::video {
namespace {

TEST(Vtt, ChaptersRunFromEventToEvent) {
  EXPECT_EQ(*vttText({{"UES opens", 1.25}, {"Jaw opens", 0.5}}, 3.18, "Hold"),
            "WEBVTT\n"
            "\n1\n00:00:00.000 --> 00:00:00.500\nHold\n"
            "\n2\n00:00:00.500 --> 00:00:01.250\nJaw opens\n"
            "\n3\n00:00:01.250 --> 00:00:03.180\nUES opens\n");
}

TEST(Vtt, EventsAtOnceBeforeAndAfter) {
  EXPECT_EQ(*vttText({{"A", -2}, {"B", -1}, {"C", 1}, {"D", 1.0001}, {"late", 9}}, 2),
            "WEBVTT\n"
            "\n1\n00:00:00.000 --> 00:00:01.000\nB\n"
            "\n2\n00:00:01.000 --> 00:00:02.000\nC, D\n");
  EXPECT_EQ(*vttText({{"first", 0}}, 1), "WEBVTT\n\n1\n00:00:00.000 --> 00:00:01.000\nfirst\n");
  EXPECT_EQ(*vttText({}, 3661.5, "All"), "WEBVTT\n\n1\n00:00:00.000 --> 01:01:01.500\nAll\n");
}

TEST(Vtt, NamesCanNotBreakTheFile) {
  const std::string text = *vttText({{"<b>a & b</b>\n\n9\n00:00 --> 00:01", 0}}, 1);
  EXPECT_NE(text.find("&lt;b&gt;a &amp; b&lt;/b&gt;  9 00:00 --&gt; 00:01\n"), std::string::npos)
      << text;
}

TEST(Vtt, BadInputIsAnError) {
  EXPECT_FALSE(vttText({{"x", 0}}, 0));
  EXPECT_FALSE(vttText({{"x", 0}}, -1));
  EXPECT_FALSE(vttText({{"x", 0}}, std::nan("")));
  EXPECT_FALSE(vttText({{"x", std::nan("")}}, 1));
  EXPECT_FALSE(vttText({{"  ", 0}}, 1));
  const Scratch folder;
  EXPECT_FALSE(writeVtt({{"x", 0}}, 1, folder / "no/a.vtt"));
  ASSERT_TRUE(writeVtt({{"x", 0}}, 1, folder / "a.vtt"));
  EXPECT_EQ(readFile(folder / "a.vtt")->substr(0, 6), "WEBVTT");
}
}  // namespace
}  // namespace swallowclip::video
