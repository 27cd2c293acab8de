// SPDX-License-Identifier: MIT
#include "core/file.h"
#include "video/png.h"
#include "video/video_fixtures.h"

namespace swallowclip::video {
namespace {

TEST(Png, ReadsBackExactlyWithAndWithoutAlpha) {
  const Scratch folder;
  Image image = movingPicture(101, 37, 3);
  ASSERT_TRUE(writePng(image, folder / "a.png"));
  EXPECT_EQ(readPng(folder / "a.png")->rgba, image.rgba);
  for (std::size_t i = 3; i < image.rgba.size(); i += 4)
    image.rgba[i] = static_cast<std::uint8_t>(i);
  ASSERT_TRUE(writePng(image, folder / "b.png"));
  const Result<Image> back = readPng(folder / "b.png");
  EXPECT_EQ(back->width, 101);
  EXPECT_EQ(back->height, 37);
  EXPECT_EQ(back->rgba, image.rgba);
}

TEST(Png, SamePictureSameBytes) {
  EXPECT_EQ(*encodePng(movingPicture(64, 48, 2)), *encodePng(movingPicture(64, 48, 2)));
}

TEST(Png, ImpossiblePicturesAreErrors) {
  Image hollow(8, 8);
  hollow.rgba.resize(10);
  EXPECT_FALSE(encodePng(hollow));
  EXPECT_FALSE(encodePng(Image()));
  const Scratch folder;
  const Result<void> done = writePng(Image(4, 4), folder / "no/a.png");
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().place.find("no/a.png"), std::string::npos);
}

TEST(Png, BrokenFilesAreErrors) {
  const Scratch folder;
  const std::string bytes = *encodePng(movingPicture(64, 48, 2));
  for (std::size_t cut = 0; cut + 13 < bytes.size(); cut += 7) {  // 12 bytes of end mark
    put(folder / "cut.png", std::string_view(bytes).substr(0, cut));
    const Result<Image> image = readPng(folder / "cut.png");
    ASSERT_FALSE(image) << "cut at " << cut << " of " << bytes.size();
    EXPECT_FALSE(image.error().remedy.empty());
  }
  std::string huge = bytes;
  huge[18] = '\x7f';  // width
  put(folder / "huge.png", huge);
  EXPECT_FALSE(readPng(folder / "huge.png"));
}
}  // namespace
}  // namespace swallowclip::video
