// SPDX-License-Identifier: MIT
// Damaged studies, 10,000 per decoder: bytes changed, lengths and counts lied about, files cut off
// or stretched. Every one is read to its end or refused in words; nothing crashes, hangs or grows.
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cstring>
#include <random>

#include "studies.h"

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/common_interface_defs.h>
// No RLIMIT_AS with a sanitizer: this keeps claimed lengths from filling the machine instead.
extern "C" const char* __asan_default_options() {
  return "max_allocation_size_mb=64";
}
#endif

namespace swallowclip::study {
namespace {
constexpr int kFrames = 4;
constexpr int kInputs = 10000;
constexpr double kPatience_s = 120;       // one input: the decoder's own 30 s, on a busy machine
constexpr long kMemory_kB = 1500 * 1024;  // of this process, all inputs together

std::string mutated(std::string bytes, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return n ? random() % n : 0; };
  const int changes = 1 + static_cast<int>(below(6));
  for (int i = 0; i < changes && !bytes.empty(); ++i) {
    // headers decide more than pixels: half of all changes hit the first 1500 bytes
    const std::size_t reach = below(2) ? std::min<std::size_t>(bytes.size(), 1500) : bytes.size();
    const std::size_t at = below(reach);
    switch (below(7)) {
      case 0:
        bytes[at] = static_cast<char>(random());
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 2: {  // a length or count
        static constexpr std::uint32_t kBig[] = {0,          0xffffffff, 0xfffffffe, 0x7fffffff,
                                                 0x80000000, 0x10000,    1};
        const std::uint32_t word = kBig[below(std::size(kBig))];
        std::memcpy(&bytes[at], &word, std::min<std::size_t>(4, bytes.size() - at));
        break;
      }
      case 3:
        bytes.resize(at);
        break;
      case 4:
        bytes.erase(at, 1 + below(16));
        break;
      case 5:
        bytes.insert(at, bytes.substr(below(bytes.size()), below(64)));
        break;
      default:
        if (at + 1 < bytes.size()) std::swap(bytes[at], bytes[at + 1]);
    }
  }
  return bytes;
}

[[maybe_unused]] long peakMemory_kB() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

/// A decoder's process has no stderr: what its sanitizer finds goes to files. Only refused claims of
/// memory may be found, and what GDCM and its codecs do wrong by themselves: that ends their process.
void reportTo([[maybe_unused]] const std::filesystem::path& folder) {
#if defined(__SANITIZE_ADDRESS__)
  __sanitizer_set_report_path((folder / "report").c_str());
#endif
}
std::string firstFinding(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (!entry.path().filename().string().starts_with("report.")) continue;
    const std::string report = readFile(entry.path()).value_or("unreadable");
    std::filesystem::remove(entry.path());
    if (report.find("allocation-size-too-big") != std::string::npos) continue;
    std::istringstream lines(report);
    std::string line;  // the innermost frame that is not the sanitizer's own
    while (std::getline(lines, line))
      if (line.find("    #") == 0 && line.find("libasan") == std::string::npos) break;
    if (line.find(".so") == std::string::npos) return report;
  }
  return "";
}

struct Decoder {
  const char* name;
  const char* file;
  int coding;           ///< of our DICOM writer; -1: ffmpeg
  const char* options;  ///< of ffmpeg
};
constexpr Decoder kDecoders[] = {
    {"Uncompressed", "s.dcm", static_cast<int>(DicomCoding::uncompressed), ""},
    {"JpegBaseline", "s.dcm", static_cast<int>(DicomCoding::jpegBaseline), ""},
    {"Jpeg2000", "s.dcm", static_cast<int>(DicomCoding::jpeg2000), ""},
    {"Rle", "s.dcm", static_cast<int>(DicomCoding::rle), ""},
    {"Mp4H264", "s.mp4", -1, "-c:v libx264 -pix_fmt yuv420p"},
    {"AviMjpeg", "s.avi", -1, "-c:v mjpeg -pix_fmt yuvj420p"},
    {"MkvFfv1", "s.mkv", -1, "-c:v ffv1 -pix_fmt gray"},
    {"MovMpeg4", "s.mov", -1, "-c:v mpeg4 -pix_fmt yuv420p"}};
class Fuzz : public testing::TestWithParam<Decoder> {};
}  // namespace

TEST_P(Fuzz, ReadOrRefused) {
  const Decoder& d = GetParam();
  test::Scratch scratch;
  const auto path = scratch / d.file;
  if (d.coding >= 0) {
    DicomDef def;
    def.path = path;
    def.width = 48;
    def.height = 32;
    def.colour = true;
    def.coding = static_cast<DicomCoding>(d.coding);
    ASSERT_TRUE(writeDicom(def, kFrames));
  } else {
    if (!hasProgram("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
    writeVideo(path, 48, 32, kFrames, "30", d.options);
  }
  const std::string whole = *readFile(path);
  // fewer for a quick look: SWALLOWCLIP_FUZZ_INPUTS
  const char* fewer = std::getenv("SWALLOWCLIP_FUZZ_INPUTS");
  const int inputs = fewer ? std::atoi(fewer) : kInputs;
  reportTo(scratch.path());
  int read = 0, refused = 0, broke = 0;
  for (int i = 0; i < inputs; ++i) {
    std::mt19937 random(static_cast<unsigned>(i));
    std::ofstream(path, std::ios::binary) << mutated(whole, random);
    const auto start = std::chrono::steady_clock::now();
    auto study = Study::open({path});
    if (study) {
      ++read;
      for (int k = (*study)->info().frames() - 1; k >= 0; --k)
        if (!(*study)->frame(k)) break;
    } else {
      ++refused;
      broke += study.error().problem.find("breaks its decoder") != std::string::npos;
      ASSERT_EQ(study.error().place, kPlace) << i;
      ASSERT_FALSE(study.error().remedy.empty()) << i;
    }
    const double took_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    ASSERT_LT(took_s, kPatience_s) << "input " << i;
    ASSERT_EQ(firstFinding(scratch.path()), "") << "input " << i;
  }
  fmt::print("{}: {} read, {} refused, of those {} ended their decoder's process\n", d.name, read,
             refused, broke);
  EXPECT_EQ(read + refused, inputs);
#if !defined(__SANITIZE_ADDRESS__)
  EXPECT_LT(peakMemory_kB(), kMemory_kB);
#endif
}
INSTANTIATE_TEST_SUITE_P(All, Fuzz, testing::ValuesIn(kDecoders),
                         [](const auto& tested) { return tested.param.name; });
}  // namespace swallowclip::study
