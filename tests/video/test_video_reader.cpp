// SPDX-License-Identifier: MIT
#include "core/file.h"
#include "video/video_fixtures.h"
#include "video/video_reader.h"

namespace swallowclip::video {
namespace {

/// Reads to the end; frames read, or -1 after an error (which must be complete).
int readAll(const std::filesystem::path& path) {
  auto reader = VideoReader::open(path);
  const auto checked = [&](const Error& e) {
    EXPECT_FALSE(e.place.empty() || e.problem.empty() || e.remedy.empty());
    return -1;
  };
  if (!reader) return checked(reader.error());
  for (int frames = 0;; ++frames) {
    auto next = (*reader)->next();
    if (!next) return checked(next.error());
    if (!*next) return frames;
  }
}

TEST(VideoReader, KnowsTheClip) {
  const Scratch folder;
  Mp4Def def;
  def.path = folder / "clip.mp4";
  def.width = 320;
  def.height = 180;
  ASSERT_TRUE(writeClip(def, 20));
  auto reader = VideoReader::open(def.path);
  ASSERT_TRUE(reader) << reader.error().text();
  EXPECT_EQ((*reader)->info().width, 320);
  EXPECT_EQ((*reader)->info().height, 180);
  EXPECT_DOUBLE_EQ((*reader)->info().fps, 30);
  EXPECT_NEAR((*reader)->info().duration_s, 20 / 30.0, 1e-3);
  EXPECT_EQ(readAll(def.path), 20);
}

TEST(VideoReader, BrokenFilesAreErrorsOrShort) {
  const Scratch folder;
  Mp4Def def;
  def.path = folder / "clip.mp4";
  def.width = 320;
  def.height = 180;
  ASSERT_TRUE(writeClip(def, 20));
  const std::string bytes = *readFile(def.path);
  for (std::size_t cut = 0; cut < bytes.size(); cut += bytes.size() / 40 + 1) {
    put(folder / "cut.mp4", std::string_view(bytes).substr(0, cut));
    EXPECT_LT(readAll(folder / "cut.mp4"), 20) << "cut at " << cut;
  }
  put(folder / "text.mp4", "not a video");
  EXPECT_EQ(readAll(folder / "text.mp4"), -1);
  put(folder / "empty.mp4", "");
  EXPECT_EQ(readAll(folder / "empty.mp4"), -1);
  EXPECT_EQ(readAll(folder / "absent.mp4"), -1);
  EXPECT_EQ(readAll(folder.path()), -1);
}
}  // namespace
}  // namespace swallowclip::video
