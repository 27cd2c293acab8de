// SPDX-License-Identifier: MIT
#include <sys/resource.h>

#include <csignal>
#include <cstdlib>

#include "core/file.h"
#include "video/video_fixtures.h"
#include "video/video_reader.h"

namespace swallowclip::video {
namespace {

Mp4Def smallDef(const std::filesystem::path& path) {
  Mp4Def def;
  def.path = path;
  def.width = 320;
  def.height = 180;
  return def;
}

TEST(Mp4Sink, IsAnH264WebClip) {
  const Scratch folder;
  const auto path = folder / "clip.mp4";
  const Result<void> done = writeClip(smallDef(path), 30);
  ASSERT_TRUE(done) << done.error().text();
  const std::string stream = ffprobe(
      "stream=codec_name,profile,pix_fmt,width,height,color_range,color_space,color_transfer,"
      "color_primaries,chroma_location,r_frame_rate,avg_frame_rate,nb_frames,duration,start_time",
      path);
  for (const char* wanted :
       {"codec_name=h264", "profile=High|", "pix_fmt=yuv420p", "width=320", "height=180",
        "color_range=tv", "color_space=bt709", "color_transfer=bt709", "color_primaries=bt709",
        "chroma_location=left", "r_frame_rate=30/1", "avg_frame_rate=30/1", "nb_frames=30",
        "duration=1.000000", "start_time=0.000000"})
    EXPECT_NE(stream.find(wanted), std::string::npos) << wanted << " in " << stream;
  // The container's colour box too, so that players need not look into the stream.
  const std::string bytes = *readFile(path);
  const auto colour = bytes.find("colrnclx");
  ASSERT_NE(colour, std::string::npos);
  EXPECT_EQ(bytes.substr(colour + 8, 7), std::string("\0\1\0\1\0\1\0", 7));
  // Index in front of the data.
  EXPECT_LT(bytes.find("moov"), bytes.find("mdat"));
}

TEST(Mp4Sink, KeyframeEveryEightFramesAtConstantRate) {
  const Scratch folder;
  ASSERT_TRUE(writeClip(smallDef(folder / "clip.mp4"), 35));
  auto reader = VideoReader::open(folder / "clip.mp4");
  ASSERT_TRUE(reader) << reader.error().text();
  int frame = 0;
  for (;; ++frame) {
    auto next = (*reader)->next();
    ASSERT_TRUE(next) << next.error().text();
    if (!*next) break;
    EXPECT_EQ((*next)->keyframe, frame % 8 == 0) << "frame " << frame;
    EXPECT_NEAR((*next)->time_s, frame / 30.0, 1e-6);
  }
  EXPECT_EQ(frame, 35);
}

TEST(Mp4Sink, FractionalRate) {
  const Scratch folder;
  Mp4Def def = smallDef(folder / "clip.mp4");
  def.rateNumerator = 60000;
  def.rateDenominator = 1001;
  ASSERT_TRUE(writeClip(def, 12));
  EXPECT_NE(ffprobe("stream=r_frame_rate", def.path).find("60000/1001"), std::string::npos);
}

TEST(Mp4Sink, SameFramesSameBytes) {
  const Scratch folder;
  Mp4Def a = smallDef(folder / "a.mp4"), b = smallDef(folder / "b.mp4");
  b.queuedFrames = 1;  // the queue must not matter
  ASSERT_TRUE(writeClip(a, 40));
  ::sleep(1);
  ASSERT_TRUE(writeClip(b, 40));
  EXPECT_TRUE(*readFile(a.path) == *readFile(b.path));
}

TEST(Mp4Sink, ColoursComeBack) {
  const Scratch folder;
  const std::array<std::array<int, 3>, 9> patches = {{{255, 0, 0},
                                                      {0, 255, 0},
                                                      {0, 0, 255},
                                                      {255, 255, 255},
                                                      {0, 0, 0},
                                                      {128, 128, 128},
                                                      {200, 120, 110},
                                                      {30, 90, 160},
                                                      {240, 200, 60}}};
  Mp4Def def = smallDef(folder / "clip.mp4");
  auto sink = makeMp4Sink(def);
  ASSERT_TRUE(sink);
  for (const auto& rgb : patches)
    for (int k = 0; k < 8; ++k)
      ASSERT_TRUE((*sink)->push(plainPicture(def.width, def.height, rgb)));
  ASSERT_TRUE((*sink)->finish());
  auto reader = VideoReader::open(def.path);
  ASSERT_TRUE(reader);
  // 8-bit limited-range YCbCr rounds to about 2 levels of RGB, crf 19 adds as much; untagged or
  // unconverted video is 20 and more away (ff1700 instead of ff0000).
  constexpr int kTolerance = 5;
  int worst = 0;
  for (std::size_t f = 0; f < patches.size() * 8; ++f) {
    auto next = (*reader)->next();
    ASSERT_TRUE(next && *next);
    const std::uint8_t* p = (*next)->image.row(90) + 4 * 160;
    for (std::size_t k = 0; k < 3; ++k) worst = std::max(worst, std::abs(p[k] - patches[f / 8][k]));
  }
  RecordProperty("worst_level", worst);
  EXPECT_LE(worst, kTolerance);
}

TEST(Mp4Sink, AbortLeavesNothingAndKeepsTheOldClip) {
  const Scratch folder;
  const Mp4Def def = smallDef(folder / "clip.mp4");
  for (int pushed : {0, 3, 20}) {
    auto sink = makeMp4Sink(def);
    ASSERT_TRUE(sink);
    for (int f = 0; f < pushed; ++f) ASSERT_TRUE((*sink)->push(movingPicture(320, 180, f)));
    EXPECT_FALSE(std::filesystem::is_empty(folder.path()));
    sink->reset();
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << pushed;
  }
  put(def.path, "last night's clip");
  { ASSERT_TRUE((*makeMp4Sink(def))->push(movingPicture(320, 180, 0))); }
  EXPECT_EQ(*readFile(def.path), "last night's clip");
}

TEST(Mp4Sink, BadDefinitionsAreUsageErrors) {
  const Scratch folder;
  const auto refused = [&](auto&& change) {
    Mp4Def def = smallDef(folder / "clip.mp4");
    change(def);
    auto sink = makeMp4Sink(def);
    EXPECT_FALSE(sink);
    return sink ? std::string() : sink.error().text();
  };
  EXPECT_NE(refused([](Mp4Def& d) { d.width = 321; }).find("even"), std::string::npos);
  EXPECT_NE(refused([](Mp4Def& d) { d.height = 0; }).find("even"), std::string::npos);
  EXPECT_NE(refused([](Mp4Def& d) { d.rateNumerator = 25; }).find("30"), std::string::npos);
  EXPECT_NE(refused([](Mp4Def& d) { d.rateDenominator = 0; }).find("30"), std::string::npos);
  EXPECT_NE(refused([](Mp4Def& d) { d.crf = 70; }).find("crf"), std::string::npos);
  EXPECT_NE(refused([](Mp4Def& d) { d.preset = "fastr"; }).find("mean fast"), std::string::npos);
  EXPECT_NE(refused([&](Mp4Def& d) { d.path = folder / "no/clip.mp4"; }).find("No such file"),
            std::string::npos);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Mp4Sink, WrongFrameSizeNoFramesAndTwoFinishes) {
  const Scratch folder;
  auto sink = makeMp4Sink(smallDef(folder / "clip.mp4"));
  ASSERT_TRUE(sink);
  EXPECT_NE((*sink)->push(Image(320, 182)).error().problem.find("320 x 180 expected"),
            std::string::npos);
  EXPECT_FALSE((*sink)->finish());
  EXPECT_FALSE((*sink)->finish());
  EXPECT_FALSE((*sink)->push(Image(320, 180)));
  sink->reset();
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Mp4Sink, FullDiskIsAnError) {
  const Scratch folder;
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const rlimit tight{20000, old.rlim_max};  // bytes; a write beyond it fails
  std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &tight);
  Mp4Def def = smallDef(folder / "clip.mp4");
  def.crf = 1;
  def.preset = "ultrafast";
  const Result<void> done = writeClip(def, 60);
  setrlimit(RLIMIT_FSIZE, &old);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().kind, ErrorKind::failed);
  EXPECT_NE(done.error().text().find("Free space"), std::string::npos) << done.error().text();
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << done.error().text();
}

TEST(Mp4Sink, FolderThatVanishesIsAnError) {
  const Scratch folder;
  std::filesystem::create_directories(folder / "sub");
  auto sink = makeMp4Sink(smallDef(folder / "sub/clip.mp4"));
  ASSERT_TRUE(sink);
  ASSERT_TRUE((*sink)->push(movingPicture(320, 180, 0)));
  std::filesystem::remove_all(folder / "sub");
  EXPECT_FALSE((*sink)->finish());
}
}  // namespace
}  // namespace swallowclip::video
