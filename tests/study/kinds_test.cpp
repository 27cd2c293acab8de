// SPDX-License-Identifier: MIT
// Odd but honest studies are read as they are meant; lying ones are refused with what is wrong.
#include "studies.h"

namespace swallowclip::study {
namespace {
constexpr int kWidth = 160, kHeight = 120, kFrames = 8;

class VideoKinds : public testing::Test {
 protected:
  void SetUp() override {
    if (!hasProgram("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  }
  void ffmpeg(const std::string& words) const {
    int status = 0;
    const std::string said = output("ffmpeg -y -v error " + words, &status);
    EXPECT_EQ(status, 0) << said;
  }
  test::Scratch scratch;
};

class DicomKinds : public testing::Test {
 protected:
  void SetUp() override {
    if (!hasProgram("dcmodify")) GTEST_SKIP() << "dcmtk is not installed";
    DicomDef def;
    def.path = path;
    def.width = kWidth;
    def.height = kHeight;
    def.colour = false;
    def.coding = DicomCoding::uncompressed;
    ASSERT_TRUE(writeDicom(def, kFrames));
  }
  void modify(const std::string& words) const {
    int status = 0;
    const std::string said =
        output("dcmodify -nb -ie " + words + " '" + path.string() + "'", &status);
    EXPECT_EQ(status, 0) << said;
  }
  std::string refusal() const {
    auto study = Study::open({path});
    return study ? "read" : study.error().text();
  }
  test::Scratch scratch;
  std::filesystem::path path = scratch / "study.dcm";
};
}  // namespace

TEST_F(VideoKinds, RotationAndPixelAspect) {
  writeVideo(scratch / "s.mp4", kWidth, kHeight, kFrames, "30",
             "-c:v libx264 -crf 10 -pix_fmt yuv420p");
  ffmpeg(fmt::format("-i '{0}/s.mp4' -c copy -metadata:s:v rotate=90 '{0}/turned.mov'",
                     scratch.path().string()));
  auto turned = Study::open({scratch / "turned.mov"});
  ASSERT_TRUE(turned) << turned.error().text();
  EXPECT_EQ((*turned)->info().width, kHeight);
  EXPECT_EQ((*turned)->info().height, kWidth);
  auto image = (*turned)->frame(3);
  ASSERT_TRUE(image);
  const Image upright = fluoroPicture(kWidth, kHeight, 3);
  // ffmpeg 5.1 shows this file turned anticlockwise, and so do we: the upper right corner comes to
  // the upper left
  double off = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      off += std::abs(upright.row(y)[4 * x] - image->row(kWidth - 1 - x)[4 * y]);
  EXPECT_LT(off / (kWidth * kHeight), 2);

  ffmpeg(fmt::format("-i '{0}/s.mp4' -c copy -aspect 8:3 '{0}/wide.mp4'", scratch.path().string()));
  auto wide = Study::open({scratch / "wide.mp4"});
  ASSERT_TRUE(wide) << wide.error().text();
  EXPECT_EQ((*wide)->info().width, 2 * kWidth);
  EXPECT_EQ((*wide)->info().height, kHeight);
  EXPECT_EQ((*wide)->info().warnings.size(), 1u);
}

TEST_F(VideoKinds, InterlacedFramesBecomeProgressive) {
  // fields of neighbouring frames woven together: combs on whatever moves
  writeVideo(scratch / "s.mp4", kWidth, kHeight, 2 * kFrames, "60",
             "-vf tinterlace=interleave_top,setfield=tff -c:v libx264 -crf 8 -flags +ilme+ildct "
             "-x264-params tff=1 -pix_fmt yuv420p");
  auto study = Study::open({scratch / "s.mp4"});
  ASSERT_TRUE(study) << study.error().text();
  ASSERT_EQ((*study)->info().frames(), kFrames);
  ASSERT_FALSE((*study)->info().warnings.empty());
  EXPECT_NE((*study)->info().warnings[0].find("interlaced"), std::string::npos);
  for (int k = 0; k < kFrames; ++k) EXPECT_NEAR((*study)->info().time_s[k], k / 30.0, 1e-3);
  auto image = (*study)->frame(4);
  ASSERT_TRUE(image);
  // neighbouring rows agree better with each other than those of the woven frame would
  EXPECT_LT(difference(*image, fluoroPicture(kWidth, kHeight, 8)).mean, 3);
}

TEST_F(VideoKinds, VariableRateKeepsItsTimes) {
  writeVideo(scratch / "s.mp4", kWidth, kHeight, kFrames, "30",
             "-vf \"setpts='N/30/TB+if(gt(N,3),0.1/TB,0)'\" -vsync vfr -c:v libx264 -crf 10 "
             "-pix_fmt yuv420p");
  auto study = Study::open({scratch / "s.mp4"});
  ASSERT_TRUE(study) << study.error().text();
  const auto& t = (*study)->info().time_s;
  ASSERT_EQ(t.size(), std::size_t{kFrames});
  EXPECT_NEAR(t[4] - t[3], 1.0 / 30 + 0.1, 2e-3);
  EXPECT_FALSE((*study)->info().warnings.empty());
}

TEST_F(VideoKinds, DamagedOnesAreRefusedWithoutTheirName) {
  writeVideo(scratch / "DOE.mp4", kWidth, kHeight, 60, "30",
             "-c:v libx264 -crf 10 -g 8 -pix_fmt yuv420p -movflags +faststart");
  const std::string whole = *readFile(scratch / "DOE.mp4");
  for (const double share : {0.0, 0.01, 0.3, 0.7, 0.95}) {
    std::ofstream(scratch / "DOE.mp4", std::ios::binary)
        << whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size())));
    auto study = Study::open({scratch / "DOE.mp4"});
    ASSERT_FALSE(study) << share;
    EXPECT_EQ(study.error().text().find("DOE"), std::string::npos) << study.error().text();
  }
  // Matroska counts no frames, but tells how long it lasts
  ffmpeg(fmt::format("-f lavfi -i testsrc=d=2:r=30:s=64x48 -c:v ffv1 '{}/DOE.mkv'",
                     scratch.path().string()));
  ASSERT_TRUE(Study::open({scratch / "DOE.mkv"}));
  const std::string long2 = *readFile(scratch / "DOE.mkv");
  std::ofstream(scratch / "DOE.mkv", std::ios::binary) << long2.substr(0, long2.size() * 7 / 10);
  auto cut = Study::open({scratch / "DOE.mkv"});
  ASSERT_FALSE(cut);
  EXPECT_NE(cut.error().text().find("says that it lasts 2.00 s"), std::string::npos)
      << cut.error().text();
  // a playlist would open other files
  std::ofstream(scratch / "list.mp4") << "#EXTM3U\n#EXTINF:1,\nDOE.mp4\n";
  EXPECT_FALSE(Study::open({scratch / "list.mp4"}));
  EXPECT_FALSE(Study::open({scratch / "none.mp4"}));
  EXPECT_FALSE(Study::open({scratch.path()}));
}

TEST_F(DicomKinds, TimesComeInTheirOrder) {
  auto study = Study::open({path});
  ASSERT_TRUE(study);
  EXPECT_EQ((*study)->info().timing, "Frame Time");
  modify("-i '(0008,2144)=15' -i '(0018,0040)=10'");
  study = Study::open({path});
  ASSERT_TRUE(study);
  EXPECT_EQ((*study)->info().timing, "Frame Time");
  modify("-e '(0028,0009)'");  // without the pointer, a Frame Time does not count
  study = Study::open({path});
  ASSERT_TRUE(study) << study.error().text();
  EXPECT_EQ((*study)->info().timing, "Recommended Display Frame Rate");
  EXPECT_NEAR((*study)->info().rate_hz(), 15, 1e-9);
  EXPECT_EQ((*study)->info().warnings.size(), 2u);  // where from, and slow
  modify("-e '(0008,2144)'");
  study = Study::open({path});
  ASSERT_TRUE(study);
  EXPECT_EQ((*study)->info().timing, "Cine Rate");
  modify("-e '(0018,0040)'");
  EXPECT_NE(refusal().find("neither frame times nor a rate"), std::string::npos) << refusal();
  study = Study::open({path, 25});
  ASSERT_TRUE(study);
  EXPECT_EQ((*study)->info().timing, "--frame-rate");
  EXPECT_NEAR((*study)->info().rate_hz(), 25, 1e-9);
}

TEST_F(DicomKinds, WindowAndInversion) {
  modify("-i '(0028,1050)=100' -i '(0028,1051)=51'");
  auto study = Study::open({path});
  ASSERT_TRUE(study);
  auto image = (*study)->frame(2);
  ASSERT_TRUE(image);
  const Image stored = fluoroPicture(kWidth, kHeight, 2);
  modify("-m '(0028,0004)=MONOCHROME1'");
  auto inverse = Study::open({path});
  ASSERT_TRUE(inverse);
  auto negative = (*inverse)->frame(2);
  ASSERT_TRUE(negative);
  for (std::size_t i = 0; i < stored.rgba.size(); i += 4) {
    // PS3.3 C.11.2.1.2: y = ((x - (c - 0.5)) / (w - 1) + 0.5) 255
    const double y = std::min(255.0, std::max(0.0, ((stored.rgba[i] - 99.5) / 50 + 0.5) * 255));
    ASSERT_NEAR(image->rgba[i], y, 0.51);
    ASSERT_EQ(negative->rgba[i], 255 - image->rgba[i]);
  }
}

TEST_F(DicomKinds, LiesAreNamed) {
  const std::string whole = *readFile(path);
  const auto said = [&](const std::string& words) {
    std::ofstream(path, std::ios::binary) << whole;
    modify(words);
    return refusal();
  };
  const std::pair<const char*, const char*> cases[] = {
      {"-m '(0028,0008)=9'", "9 frames of 160 x 120 need"},
      {"-m '(0028,0008)=1'", "still picture"},
      {"-m '(0028,0008)=0'", "0 frames"},
      {"-m '(0028,0008)=99999999'", "99999999 frames"},
      {"-m '(0028,0010)=121'", "need"},
      {"-m '(0028,0011)=0'", "pixels"},
      {"-m '(0028,0004)=PALETTE\\ COLOR'", "photometric"},
      {"-m '(0028,0100)=12'", "bits"},
      {"-m '(0018,1063)=-5'", "Frame Time"},
      {"-e '(0018,1063)'", "absent"},
      {"-e '(7fe0,0010)'", "no pixels"},
  };
  for (const auto& [words, expected] : cases)
    EXPECT_NE(said(words).find(expected), std::string::npos) << words << ": " << said(words);
  std::ofstream(path, std::ios::binary) << whole.substr(0, whole.size() - 1000);
  EXPECT_NE(refusal().find("ends before its pixels do"), std::string::npos) << refusal();
  std::ofstream(path, std::ios::binary) << std::string(132, '\0') + "DICM";
  EXPECT_NE(refusal(), "read");
  std::ofstream(path, std::ios::binary) << whole.substr(0, 132) + std::string(5000, '\x5a');
  EXPECT_NE(refusal().find("transfer syntax"), std::string::npos) << refusal();
  // an unknown transfer syntax, as long as the true one
  std::string other = whole;
  const auto at = other.find("1.2.840.10008.1.2.1");
  ASSERT_NE(at, std::string::npos);
  other.replace(at, 19, "1.2.840.10008.1.2.9");
  std::ofstream(path, std::ios::binary) << other;
  EXPECT_NE(refusal().find("transfer syntax that is unknown"), std::string::npos) << refusal();
}
}  // namespace swallowclip::study
