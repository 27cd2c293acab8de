// SPDX-License-Identifier: MIT
#include "study/dicom_writer.h"

#include <gdcmImage.h>
#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmJPEG2000Codec.h>
#include <gdcmJPEGCodec.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>
#include <gdcmWriter.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/digest.h"
#include "core/file.h"
#include "video/jpeg.h"

namespace swallowclip::study {
namespace {
using TS = gdcm::TransferSyntax;
const gdcm::Tag kPixelData(0x7fe0, 0x0010);
// PS3.5 6.2: the length of a value in explicit VR, kept clear of; assumed, range 1 to 4 GB
constexpr std::size_t kLargestPixels_bytes = std::size_t{2} << 30;

/// 2.25 and the decimal value of a UUID of version 8 (own hash, RFC 9562).
std::string uidFrom(const std::string& name) {
  const std::string hex = sha256Hex(name);
  std::vector<int> bytes;
  for (std::size_t i = 0; i < 16; ++i)
    bytes.push_back(std::stoi(hex.substr(2 * i, 2), nullptr, 16));
  bytes[6] = (bytes[6] & 0x0f) | 0x80;
  bytes[8] = (bytes[8] & 0x3f) | 0x80;
  std::string digits;  // long division by ten
  while (std::ranges::any_of(bytes, [](int b) { return b != 0; })) {
    int rest = 0;
    for (int& b : bytes) {
      rest = rest * 256 + b;
      b = rest / 10;
      rest %= 10;
    }
    digits.insert(digits.begin(), static_cast<char>('0' + rest));
  }
  return "2.25." + digits;
}

// 8-bit JPEG that shows no artefact on fluoroscopy; assumed, range 85 to 98
constexpr int kGreyQuality = 92;

class DicomSink : public video::FrameSink {
 public:
  explicit DicomSink(DicomDef def)
      : def_(std::move(def)), fragments_(new gdcm::SequenceOfFragments) {}

  Result<void> push(const Image& image) override {
    if (image.width != def_.width || image.height != def_.height)
      return failure(def_.path.string(),
                     fmt::format("frame {} is {} x {}, {} x {} expected", frames_, image.width,
                                 image.height, def_.width, def_.height),
                     "Draw every frame at one size.");
    std::string raw;
    raw.reserve(static_cast<std::size_t>(def_.width) * def_.height * samples());
    for (std::size_t i = 0; i < image.rgba.size(); i += 4)
      raw.append(reinterpret_cast<const char*>(&image.rgba[i]), samples());
    digest_ = sha256Hex(digest_ + sha256Hex(raw));
    ++frames_;
    if (def_.coding == DicomCoding::jpegBaseline && def_.colour) return compressColour(image);
    if (def_.coding != DicomCoding::uncompressed) return compress(raw);
    if (pixels_.size() + raw.size() > kLargestPixels_bytes)
      return failure(def_.path.string(), "is too large for an uncompressed object", "Compress it.");
    pixels_ += raw;
    return {};
  }

  Result<void> finish() override {
    if (frames_ == 0)
      return failure(def_.path.string(), "no frames were drawn, at least one expected",
                     "Check the clip's time range.");
    if (!def_.frameTimes_ms.empty() && static_cast<int>(def_.frameTimes_ms.size()) != frames_)
      return failure(
          def_.path.string(),
          fmt::format("{} frame times for {} frames", def_.frameTimes_ms.size(), frames_),
          "Give one per frame.");
    gdcm::Writer writer;
    gdcm::File& file = writer.GetFile();
    fill(file.GetDataSet());
    file.GetHeader().SetDataSetTransferSyntax(syntax());
    std::ostringstream bytes;
    writer.SetStream(bytes);
    if (!writer.Write())
      return failure(def_.path.string(), "can't be written as DICOM", "Report it.");
    return writeFile(def_.path, bytes.str());
  }

 private:
  int samples() const { return def_.colour ? 3 : 1; }
  TS syntax() const {
    switch (def_.coding) {
      case DicomCoding::jpegBaseline:
        return TS(TS::JPEGBaselineProcess1);
      case DicomCoding::jpeg2000:
        return TS(TS::JPEG2000Lossless);
      case DicomCoding::rle:
        return TS(TS::RLELossless);
      case DicomCoding::uncompressed:
        break;
    }
    return TS(TS::ExplicitVRLittleEndian);
  }

  void addFragment(const std::string& bytes) {
    gdcm::Fragment fragment;
    fragment.SetByteValue((bytes + std::string(bytes.size() % 2, '\0')).data(),
                          static_cast<std::uint32_t>(bytes.size() + bytes.size() % 2));
    fragments_->AddFragment(fragment);
    coded_bytes_ += bytes.size();
  }

  /// Colour JPEG is YBR_FULL_422 in DICOM, which GDCM does not write.
  Result<void> compressColour(const Image& image) {
    constexpr int kQuantiser = 2;  // libav's finest: near quality 95
    auto bytes = video::encodeJpeg(image, kQuantiser);
    if (!bytes) return std::unexpected(bytes.error());
    addFragment(*bytes);
    photometric_ = "YBR_FULL_422";
    return {};
  }

  Result<void> compress(const std::string& raw) {
    const auto fail = [&] {
      return failure(def_.path.string(), fmt::format("frame {} can't be compressed", frames_ - 1),
                     "Report it with the size of the picture.");
    };
    // counted by GDCM, which would free one on the stack
    gdcm::SmartPointer<gdcm::Image> still = new gdcm::Image;
    still->SetNumberOfDimensions(2);
    still->SetDimension(0, static_cast<unsigned>(def_.width));
    still->SetDimension(1, static_cast<unsigned>(def_.height));
    gdcm::PixelFormat format(gdcm::PixelFormat::UINT8);
    format.SetSamplesPerPixel(static_cast<unsigned short>(samples()));
    still->SetPixelFormat(format);
    still->SetPhotometricInterpretation(def_.colour ? gdcm::PhotometricInterpretation::RGB
                                                    : gdcm::PhotometricInterpretation::MONOCHROME2);
    still->SetTransferSyntax(TS(TS::ExplicitVRLittleEndian));
    gdcm::DataElement element(kPixelData);
    element.SetVR(gdcm::VR::OB);
    element.SetByteValue(raw.data(), static_cast<std::uint32_t>(raw.size()));
    still->SetDataElement(element);
    gdcm::ImageChangeTransferSyntax change;
    change.SetTransferSyntax(syntax());
    change.SetInput(*still);
    gdcm::JPEGCodec jpeg;
    jpeg.SetLossless(false);
    jpeg.SetQuality(kGreyQuality);
    if (def_.coding == DicomCoding::jpegBaseline) change.SetUserCodec(&jpeg);
    gdcm::JPEG2000Codec jpeg2000;  // by itself it leaves colour untransformed, against PS3.5 8.2.4
    jpeg2000.SetReversible(true);
    jpeg2000.SetMCT(def_.colour ? 1 : 0);
    if (def_.coding == DicomCoding::jpeg2000) change.SetUserCodec(&jpeg2000);
    if (!change.Change()) return fail();
    const gdcm::Image& out = change.GetOutput();
    const gdcm::SequenceOfFragments* parts = out.GetDataElement().GetSequenceOfFragments();
    if (!parts || parts->GetNumberOfFragments() != 1) return fail();
    photometric_ = out.GetPhotometricInterpretation().GetString();
    if (def_.coding == DicomCoding::jpeg2000 && def_.colour) photometric_ = "YBR_RCT";
    coded_bytes_ += static_cast<std::size_t>(parts->GetFragment(0).GetVL());
    fragments_->AddFragment(parts->GetFragment(0));
    return {};
  }

  static void put(gdcm::DataSet& set, gdcm::Tag tag, gdcm::VR::VRType vr, std::string value) {
    if (value.size() % 2) value += vr == gdcm::VR::UI ? '\0' : ' ';
    gdcm::DataElement element(tag);
    element.SetVR(vr);
    element.SetByteValue(value.data(), static_cast<std::uint32_t>(value.size()));
    set.Insert(element);
  }
  static void putWords(gdcm::DataSet& set, gdcm::Tag tag, gdcm::VR::VRType vr,
                       const std::vector<int>& words) {
    std::string bytes;
    for (const int w : words) {
      bytes += static_cast<char>(w & 255);
      bytes += static_cast<char>(w >> 8);
    }
    put(set, tag, vr, bytes);
  }

  void fill(gdcm::DataSet& set) const {
    using V = gdcm::VR;
    const std::string sop =
        def_.colour ? "1.2.840.10008.5.1.4.1.1.7.4" : "1.2.840.10008.5.1.4.1.1.7.2";
    put(set, {0x0008, 0x0005}, V::CS, "ISO_IR 192");
    put(set, {0x0008, 0x0008}, V::CS, "DERIVED\\SECONDARY");
    put(set, {0x0008, 0x0016}, V::UI, sop);
    put(set, {0x0008, 0x0018}, V::UI, uidFrom(digest_ + "instance"));
    // patient, study, series: type 2 attributes are there and empty
    for (const std::uint16_t empty : {0x0020, 0x0030, 0x0050, 0x0090})
      put(set, {0x0008, empty},
          empty == 0x0020   ? V::DA
          : empty == 0x0030 ? V::TM
          : empty == 0x0050 ? V::SH
                            : V::PN,
          "");
    put(set, {0x0008, 0x0060}, V::CS, "OT");
    put(set, {0x0008, 0x0064}, V::CS, "SYN");  // conversion type: synthetic image
    put(set, {0x0008, 0x0070}, V::LO, "swallowclip");
    put(set, {0x0008, 0x103e}, V::LO, def_.series);
    put(set, {0x0008, 0x2111}, V::ST, def_.derivation);
    put(set, {0x0010, 0x0010}, V::PN, "SYNTHETIC^SWALLOW");
    put(set, {0x0010, 0x0020}, V::LO, "SYNTHETIC");
    put(set, {0x0010, 0x0030}, V::DA, "");
    put(set, {0x0010, 0x0040}, V::CS, "");
    put(set, {0x0012, 0x0062}, V::CS, "YES");
    put(set, {0x0012, 0x0063}, V::LO, "Built anew from pictures only, nothing copied");
    put(set, {0x0020, 0x000d}, V::UI, uidFrom(digest_ + "study"));
    put(set, {0x0020, 0x000e}, V::UI, uidFrom(digest_ + "series"));
    put(set, {0x0020, 0x0010}, V::SH, "");
    put(set, {0x0020, 0x0011}, V::IS, "1");
    put(set, {0x0020, 0x0013}, V::IS, "1");
    put(set, {0x0020, 0x0020}, V::CS, "");
    put(set, {0x0020, 0x0060}, V::CS, "");
    putTiming(set);
    putPixels(set);
  }

  void putTiming(gdcm::DataSet& set) const {
    using V = gdcm::VR;
    put(set, {0x0028, 0x0008}, V::IS, std::to_string(frames_));
    if (def_.frameTimes_ms.empty()) {
      put(set, {0x0018, 0x1063}, V::DS, fmt::format("{:.10g}", def_.frameTime_ms));
      putWords(set, {0x0028, 0x0009}, V::AT, {0x0018, 0x1063});
      return;
    }
    std::string steps;
    for (const double step : def_.frameTimes_ms)
      steps += fmt::format("{}{:.10g}", steps.empty() ? "" : "\\", step);
    put(set, {0x0018, 0x1065}, V::DS, steps);
    putWords(set, {0x0028, 0x0009}, V::AT, {0x0018, 0x1065});
  }

  void putPixels(gdcm::DataSet& set) const {
    using V = gdcm::VR;
    const bool lossy = def_.coding == DicomCoding::jpegBaseline;
    const std::string plain = def_.colour ? "RGB" : "MONOCHROME2";
    putWords(set, {0x0028, 0x0002}, V::US, {samples()});
    put(set, {0x0028, 0x0004}, V::CS, photometric_.empty() ? plain : photometric_);
    if (def_.colour) putWords(set, {0x0028, 0x0006}, V::US, {0});
    putWords(set, {0x0028, 0x0010}, V::US, {def_.height});
    putWords(set, {0x0028, 0x0011}, V::US, {def_.width});
    putWords(set, {0x0028, 0x0100}, V::US, {8});
    putWords(set, {0x0028, 0x0101}, V::US, {8});
    putWords(set, {0x0028, 0x0102}, V::US, {7});
    putWords(set, {0x0028, 0x0103}, V::US, {0});
    put(set, {0x0028, 0x0301}, V::CS, "NO");  // captions name nobody
    if (!def_.colour) {
      put(set, {0x0028, 0x1052}, V::DS, "0");
      put(set, {0x0028, 0x1053}, V::DS, "1");
      put(set, {0x0028, 0x1054}, V::LO, "US");
      put(set, {0x2050, 0x0020}, V::CS, "IDENTITY");
    }
    put(set, {0x0028, 0x2110}, V::CS, lossy ? "01" : "00");
    if (lossy) {
      const double all = static_cast<double>(def_.width) * def_.height * samples() * frames_;
      put(set, {0x0028, 0x2112}, V::DS,
          fmt::format("{:.4g}", all / static_cast<double>(std::max<std::size_t>(1, coded_bytes_))));
      put(set, {0x0028, 0x2114}, V::CS, "ISO_10918_1");
    }
    gdcm::DataElement pixels(kPixelData);
    if (def_.coding == DicomCoding::uncompressed) {
      std::string bytes = pixels_;
      if (bytes.size() % 2) bytes += '\0';
      pixels.SetVR(V::OB);
      pixels.SetByteValue(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    } else {
      pixels.SetVR(V::OB);
      pixels.SetValue(*fragments_);
    }
    set.Insert(pixels);
  }

  DicomDef def_;
  gdcm::SmartPointer<gdcm::SequenceOfFragments> fragments_;
  std::string pixels_, digest_, photometric_;
  int frames_ = 0;
  std::size_t coded_bytes_ = 0;
};
}  // namespace

Result<std::unique_ptr<video::FrameSink>> makeDicomSink(const DicomDef& def) {
  constexpr int kLongest = 65535;  // rows and columns are 16-bit words
  if (def.width < 1 || def.height < 1 || def.width > kLongest || def.height > kLongest)
    return usageError(def.path.string(), fmt::format("{} x {} pixels", def.width, def.height),
                      "Change width and height in the render preset.");
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  return std::make_unique<DicomSink>(def);
}
}  // namespace swallowclip::study
