// SPDX-License-Identifier: MIT
#include "study/dicom_decoder.h"

#include <gdcmImage.h>
#include <gdcmReader.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>

#include "core/file.h"
#include "study/dicom_header.h"
#include "video/video_reader.h"

namespace swallowclip::study {
namespace {
const gdcm::Tag kPixelData(0x7fe0, 0x0010);

// PS3.5 annex A.4; only these are decoded.
enum class Coding { none, gdcm, video };

Result<Coding> codingOf(const gdcm::TransferSyntax& syntax) {
  using TS = gdcm::TransferSyntax;
  switch (static_cast<TS::TSType>(syntax)) {
    case TS::ImplicitVRLittleEndian:
    case TS::ExplicitVRLittleEndian:
    case TS::ExplicitVRBigEndian:
      return Coding::none;
    case TS::JPEGBaselineProcess1:
    case TS::JPEGExtendedProcess2_4:
    case TS::JPEGLosslessProcess14:
    case TS::JPEGLosslessProcess14_1:
    case TS::JPEGLSLossless:
    case TS::JPEGLSNearLossless:
    case TS::JPEG2000Lossless:
    case TS::JPEG2000:
    case TS::RLELossless:
      return Coding::gdcm;
    case TS::MPEG4AVCH264HighProfileLevel4_1:
    case TS::MPEG4AVCH264BDcompatibleHighProfileLevel4_1:
      return Coding::video;
    default:
      return refuse("has a transfer syntax that is unknown or not for moving pictures (encrypted?)",
                    "Uncompressed, JPEG, JPEG-LS, JPEG 2000, RLE and H.264 are read; convert it.");
  }
}

std::unexpected<Error> damaged(const std::string& what) {
  return refuse(what, "It is cut off or damaged: export it again.");
}

/// While it lives this process gets little more memory than a file of that size can fill: GDCM
/// clears room for every length that a file claims before it looks whether so much is there, and a
/// gigabyte of zeros takes half a second. Sanitizers reserve terabytes: no limit with them.
class ParsingRoom {
 public:
  explicit ParsingRoom(std::uintmax_t file_bytes) {
    ::getrlimit(RLIMIT_AS, &before_);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    constexpr std::uintmax_t kRoom_bytes = std::uintmax_t{32} << 20;  // assumed, range 8 to 500 MB
    std::uintmax_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    rlimit less = before_;
    less.rlim_cur = std::min<rlim_t>(less.rlim_cur,
                                     pages * static_cast<std::uintmax_t>(::sysconf(_SC_PAGESIZE)) +
                                         3 * file_bytes + kRoom_bytes);
    ::setrlimit(RLIMIT_AS, &less);
#else
    (void)file_bytes;
#endif
  }
  ~ParsingRoom() {
    ::setrlimit(RLIMIT_AS, &before_);
  }
  ParsingRoom(const ParsingRoom&) = delete;
  ParsingRoom& operator=(const ParsingRoom&) = delete;

 private:
  rlimit before_{};
};

/// GDCM fills what a cut-off file lacks with zeros. Whether the pixels' end is really there: bytes
/// of an element of the length that it reports (-1: of fragments, which end with a delimiter).
bool pixelsAreWhole(const std::string& file, std::int64_t length, bool bigEndian) {
  using namespace std::string_literals;
  if (length < 0) return file.rfind("\xfe\xff\xdd\xe0\0\0\0\0"s) != std::string::npos;
  const std::string tag = bigEndian ? "\x7f\xe0\x00\x10"s : "\xe0\x7f\x10\x00"s;
  for (std::size_t at = file.find(tag); at != std::string::npos; at = file.find(tag, at + 1))
    for (const std::size_t head : {8, 12}) {  // implicit, explicit value representation
      if (at + head > file.size()) continue;
      std::uint32_t told = 0;
      std::memcpy(&told, file.data() + at + head - 4, 4);
      if (bigEndian) told = __builtin_bswap32(told);
      if (told == length && at + head + told <= file.size()) return true;
    }
  return false;
}

/// One frame's values as the file stores them, made 8-bit RGBA.
class Display {
 public:
  explicit Display(const DicomHeader& h) : h_(h) {
    const double top = std::ldexp(1.0, h.bitsStored) - 1;
    const double low = h.isSigned ? -(top + 1) / 2 : 0, high = h.isSigned ? (top - 1) / 2 : top;
    table_.resize(std::size_t{1} << h.bitsAllocated);
    for (std::size_t bits = 0; bits < table_.size(); ++bits) {
      double value = static_cast<double>(bits & ((std::size_t{1} << h.bitsStored) - 1));
      if (h.isSigned && value > high) value -= top + 1;
      double grey = 0;
      if (h.windowWidth && *h.windowWidth > 1) {  // linear function, PS3.3 C.11.2.1.2.1
        const double x = value * h.slope + h.intercept;
        grey = 255 * ((x - (*h.windowCentre - 0.5)) / (*h.windowWidth - 1) + 0.5);
      } else {
        grey = 255 * (value - low) / (high - low);
      }
      grey = std::clamp(std::round(grey), 0.0, 255.0);
      table_[bits] = static_cast<std::uint8_t>(h.photometric == "MONOCHROME1" ? 255 - grey : grey);
    }
  }

  /// `ybr`: full-range Y Cb Cr values (PS3.3 C.7.6.3.1.2).
  Image picture(const std::vector<char>& values, bool ybr) const {
    Image image(h_.columns, h_.rows);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(values.data());
    const std::size_t pixels = static_cast<std::size_t>(h_.rows) * h_.columns;
    for (std::size_t i = 0; i < pixels; ++i) {
      std::uint8_t* to = &image.rgba[4 * i];
      if (h_.samples == 1) {
        std::size_t bits = bytes[i];
        if (h_.bitsAllocated == 16) bits = bytes[2 * i] | bytes[2 * i + 1] << 8;
        to[0] = to[1] = to[2] = table_[bits];
        continue;
      }
      double c[3];
      for (std::size_t k = 0; k < 3; ++k)
        c[k] = bytes[h_.planarConfiguration == 1 ? k * pixels + i : 3 * i + k];
      if (ybr) {
        const double y = c[0], cb = c[1] - 128, cr = c[2] - 128;
        c[0] = y + 1.402 * cr;
        c[1] = y - 0.344136 * cb - 0.714136 * cr;
        c[2] = y + 1.772 * cb;
      }
      for (int k = 0; k < 3; ++k)
        to[k] = static_cast<std::uint8_t>(std::clamp(std::lround(c[k]), 0L, 255L));
    }
    return image;
  }

 private:
  const DicomHeader& h_;
  std::vector<std::uint8_t> table_;  ///< grey of every stored value
};
}  // namespace

struct DicomDecoder::State {
  gdcm::Reader reader;
  DicomHeader header;
  StudyInfo info;
  Coding coding = Coding::none;
  std::optional<Display> display;
  std::vector<std::vector<unsigned>> fragments;  ///< [frame] which fragments make it up, from 0
  std::unique_ptr<video::VideoReader> video;
  int next = 0;  ///< video only

  const gdcm::DataElement& pixels() const {
    return reader.GetFile().GetDataSet().GetDataElement(kPixelData);
  }
  Result<void> read(const StudyDef& def);
  Result<void> layOut();
  Result<void> splitFragments();
  Result<void> openVideo();
  Result<Image> videoFrame(int k);
  Result<Image> decode(int k);
};

Result<void> DicomDecoder::State::read(const StudyDef& def) {
  gdcm::Trace::DebugOff();
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  reader.SetFileName(def.path.string().c_str());
  bool whole = false;
  try {
    std::error_code ec;
    const ParsingRoom room(std::filesystem::file_size(def.path, ec));
    whole = reader.Read();
  } catch (const std::exception&) {  // its text may quote the file
  }
  if (!whole) return damaged("is no whole DICOM file");
  auto coded = codingOf(reader.GetFile().GetHeader().GetDataSetTransferSyntax());
  if (!coded) return std::unexpected(coded.error());
  coding = *coded;
  auto h = readHeader(reader.GetFile(), def.frameRate_hz);
  if (!h) return std::unexpected(h.error());
  header = std::move(*h);
  if (!reader.GetFile().GetDataSet().FindDataElement(kPixelData))
    return refuse("holds no pixels (7FE0,0010)", "Name an XA, RF or secondary capture object.");
  display.emplace(header);
  info.width = header.columns;
  info.height = header.rows;
  info.time_s = header.time_s;
  info.kind = header.kind;
  info.timing = header.timing;
  info.burnedIn = header.burnedIn;
  info.warnings = header.warnings;
  auto bytes = readFile(def.path);
  if (!bytes) return refuse("can't be read", "Check its permissions.");
  const gdcm::ByteValue* value = pixels().GetByteValue();
  const auto syntax = reader.GetFile().GetHeader().GetDataSetTransferSyntax();
  if (!pixelsAreWhole(*bytes, value ? static_cast<std::int64_t>(value->GetLength()) : -1,
                      syntax == gdcm::TransferSyntax::ExplicitVRBigEndian))
    return damaged("ends before its pixels do");
  return layOut();
}

Result<void> DicomDecoder::State::layOut() {
  if (coding == Coding::video) return openVideo();
  if (header.pixelAspect != 1) info.warnings.push_back("pixels are not square: shown as stored");
  if (coding == Coding::gdcm) return splitFragments();
  const gdcm::ByteValue* value = pixels().GetByteValue();
  const std::size_t needed = header.frameValues() * (header.bitsAllocated / 8) * header.frames;
  const std::size_t held = value ? static_cast<std::size_t>(value->GetLength()) : 0;
  if (header.photometric == "YBR_FULL_422")
    return refuse("stores uncompressed 4:2:2 colour", "Convert it to RGB.");
  if (held < needed)
    return damaged(fmt::format("{} frames of {} x {} need {} bytes, {} are there", header.frames,
                               header.columns, header.rows, needed, held));
  return {};
}

/// PS3.5 A.4: one fragment per frame, or frames that begin where the Basic Offset Table says.
Result<void> DicomDecoder::State::splitFragments() {
  const gdcm::SequenceOfFragments* sequence = pixels().GetSequenceOfFragments();
  if (!sequence) return damaged("its compressed pixels are not in fragments");
  const std::size_t count = sequence->GetNumberOfFragments();
  const auto frames = static_cast<std::size_t>(header.frames);
  if (count == frames) {
    for (unsigned i = 0; i < count; ++i) fragments.push_back({i});
    return {};
  }
  std::vector<std::uint32_t> starts;
  if (const gdcm::ByteValue* table = sequence->GetTable().GetByteValue()) {
    starts.resize(table->GetLength() / 4);
    if (!starts.empty()) std::memcpy(starts.data(), table->GetPointer(), 4 * starts.size());
  }
  if (starts.size() != frames || count < frames)
    return damaged(
        fmt::format("{} fragments and {} offsets for {} frames", count, starts.size(), frames));
  std::uint64_t at = 0;
  for (unsigned i = 0; i < count; ++i) {
    if (fragments.size() < frames && at == starts[fragments.size()]) fragments.emplace_back();
    if (fragments.empty())
      return damaged("its offset table does not begin with the first fragment");
    fragments.back().push_back(i);
    at += 8 + static_cast<std::uint64_t>(sequence->GetFragment(i).GetVL());
  }
  if (fragments.size() != frames)
    return damaged(fmt::format("its offset table fits {} of {} frames", fragments.size(), frames));
  return {};
}

Result<void> DicomDecoder::State::openVideo() {
  const gdcm::SequenceOfFragments* sequence = pixels().GetSequenceOfFragments();
  if (!sequence) return damaged("its compressed pixels are not in fragments");
  std::string stream;  // PS3.5 8.2.7: one stream, possibly cut into fragments
  for (unsigned i = 0; i < sequence->GetNumberOfFragments(); ++i)
    if (const gdcm::ByteValue* part = sequence->GetFragment(i).GetByteValue())
      stream.append(part->GetPointer(), part->GetLength());
  if (stream.empty()) return damaged("holds no video stream");
  auto opened = video::VideoReader::open({{}, std::move(stream), kPlace});
  if (!opened) return std::unexpected(opened.error());
  video = std::move(*opened);
  next = 0;
  info.width = video->info().width;
  info.height = video->info().height;
  return {};
}

Result<Image> DicomDecoder::State::videoFrame(int k) {
  if (k < next)
    if (auto begun = openVideo(); !begun) return std::unexpected(begun.error());
  for (;;) {
    auto frame = video->next();
    if (!frame) return std::unexpected(frame.error());
    if (!*frame)
      return damaged(
          fmt::format("says that it holds {} frames, {} can be read", header.frames, next));
    if (next++ == k) return std::move((*frame)->image);
  }
}

Result<Image> DicomDecoder::State::decode(int k) {
  const std::size_t size = header.frameValues() * (header.bitsAllocated / 8);
  std::vector<char> values(size);
  if (coding == Coding::none) {
    std::memcpy(values.data(), pixels().GetByteValue()->GetPointer() + size * k, size);
    return display->picture(values, header.photometric.starts_with("YBR"));
  }
  // GDCM decodes a still picture made of this frame's fragments
  gdcm::SmartPointer<gdcm::SequenceOfFragments> own = new gdcm::SequenceOfFragments;
  for (const unsigned i : fragments[k])
    own->AddFragment(pixels().GetSequenceOfFragments()->GetFragment(i));
  gdcm::DataElement element(kPixelData);
  element.SetVR(gdcm::VR::OB);
  element.SetValue(*own);
  gdcm::Image still;
  still.SetNumberOfDimensions(2);
  still.SetDimension(0, static_cast<unsigned>(header.columns));
  still.SetDimension(1, static_cast<unsigned>(header.rows));
  const auto bits = static_cast<unsigned short>(header.bitsStored);
  still.SetPixelFormat(gdcm::PixelFormat(static_cast<unsigned short>(header.samples),
                                         static_cast<unsigned short>(header.bitsAllocated), bits,
                                         static_cast<unsigned short>(bits - 1), header.isSigned));
  still.SetPhotometricInterpretation(
      gdcm::PhotometricInterpretation::GetPIType(header.photometric.c_str()));
  still.SetPlanarConfiguration(static_cast<unsigned>(header.planarConfiguration));
  still.SetTransferSyntax(reader.GetFile().GetHeader().GetDataSetTransferSyntax());
  still.SetDataElement(element);
  if (still.GetBufferLength() != size || !still.GetBuffer(values.data()))
    return damaged(fmt::format("frame {} can't be decompressed", k));
  // JPEG 2000 turns its own colour transform back; everything else comes as stored
  return display->picture(values, header.photometric.starts_with("YBR_FULL"));
}

DicomDecoder::DicomDecoder(std::unique_ptr<State> state) : state_(std::move(state)) {}
DicomDecoder::~DicomDecoder() = default;
const StudyInfo& DicomDecoder::info() const {
  return state_->info;
}

Result<std::unique_ptr<DicomDecoder>> DicomDecoder::open(const StudyDef& def) {
  auto state = std::make_unique<State>();
  if (auto read = state->read(def); !read) return std::unexpected(read.error());
  return std::unique_ptr<DicomDecoder>(new DicomDecoder(std::move(state)));
}

Result<Image> DicomDecoder::frame(int k) {
  if (k < 0 || k >= state_->header.frames)
    return damaged(fmt::format("has no frame {}, 0 to {} expected", k, state_->header.frames - 1));
  try {
    return state_->coding == Coding::video ? state_->videoFrame(k) : state_->decode(k);
  } catch (const std::exception&) {
    return damaged(fmt::format("frame {} can't be decompressed", k));
  }
}
}  // namespace swallowclip::study
