// SPDX-License-Identifier: MIT
// A study that was written is read back: same frame times, same pixels within its codec's
// tolerance; and programs that are not ours read the same from our DICOM.
#include "studies.h"

namespace swallowclip::study {
namespace {
constexpr int kWidth = 160, kHeight = 120, kFrames = 12;

struct Codec {
  const char* name;
  DicomCoding coding;
  double mean;  ///< grey levels: none for lossless, JPEG at quality 92 below 1.5
  int largest;
};
constexpr Codec kCodecs[] = {{"Uncompressed", DicomCoding::uncompressed, 0, 0},
                             {"JpegBaseline", DicomCoding::jpegBaseline, 1.5, 12},
                             {"Jpeg2000", DicomCoding::jpeg2000, 0, 0},
                             {"Rle", DicomCoding::rle, 0, 0}};

class DicomReadBack : public testing::TestWithParam<std::tuple<Codec, bool, bool>> {
 protected:
  test::Scratch scratch;
  Codec codec = std::get<0>(GetParam());
  bool vector = std::get<1>(GetParam());
  std::filesystem::path path = scratch / "study.dcm";

  DicomDef def() const {
    DicomDef d;
    d.path = path;
    d.width = kWidth;
    d.height = kHeight;
    d.colour = std::get<2>(GetParam());
    d.coding = codec.coding;
    d.frameTime_ms = 1000.0 / 15;
    if (vector)
      for (int k = 0; k < kFrames; ++k)
        d.frameTimes_ms.push_back(k == 0 ? 0 : k % 3 ? 33.5 : 66.25);
    return d;
  }
  double time_s(int k) const {
    if (!vector) return k / 15.0;
    double t = 0;
    for (int i = 1; i <= k; ++i) t += (i % 3 ? 33.5 : 66.25) * 1e-3;
    return t;
  }
};
}  // namespace

TEST_P(DicomReadBack, TimesAndPixels) {
  ASSERT_TRUE(writeDicom(def(), kFrames));
  auto study = Study::open({path});
  ASSERT_TRUE(study) << study.error().text();
  const StudyInfo& info = (*study)->info();
  ASSERT_EQ(info.frames(), kFrames);
  EXPECT_EQ(info.timing, vector ? "Frame Time Vector" : "Frame Time");
  EXPECT_EQ(info.burnedIn, BurnedIn::no);
  for (int k = 0; k < kFrames; ++k) EXPECT_NEAR(info.time_s[k], time_s(k), 1e-6) << k;
  for (const int k : {0, 5, 11, 3}) {
    auto image = (*study)->frame(k);
    ASSERT_TRUE(image) << image.error().text();
    const Difference d = difference(*image, fluoroPicture(kWidth, kHeight, k));
    EXPECT_LE(d.mean, codec.mean) << codec.name << " frame " << k;
    EXPECT_LE(d.largest, codec.largest) << codec.name << " frame " << k;
  }
}

TEST_P(DicomReadBack, ValidatorFindsNoError) {
  if (!hasProgram("dciodvfy")) GTEST_SKIP() << "dciodvfy (dicom3tools) is not installed";
  ASSERT_TRUE(writeDicom(def(), kFrames));
  const std::string said = output(fmt::format("dciodvfy '{}'", path.string()));
  EXPECT_EQ(said.find("Error"), std::string::npos) << said;
}

TEST_P(DicomReadBack, PydicomAgrees) {
  const std::string python = pythonWithPydicom();
  if (python.empty()) GTEST_SKIP() << "pydicom, Pillow or numpy is not installed";
  ASSERT_TRUE(writeDicom(def(), kFrames));
  // grey level of every pixel of frame 5, in the middle row, as another reader sees it
  std::ofstream(scratch / "read.py") << R"(
import sys, pydicom
from pydicom.pixel_data_handlers.util import convert_color_space
d = pydicom.dcmread(sys.argv[1])
p = d.pixel_array
if d.PhotometricInterpretation.startswith('YBR_FULL'): p = convert_color_space(p, d.PhotometricInterpretation, 'RGB')
f = p[5][p.shape[1] // 2]
print(d.NumberOfFrames, [float(x) for x in d.FrameTimeVector] if 'FrameTimeVector' in d else float(d.FrameTime))
print(*[int(v[0]) if hasattr(v, '__len__') else int(v) for v in f])
)";
  int status = 0;
  const std::string said = output(
      fmt::format("{} '{}' '{}'", python, (scratch / "read.py").string(), path.string()), &status);
  ASSERT_EQ(status, 0) << said;
  std::istringstream lines(said);
  std::string first;
  std::getline(lines, first);
  EXPECT_TRUE(first.starts_with(vector ? "12 [0.0, 33.5, 33.5, 66.25" : "12 66.66666667")) << first;
  const Image expected = fluoroPicture(kWidth, kHeight, 5);
  for (int x = 0; x < kWidth; ++x) {
    int grey = -1;
    lines >> grey;
    EXPECT_NEAR(grey, expected.row(kHeight / 2)[4 * x], codec.largest) << x;
  }
}

TEST_P(DicomReadBack, DcmtkAgrees) {
  if (!hasProgram("dcmdump") || !hasProgram("dcmj2pnm")) GTEST_SKIP() << "dcmtk is not installed";
  ASSERT_TRUE(writeDicom(def(), kFrames));
  const std::string dump = output(fmt::format("dcmdump '{}'", path.string()));
  EXPECT_NE(dump.find(vector ? "(0018,1065)" : "(0018,1063)"), std::string::npos);
  EXPECT_NE(dump.find(vector ? "0\\33.5\\33.5\\66.25" : "66.66666667"), std::string::npos) << dump;
  if (codec.coding == DicomCoding::jpeg2000)
    GTEST_SKIP() << "times agree; dcmtk decodes no JPEG 2000";
  // dcmj2pnm counts frames from 1; PGM or PPM, 8 bits
  int status = 0;
  const std::string pnm = (scratch / "frame.pnm").string();
  const std::string said = output(
      fmt::format("dcmj2pnm --frame 6 --no-windowing '{}' '{}'", path.string(), pnm), &status);
  ASSERT_EQ(status, 0) << said;
  auto bytes = readFile(pnm);
  ASSERT_TRUE(bytes);
  const int samples = std::get<2>(GetParam()) ? 3 : 1;
  ASSERT_GE(bytes->size(), std::size_t{kWidth} * kHeight * samples);
  const auto* pixels = reinterpret_cast<const std::uint8_t*>(bytes->data()) + bytes->size() -
                       std::size_t{kWidth} * kHeight * samples;
  const Image expected = fluoroPicture(kWidth, kHeight, 5);
  for (int i = 0; i < kWidth * kHeight; ++i)
    ASSERT_NEAR(pixels[i * samples], expected.rgba[4 * i], codec.largest) << i;
}

INSTANTIATE_TEST_SUITE_P(All, DicomReadBack,
                         testing::Combine(testing::ValuesIn(kCodecs), testing::Bool(),
                                          testing::Bool()),
                         [](const auto& tested) {
                           return fmt::format("{}{}{}", std::get<0>(tested.param).name,
                                              std::get<1>(tested.param) ? "Vector" : "Time",
                                              std::get<2>(tested.param) ? "Colour" : "Grey");
                         });

// Codings that we read and do not write: other programs make these files.
TEST(DicomOfOthers, JpegLsAndLosslessJpeg) {
  if (!hasProgram("gdcmconv")) GTEST_SKIP() << "gdcmconv is not installed";
  test::Scratch scratch;
  for (const bool colour : {false, true})
    for (const char* coding : {"--jpegls", "--jpeg"}) {
      DicomDef def;
      def.path = scratch / "plain.dcm";
      def.width = kWidth;
      def.height = kHeight;
      def.colour = colour;
      def.coding = DicomCoding::uncompressed;
      ASSERT_TRUE(writeDicom(def, kFrames));
      const auto path = scratch / "study.dcm";
      int status = 0;
      const std::string said = output(
          fmt::format("gdcmconv {} '{}' '{}'", coding, def.path.string(), path.string()), &status);
      ASSERT_EQ(status, 0) << said;
      auto study = Study::open({path});
      ASSERT_TRUE(study) << coding << ": " << study.error().text();
      ASSERT_EQ((*study)->info().frames(), kFrames);
      for (int k = 0; k < kFrames; ++k) {
        EXPECT_NEAR((*study)->info().time_s[k], k / 30.0, 1e-6);
        auto image = (*study)->frame(k);
        ASSERT_TRUE(image) << image.error().text();
        EXPECT_EQ(difference(*image, fluoroPicture(kWidth, kHeight, k)).largest, 0) << coding;
      }
    }
}

TEST(DicomOfOthers, H264Stream) {
  const std::string python = pythonWithPydicom();
  if (python.empty() || !hasProgram("ffmpeg"))
    GTEST_SKIP() << "pydicom, Pillow, numpy or ffmpeg is not installed";
  test::Scratch scratch;
  DicomDef def;
  def.path = scratch / "study.dcm";
  def.width = kWidth;
  def.height = kHeight;
  def.coding = DicomCoding::uncompressed;
  std::ofstream(scratch / "wrap.py") << R"(
import sys, pydicom
from pydicom.encaps import encapsulate
d = pydicom.dcmread(sys.argv[1])
d.PixelData = encapsulate([open(sys.argv[2], 'rb').read()])
d['PixelData'].VR, d['PixelData'].is_undefined_length = 'OB', True
d.PhotometricInterpretation = 'YBR_PARTIAL_420'
d.file_meta.TransferSyntaxUID = '1.2.840.10008.1.2.4.102'
d.save_as(sys.argv[1])
)";
  // PS3.5 8.2.7: a bare stream, or an MP4 file
  for (const char* stream : {"s.h264", "s.mp4"}) {
    ASSERT_TRUE(writeDicom(def, kFrames));
    writeVideo(scratch / stream, kWidth, kHeight, kFrames, "30",
               "-c:v libx264 -crf 12 -pix_fmt yuv420p");
    int status = 0;
    const std::string said =
        output(fmt::format("{} '{}' '{}' '{}'", python, (scratch / "wrap.py").string(),
                           def.path.string(), (scratch / stream).string()),
               &status);
    ASSERT_EQ(status, 0) << said;
    auto study = Study::open({def.path});
    ASSERT_TRUE(study) << stream << ": " << study.error().text();
    ASSERT_EQ((*study)->info().frames(), kFrames);
    for (const int k : {0, 5, 11, 3}) {
      auto image = (*study)->frame(k);
      ASSERT_TRUE(image) << image.error().text();
      EXPECT_LE(difference(*image, fluoroPicture(kWidth, kHeight, k)).mean, 1.5) << k;
    }
  }
}

namespace {
struct VideoCase {
  const char* name;
  const char* file;
  const char* rate;
  double rate_hz;
  const char* options;
  double mean;
};
// H.264 at crf 12 and MJPEG at q 2: below one grey level on average for smooth pictures.
constexpr VideoCase kVideos[] = {
    {"Mp4At30", "s.mp4", "30", 30, "-c:v libx264 -crf 12 -pix_fmt yuv420p", 1.5},
    {"Mp4At15", "s.mp4", "15", 15, "-c:v libx264 -crf 12 -pix_fmt yuv420p", 1.5},
    {"MovAt29", "s.mov", "30000/1001", 30000.0 / 1001, "-c:v libx264 -crf 12 -pix_fmt yuv420p",
     1.5},
    {"AviMjpeg", "s.avi", "30", 30, "-c:v mjpeg -q:v 2 -pix_fmt yuvj420p", 1.5},
    {"MkvFfv1", "s.mkv", "25", 25, "-c:v ffv1 -pix_fmt gray", 0.6}};
class VideoReadBack : public testing::TestWithParam<VideoCase> {};
}  // namespace

TEST_P(VideoReadBack, TimesAndPixels) {
  if (!hasProgram("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  const VideoCase& c = GetParam();
  test::Scratch scratch;
  const auto path = scratch / c.file;
  writeVideo(path, kWidth, kHeight, kFrames, c.rate, c.options);
  auto study = Study::open({path});
  ASSERT_TRUE(study) << study.error().text();
  const StudyInfo& info = (*study)->info();
  ASSERT_EQ(info.frames(), kFrames);
  EXPECT_EQ(info.burnedIn, BurnedIn::unknown);
  // Matroska keeps milliseconds
  for (int k = 0; k < kFrames; ++k)
    EXPECT_NEAR(info.time_s[k], k / c.rate_hz, path.extension() == ".mkv" ? 5.1e-4 : 1e-6) << k;
  EXPECT_EQ(info.warnings.empty(), c.rate_hz > 29)
      << fmt::format("{}", fmt::join(info.warnings, "\n"));
  for (const int k : {0, 5, 11, 3}) {
    auto image = (*study)->frame(k);
    ASSERT_TRUE(image) << image.error().text();
    EXPECT_LE(difference(*image, fluoroPicture(kWidth, kHeight, k)).mean, c.mean) << k;
  }
}
INSTANTIATE_TEST_SUITE_P(All, VideoReadBack, testing::ValuesIn(kVideos),
                         [](const auto& tested) { return tested.param.name; });
}  // namespace swallowclip::study
