// SPDX-License-Identifier: MIT
#include "study/dicom_decoder.h"

#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>

#include <algorithm>
#include <cmath>

#include "core/file.h"
#include "study/coded_frame.h"
#include "video/video_reader.h"

namespace swallowclip::study {
namespace {
using TS = gdcm::TransferSyntax;

// PS3.5 annex A.4; only these are decoded.
enum class Coding { none, rle, jpeg, jpeg2000, video };

Result<Coding> codingOf(TS::TSType syntax) {
  switch (syntax) {
    case TS::ImplicitVRLittleEndian:
    case TS::ExplicitVRLittleEndian:
    case TS::ExplicitVRBigEndian:
      return Coding::none;
    case TS::RLELossless:
      return Coding::rle;
    case TS::JPEGBaselineProcess1:
    case TS::JPEGExtendedProcess2_4:
    case TS::JPEGLosslessProcess14:
    case TS::JPEGLosslessProcess14_1:
    case TS::JPEGLSLossless:
    case TS::JPEGLSNearLossless:
      return Coding::jpeg;
    case TS::JPEG2000Lossless:
    case TS::JPEG2000:
      return Coding::jpeg2000;
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
  Image picture(std::string_view values, bool ybr) const {
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
  std::string file;  ///< its bytes; what follows looks into them
  DicomHeader header;
  StudyInfo info;
  TS::TSType syntax = TS::TS_END;
  Coding coding = Coding::none;
  Element pixels;
  bool swapped = false;  ///< pairs of bytes in `pixels`
  std::optional<Display> display;
  std::vector<std::string> coded;  ///< [frame] compressed
  std::unique_ptr<video::VideoReader> video;
  int next = 0;  ///< video only

  Result<void> read(const StudyDef& def);
  Result<void> layOut();
  Result<void> splitFragments();
  Result<void> openVideo();
  Result<Image> videoFrame(int k);
  Result<Image> decode(int k);
  Result<std::string> decompress(int k) const;
};

Result<void> DicomDecoder::State::read(const StudyDef& def) {
  auto bytes = readFile(def.path);
  if (!bytes) return refuse("can't be read", "Check its permissions.");
  file = std::move(*bytes);
  auto meta = parseMeta(file);
  if (!meta) return std::unexpected(meta.error());
  syntax = TS::GetTSType(meta->transferSyntax.c_str());
  auto known = codingOf(syntax);
  if (!known) return std::unexpected(known.error());
  coding = *known;
  auto set = DataSet::parse(meta->set, meta->coding);
  if (!set) return std::unexpected(set.error());
  auto h = readHeader(*set, def.frameRate_hz);
  if (!h) return std::unexpected(h.error());
  header = std::move(*h);
  const Element* found = set->find(0x7fe00010);
  if (!found)
    return refuse("holds no pixels (7FE0,0010)", "Name an XA, RF or secondary capture object.");
  pixels = *found;
  swapped = meta->coding.bigEndian && (pixels.words || header.bitsAllocated == 16);
  display.emplace(header);
  info.width = header.columns;
  info.height = header.rows;
  info.time_s = header.time_s;
  info.kind = header.kind;
  info.timing = header.timing;
  info.burnedIn = header.burnedIn;
  info.warnings = header.warnings;
  return layOut();
}

Result<void> DicomDecoder::State::layOut() {
  if (coding == Coding::video) return openVideo();
  if (header.pixelAspect != 1) info.warnings.push_back("pixels are not square: shown as stored");
  if (coding != Coding::none) return splitFragments();
  const std::size_t needed = header.frameValues() * (header.bitsAllocated / 8) * header.frames;
  const std::size_t held = pixels.openEnded ? 0 : pixels.value.size();
  if (header.photometric == "YBR_FULL_422")
    return refuse("stores uncompressed 4:2:2 colour", "Convert it to RGB.");
  if (held < needed)
    return damaged(fmt::format("{} frames of {} x {} need {} bytes, {} are there", header.frames,
                               header.columns, header.rows, needed, held));
  return {};
}

/// PS3.5 A.4: one fragment per frame, or frames that begin where the Basic Offset Table says.
Result<void> DicomDecoder::State::splitFragments() {
  auto items = fragmentsOf(pixels);
  if (!items) return std::unexpected(items.error());
  const std::string_view table = items->front();
  const std::size_t count = items->size() - 1, offsets = table.size() / 4;
  const auto frames = static_cast<std::size_t>(header.frames);
  if (count != frames && (offsets != frames || count < frames))
    return damaged(
        fmt::format("{} fragments and {} offsets for {} frames", count, offsets, frames));
  std::size_t at = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string_view part = (*items)[i + 1];
    if (count == frames || (coded.size() < frames && at == wordAt(table, 4 * coded.size(), 4)))
      coded.emplace_back();
    if (coded.empty()) return damaged("its offset table does not begin with the first fragment");
    coded.back() += part;
    at += 8 + part.size();
  }
  if (coded.size() != frames)
    return damaged(fmt::format("its offset table fits {} of {} frames", coded.size(), frames));
  return {};
}

Result<void> DicomDecoder::State::openVideo() {
  auto items = fragmentsOf(pixels);
  if (!items) return std::unexpected(items.error());
  std::string stream;  // PS3.5 8.2.7: one stream, possibly cut into fragments
  for (std::size_t i = 1; i < items->size(); ++i) stream += (*items)[i];
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
  if (coding == Coding::none) {
    const std::size_t size = header.frameValues() * (header.bitsAllocated / 8);
    std::string values(pixels.value.substr(size * k, size));
    if (swapped)
      for (std::size_t i = 0; i + 1 < values.size(); i += 2) std::swap(values[i], values[i + 1]);
    return display->picture(values, header.photometric.starts_with("YBR"));
  }
  auto values = decompress(k);
  if (!values) return std::unexpected(values.error());
  // JPEG 2000 turns its own colour transform back; everything else comes as stored
  return display->picture(*values, header.photometric.starts_with("YBR_FULL"));
}

Result<std::string> DicomDecoder::State::decompress(int k) const {
  if (coding == Coding::rle) return decodeRle(coded[k], header, k);
  const auto check = coding == Coding::jpeg ? checkJpeg : checkJpeg2000;
  if (auto agrees = check(coded[k], header, k); !agrees) return std::unexpected(agrees.error());
  gdcm::SmartPointer<gdcm::SequenceOfFragments> own = new gdcm::SequenceOfFragments;
  gdcm::Fragment fragment;
  fragment.SetByteValue(coded[k].data(), static_cast<std::uint32_t>(coded[k].size()));
  own->AddFragment(fragment);
  gdcm::DataElement element(gdcm::Tag(0x7fe0, 0x0010));
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
  still.SetTransferSyntax(syntax);
  still.SetDataElement(element);
  std::string values(header.frameValues() * (header.bitsAllocated / 8), '\0');
  if (still.GetBufferLength() != values.size() || !still.GetBuffer(values.data()))
    return damaged(fmt::format("frame {} can't be decompressed", k));
  return values;
}

DicomDecoder::DicomDecoder(std::unique_ptr<State> state) : state_(std::move(state)) {}
DicomDecoder::~DicomDecoder() = default;
const StudyInfo& DicomDecoder::info() const {
  return state_->info;
}

Result<std::unique_ptr<DicomDecoder>> DicomDecoder::open(const StudyDef& def) {
  gdcm::Trace::DebugOff();
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
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
