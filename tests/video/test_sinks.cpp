// SPDX-License-Identifier: MIT
#include "video/png.h"
#include "video/video_fixtures.h"

namespace swallowclip::video {
namespace {

TEST(PngSink, NumbersItsFilesAndPublishesAtTheEnd) {
  const Scratch folder;
  auto sink = makePngSink(folder / "frames", "view");
  ASSERT_TRUE(sink);
  for (int f = 0; f < 3; ++f) ASSERT_TRUE((*sink)->push(movingPicture(64, 48, f)));
  EXPECT_FALSE(std::filesystem::exists(folder / "frames/view_00000.png"));
  ASSERT_TRUE((*sink)->finish());
  sink->reset();
  for (int f = 0; f < 3; ++f) {
    const Result<Image> back = readPng(folder / fmt::format("frames/view_{:05}.png", f));
    ASSERT_TRUE(back);
    EXPECT_EQ(back->rgba, movingPicture(64, 48, f).rgba);
  }
}

TEST(PngSink, AbortLeavesNothing) {
  const Scratch folder;
  {
    auto sink = makePngSink(folder.path());
    ASSERT_TRUE(sink);
    ASSERT_TRUE((*sink)->push(movingPicture(64, 48, 0)));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  auto sink = makePngSink(folder.path());
  EXPECT_FALSE((*sink)->finish());  // no frames
}

TEST(PngSink, BadFolderIsAnError) {
  const Scratch folder;
  put(folder / "file", "x");
  const auto sink = makePngSink(folder / "file/in");
  ASSERT_FALSE(sink);
  EXPECT_FALSE(sink.error().remedy.empty());
}

TEST(HashSink, SeesPixelsSizesAndOrder) {
  const auto digest = [](const std::vector<Image>& images) {
    HashSink sink;
    for (const Image& image : images) EXPECT_TRUE(sink.push(image));
    EXPECT_TRUE(sink.finish());
    EXPECT_EQ(sink.frames().size(), images.size());
    return sink.digest();
  };
  const Image a = movingPicture(64, 48, 0), b = movingPicture(64, 48, 1);
  Image c = a;
  c.rgba[17] ^= 1;
  EXPECT_EQ(digest({a, b}), digest({a, b}));
  EXPECT_NE(digest({a, b}), digest({b, a}));
  EXPECT_NE(digest({a}), digest({c}));
  EXPECT_NE(digest({Image(8, 4)}), digest({Image(4, 8)}));
}

TEST(NullSink, Counts) {
  NullSink sink;
  EXPECT_TRUE(sink.push(Image(2, 2)));
  EXPECT_TRUE(sink.finish());
  EXPECT_EQ(sink.count(), 1);
}
}  // namespace
}  // namespace swallowclip::video
