// SPDX-License-Identifier: MIT
#include "study/dicom_header.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "study/video_study.h"

namespace swallowclip::study {
namespace {
constexpr int kLongestSide = 8192;      // pixels; assumed, range 4096 to 16384
constexpr double kLongestFrame_s = 10;  // no fluoroscopy is slower; assumed, range 2 to 60

/// Attributes as text and numbers.
class Attributes {
 public:
  explicit Attributes(const DataSet& set) : set_(set) {}

  std::optional<std::string> text(Tag tag) const {
    const Element* e = set_.find(tag);
    if (!e) return std::nullopt;
    std::string words(e->value);
    while (words.ends_with(' ') || words.ends_with('\0')) words.pop_back();
    words.erase(0, words.find_first_not_of(' '));
    if (words.empty()) return std::nullopt;
    return words;
  }
  std::optional<int> word(Tag tag, std::size_t index = 0) const {
    const Element* e = set_.find(tag);
    if (!e || e->value.size() < 2 * (index + 1)) return std::nullopt;
    return static_cast<int>(wordAt(e->value, 2 * index, 2, set_.coding().bigEndian));
  }
  /// Decimal strings, separated by backslashes; empty when any of them is no number.
  std::vector<double> numbers(Tag tag) const {
    std::vector<double> all;
    const auto words = text(tag);
    for (std::size_t at = 0; words && at <= words->size();) {
      const std::size_t end = std::min(words->find('\\', at), words->size());
      std::size_t from = at, to = end;
      while (from < to && ((*words)[from] == ' ' || (*words)[from] == '+')) ++from;
      while (to > from && (*words)[to - 1] == ' ') --to;
      double value = 0;
      const auto [p, error] = std::from_chars(words->data() + from, words->data() + to, value);
      if (error != std::errc() || p != words->data() + to || !std::isfinite(value)) return {};
      all.push_back(value);
      at = end + 1;
    }
    return all;
  }
  std::optional<double> number(Tag tag) const {
    const std::vector<double> all = numbers(tag);
    return all.empty() ? std::nullopt : std::optional(all[0]);
  }

 private:
  const DataSet& set_;
};

/// SOP class (0008,0016), PS3.4 B.5.
std::string kindOf(const Attributes& a) {
  const std::string uid = a.text(0x00080016).value_or("");
  const std::string base = "1.2.840.10008.5.1.4.1.1.";
  if (uid == base + "12.1" || uid == base + "12.1.1") return "DICOM XA";
  if (uid == base + "12.2" || uid == base + "12.2.1") return "DICOM RF";
  if (uid == base + "7" || uid.starts_with(base + "7.")) return "DICOM secondary capture";
  if (uid.starts_with(base + "77.1.")) return "DICOM video";
  return "DICOM";
}

BurnedIn burnedIn(const Attributes& a) {
  const std::string word = a.text(0x00280301).value_or("");
  return word == "NO" ? BurnedIn::no : word == "YES" ? BurnedIn::yes : BurnedIn::unknown;
}

/// The order of PS3.3 C.7.6.5 and C.7.6.6: the Frame Increment Pointer's target, then the
/// recommended rate, then the cine rate. Nothing is assumed.
Result<void> readTimes(const Attributes& a, double given_hz, DicomHeader& h) {
  constexpr Tag frameTime = 0x00181063, vector = 0x00181065, recommended = 0x00082144,
                cine = 0x00180040, pointer = 0x00280009;
  const auto even = [&](double step_s, const char* source) -> Result<void> {
    if (!(step_s > 0 && step_s <= kLongestFrame_s))
      return refuse(fmt::format("{} makes frames of {} s, more than 0 and at most {} expected",
                                source, step_s, kLongestFrame_s),
                    "Give the true rate with --frame-rate.");
    for (int k = 0; k < h.frames; ++k) h.time_s.push_back(k * step_s);
    h.timing = source;
    return {};
  };
  if (given_hz > 0) return even(1 / given_hz, "--frame-rate");
  for (std::size_t i = 0; i + 1 < 16; i += 2) {  // pairs of group and element
    const auto group = a.word(pointer, i), element = a.word(pointer, i + 1);
    if (!group || !element) break;
    const Tag target = static_cast<Tag>(*group) << 16 | static_cast<Tag>(*element);
    if (target == frameTime) {
      const auto step_ms = a.number(frameTime);
      if (!step_ms)
        return refuse("its Frame Increment Pointer names Frame Time (0018,1063), which is absent",
                      "Give the true rate with --frame-rate.");
      return even(*step_ms * 1e-3, "Frame Time");
    }
    if (target == vector) {
      const std::vector<double> steps_ms = a.numbers(vector);
      if (static_cast<int>(steps_ms.size()) != h.frames)
        return refuse(fmt::format("Frame Time Vector (0018,1065) has {} times for {} frames",
                                  steps_ms.size(), h.frames),
                      "Give the true rate with --frame-rate.");
      double t_s = 0;
      for (std::size_t k = 0; k < steps_ms.size(); ++k) {
        if (k > 0 && !(steps_ms[k] > 0 && steps_ms[k] <= kLongestFrame_s * 1e3))
          return refuse(fmt::format("Frame Time Vector (0018,1065) steps by {} ms to frame {}",
                                    steps_ms[k], k),
                        "Give the true rate with --frame-rate.");
        if (k > 0) t_s += steps_ms[k] * 1e-3;
        h.time_s.push_back(t_s);
      }
      h.timing = "Frame Time Vector";
      return {};
    }
  }
  if (const auto rate = a.number(recommended)) {
    h.warnings.push_back("no frame times: Recommended Display Frame Rate (0008,2144) taken");
    return even(1 / *rate, "Recommended Display Frame Rate");
  }
  if (const auto rate = a.number(cine)) {
    h.warnings.push_back("no frame times: Cine Rate (0018,0040) taken");
    return even(1 / *rate, "Cine Rate");
  }
  return refuse("says neither frame times nor a rate", "Give its rate with --frame-rate.");
}

Result<void> readPixels(const Attributes& a, DicomHeader& h) {
  h.rows = a.word(0x00280010).value_or(0);
  h.columns = a.word(0x00280011).value_or(0);
  h.samples = a.word(0x00280002).value_or(1);
  h.bitsAllocated = a.word(0x00280100).value_or(0);
  h.bitsStored = a.word(0x00280101).value_or(h.bitsAllocated);
  h.planarConfiguration = a.word(0x00280006).value_or(0);
  h.isSigned = a.word(0x00280103).value_or(0) == 1;
  h.photometric = a.text(0x00280004).value_or("");
  const double frames = a.number(0x00280008).value_or(1);
  const char* again = "Export it from the archive again.";
  if (h.rows < 1 || h.columns < 1 || h.rows > kLongestSide || h.columns > kLongestSide)
    return refuse(
        fmt::format("is {} x {} pixels, 1 to {} a side expected", h.columns, h.rows, kLongestSide),
        "Name an XA, RF or secondary capture object with pixels.");
  if (!(frames >= 1 && frames <= kMaxFrames && frames == std::floor(frames)))
    return refuse(fmt::format("says that it holds {} frames, 1 to {} expected", frames, kMaxFrames),
                  again);
  h.frames = static_cast<int>(frames);
  if (h.frames < 2) return refuse("is a still picture, not a video", "Name a multi-frame object.");
  const std::array<std::string, 7> known{"MONOCHROME1",  "MONOCHROME2", "RGB",    "YBR_FULL",
                                         "YBR_FULL_422", "YBR_RCT",     "YBR_ICT"};
  const bool video = h.photometric == "YBR_PARTIAL_420";  // MPEG: libav converts
  if (!video && std::ranges::find(known, h.photometric) == known.end())
    return refuse("has an unknown photometric interpretation (0028,0004)",
                  "MONOCHROME1, MONOCHROME2, RGB and YBR are read; convert it.");
  const bool grey = h.photometric.starts_with("MONOCHROME");
  if (h.samples != (grey ? 1 : 3) || (h.bitsAllocated != 8 && !(grey && h.bitsAllocated == 16)) ||
      h.bitsStored < 1 || h.bitsStored > h.bitsAllocated || h.planarConfiguration > 1)
    return refuse(fmt::format("has {} samples of {} bits ({} stored) per pixel", h.samples,
                              h.bitsAllocated, h.bitsStored),
                  "Grey of 8 or 16 bits and colour of 8 bits are read.");
  if (const auto aspect = a.numbers(0x00280034); aspect.size() == 2 && aspect[1] > 0) {
    h.pixelAspect = aspect[0] / aspect[1];
    if (!(h.pixelAspect > 0.25 && h.pixelAspect < 4))
      return refuse(fmt::format("pixel aspect {}, 1/4 to 4 expected", h.pixelAspect), again);
  }
  return {};
}

/// Attributes of the whole object, or of the functional groups that all frames share.
void readDisplay(const DataSet& set, DicomHeader& h) {
  const auto shared = set.item(0x52009229);
  const auto group = [&](Tag tag) { return shared ? shared->item(tag) : std::nullopt; };
  const auto voi = group(0x00289132), rescale = group(0x00289145);
  const Attributes window(voi ? *voi : set), modality(rescale ? *rescale : set);
  h.windowCentre = window.number(0x00281050);
  h.windowWidth = window.number(0x00281051);
  h.slope = modality.number(0x00281053).value_or(1);
  h.intercept = modality.number(0x00281052).value_or(0);
  if (!h.windowCentre || !h.windowWidth || *h.windowWidth < 1) {
    h.windowCentre.reset();
    h.windowWidth.reset();
    if (set.find(0x00283010))
      h.warnings.push_back("its VOI LUT (0028,3010) is not applied: full range shown");
  }
  if (h.slope == 0) h.slope = 1;
}
}  // namespace

Result<DicomHeader> readHeader(const DataSet& set, double frameRate_hz) {
  const Attributes a(set);
  DicomHeader h;
  h.kind = kindOf(a);
  h.burnedIn = burnedIn(a);
  if (auto read = readPixels(a, h); !read) return std::unexpected(read.error());
  if (auto read = readTimes(a, frameRate_hz, h); !read) return std::unexpected(read.error());
  readDisplay(set, h);
  return h;
}
}  // namespace swallowclip::study
