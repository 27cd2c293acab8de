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
// No RLIMIT_AS with a sanitizer: refusing single large claims, as malloc may, keeps them from
// filling the machine instead. What is freed is kept for a while only: every decoder's process
// begins as a copy of all of it.
extern "C" const char* __asan_default_options() {
  return "max_allocation_size_mb=64:allocator_may_return_null=1:quarantine_size_mb=4";
}
#endif

namespace swallowclip::study {
namespace {
constexpr int kFrames = 4;
constexpr int kInputs = 10000;
constexpr double kPatience_s = 120;       // one input: the decoder's own 30 s, on a busy machine
constexpr long kMemory_kB = 1500 * 1024;  // of this process, all inputs together

/// Changes from byte `first` on; if not 0, they leave the length as it is.
std::string mutated(std::string bytes, std::size_t first, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return n ? random() % n : 0; };
  const int changes = 1 + static_cast<int>(below(6));
  for (int i = 0; i < changes && bytes.size() > first; ++i) {
    // headers decide more than pixels: half of all changes hit the first 1500 bytes
    const std::size_t rest = bytes.size() - first;
    const std::size_t at = first + below(below(2) ? std::min<std::size_t>(rest, 1500) : rest);
    switch (below(first > 0 ? 4 : 7)) {
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
        if (at + 1 < bytes.size()) std::swap(bytes[at], bytes[at + 1]);
        break;
      case 4:
        bytes.resize(at);
        break;
      case 5:
        bytes.erase(at, 1 + below(16));
        break;
      default:
        bytes.insert(at, bytes.substr(below(bytes.size()), below(64)));
    }
  }
  return bytes;
}

[[maybe_unused]] long peakMemory_kB() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

/// A decoder's process has no stderr: what its sanitizer finds goes to files. Only refused claims
/// of memory may be found.
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
    const auto says = [&](const char* words) { return report.find(words) != std::string::npos; };
    const bool refusedClaim = says("allocation-size-too-big") || says("out-of-memory");
    if ((says("ERROR: ") && !refusedClaim) || says("runtime error: ")) return report;
  }
  return "";
}

enum class Maker { sink, gdcmconv, ffmpeg, wrapped };
struct Decoder {
  const char* name;
  const char* file;
  Maker maker;
  DicomCoding coding;   ///< of the sink
  const char* options;  ///< of the program
};
constexpr DicomCoding kPlain = DicomCoding::uncompressed;
constexpr Decoder kDecoders[] = {
    {"Uncompressed", "s.dcm", Maker::sink, kPlain, ""},
    {"JpegBaseline", "s.dcm", Maker::sink, DicomCoding::jpegBaseline, ""},
    {"Jpeg2000", "s.dcm", Maker::sink, DicomCoding::jpeg2000, ""},
    {"Rle", "s.dcm", Maker::sink, DicomCoding::rle, ""},
    {"JpegLs", "s.dcm", Maker::gdcmconv, kPlain, "--jpegls"},
    {"JpegLossless", "s.dcm", Maker::gdcmconv, kPlain, "--jpeg"},
    {"DicomH264", "s.dcm", Maker::wrapped, kPlain, "-c:v libx264 -pix_fmt yuv420p"},
    {"Mp4H264", "s.mp4", Maker::ffmpeg, kPlain, "-c:v libx264 -pix_fmt yuv420p"},
    {"AviMjpeg", "s.avi", Maker::ffmpeg, kPlain, "-c:v mjpeg -pix_fmt yuvj420p"},
    {"MkvFfv1", "s.mkv", Maker::ffmpeg, kPlain, "-c:v ffv1 -pix_fmt gray"},
    {"MovMpeg4", "s.mov", Maker::ffmpeg, kPlain, "-c:v mpeg4 -pix_fmt yuv420p"}};

void replace(std::string& bytes, std::string_view from, std::string_view to) {
  const std::size_t at = bytes.find(from);
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at, from.size(), to);
}

/// The uncompressed object at `path` becomes one that holds `stream` (PS3.5 8.2.7).
void wrap(const std::filesystem::path& path, std::string stream) {
  using namespace std::string_literals;
  std::string bytes = *readFile(path);
  replace(bytes,
          "UI\x14\0"
          "1.2.840.10008.1.2.1\0"s,
          "UI\x18\0"
          "1.2.840.10008.1.2.4.102\0"s);
  replace(bytes, "CS\x04\0RGB "s, "CS\x10\0YBR_PARTIAL_420 "s);
  bytes.resize(bytes.find("\xe0\x7f\x10\0"s));
  stream.resize(stream.size() + stream.size() % 2);
  const auto length = static_cast<std::uint32_t>(stream.size());
  bytes += "\xe0\x7f\x10\0OB\0\0\xff\xff\xff\xff\xfe\xff\0\xe0\0\0\0\0\xfe\xff\0\xe0"s;
  bytes.append(reinterpret_cast<const char*>(&length), 4);
  bytes += stream + "\xfe\xff\xdd\xe0\0\0\0\0"s;
  ASSERT_TRUE(writeFile(path, bytes));
}

/// A study of its kind; what program is missing for it.
std::string make(const Decoder& d, const std::filesystem::path& path) {
  const bool video = d.maker == Maker::ffmpeg || d.maker == Maker::wrapped;
  const char* program = video ? "ffmpeg" : "gdcmconv";
  if (d.maker != Maker::sink && !hasProgram(program)) return program;
  constexpr int kWidth = 48, kHeight = 32;
  if (d.maker == Maker::ffmpeg) {
    writeVideo(path, kWidth, kHeight, kFrames, "30", d.options);
    return "";
  }
  DicomDef def;
  def.path = path;
  def.width = kWidth;
  def.height = kHeight;
  def.colour = true;
  def.coding = d.coding;
  EXPECT_TRUE(writeDicom(def, kFrames));
  if (d.maker == Maker::gdcmconv) {
    int status = 0;
    const std::string said =
        output(fmt::format("gdcmconv {0} '{1}' '{1}'", d.options, path.string()), &status);
    EXPECT_EQ(status, 0) << said;
  }
  if (d.maker == Maker::wrapped) {
    const std::filesystem::path stream = path.string() + ".h264";
    writeVideo(stream, kWidth, kHeight, kFrames, "30", d.options);
    wrap(path, *readFile(stream));
  }
  return "";
}
class Fuzz : public testing::TestWithParam<Decoder> {};
}  // namespace

TEST_P(Fuzz, ReadOrRefused) {
  const Decoder& d = GetParam();
  test::Scratch scratch;
  const auto path = scratch / d.file;
  const std::string missing = make(d, path);
  if (!missing.empty()) GTEST_SKIP() << missing << " is not installed";
  {
    auto undamaged = Study::open({path});
    ASSERT_TRUE(undamaged) << undamaged.error().text();
    ASSERT_EQ((*undamaged)->info().frames(), kFrames);
  }
  const std::string whole = *readFile(path);
  // fewer for a quick look: SWALLOWCLIP_FUZZ_INPUTS
  const char* fewer = std::getenv("SWALLOWCLIP_FUZZ_INPUTS");
  const int inputs = fewer ? std::atoi(fewer) : kInputs;
  reportTo(scratch.path());
  int read = 0, refused = 0, broke = 0;
  for (int i = 0; i < inputs; ++i) {
    std::mt19937 random(static_cast<unsigned>(i));
    // every other file keeps its structure, so that its codec meets the changes
    const std::size_t first = i % 2                      ? 0
                              : d.maker == Maker::ffmpeg ? 32
                                                         : whole.find("\xe0\x7f\x10");
    std::ofstream(path, std::ios::binary) << mutated(whole, first, random);
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
  const bool ours = d.maker == Maker::sink && (d.coding == kPlain || d.coding == DicomCoding::rle);
  EXPECT_TRUE(broke == 0 || !ours);  // no library is at work there
#if !defined(__SANITIZE_ADDRESS__)
  EXPECT_LT(peakMemory_kB(), kMemory_kB);
#endif
}
INSTANTIATE_TEST_SUITE_P(All, Fuzz, testing::ValuesIn(kDecoders),
                         [](const auto& tested) { return tested.param.name; });
}  // namespace swallowclip::study
