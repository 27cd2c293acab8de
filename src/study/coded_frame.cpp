// SPDX-License-Identifier: MIT
#include "study/coded_frame.h"

#include <algorithm>

namespace swallowclip::study {
namespace {
std::unexpected<Error> damaged(int frame, const std::string& what) {
  return refuse(fmt::format("frame {} {}", frame, what),
                "It is cut off or damaged: export it again.");
}

/// PackBits runs into every `step`th byte of `to`.
bool unpack(std::string_view runs, char* to, std::size_t count, std::size_t step) {
  for (std::size_t at = 0; count > 0;) {
    if (at >= runs.size()) return false;
    const int n = static_cast<signed char>(runs[at++]);
    if (n == -128) continue;
    const bool literal = n >= 0;
    const auto length = static_cast<std::size_t>(literal ? n + 1 : 1 - n);
    if (length > count || runs.size() - at < (literal ? length : 1)) return false;
    for (std::size_t i = 0; i < length; ++i, to += step) *to = runs[literal ? at + i : at];
    at += literal ? length : 1;
    count -= length;
  }
  return true;
}

Result<void> agree(std::uint32_t columns, std::uint32_t rows, int samples, int bits,
                   const DicomHeader& h, int frame) {
  if (columns == static_cast<std::uint32_t>(h.columns) &&
      rows == static_cast<std::uint32_t>(h.rows) && samples == h.samples && bits >= 2 &&
      bits <= h.bitsAllocated)
    return {};
  return damaged(frame, fmt::format("says that it is {} x {} with {} samples of {} bits, {} x {} "
                                    "with {} of at most {} expected",
                                    columns, rows, samples, bits, h.columns, h.rows, h.samples,
                                    h.bitsAllocated));
}
}  // namespace

Result<std::string> decodeRle(std::string_view coded, const DicomHeader& h, int frame) {
  constexpr std::size_t kTable = 64;  // count and 15 offsets of 4 bytes
  const auto bytes = static_cast<std::size_t>(h.bitsAllocated / 8);  // of a sample
  const std::size_t segments = bytes * h.samples, pixels = h.frameValues() / h.samples;
  if (coded.size() < kTable || wordAt(coded, 0, 4) != segments)
    return damaged(frame, fmt::format("has no table of {} RLE segments", segments));
  std::string values(pixels * segments, '\0');
  for (std::size_t s = 0; s < segments; ++s) {
    const std::size_t begin = wordAt(coded, 4 + 4 * s, 4);
    const std::size_t end = s + 1 < segments ? wordAt(coded, 8 + 4 * s, 4) : coded.size();
    if (begin < kTable || begin > end || end > coded.size())
      return damaged(frame, fmt::format("has RLE segment {} from byte {} to {} of {}", s, begin,
                                        end, coded.size()));
    const std::size_t sample = s / bytes, byte = bytes - 1 - s % bytes;  // the highest byte first
    const bool planes = h.planarConfiguration == 1;
    char* const to = values.data() + byte + bytes * sample * (planes ? pixels : 1);
    if (!unpack(coded.substr(begin, end - begin), to, pixels, planes ? bytes : segments))
      return damaged(frame,
                     fmt::format("has RLE segment {} that does not fill its {} pixels", s, pixels));
  }
  return values;
}

Result<void> checkJpeg(std::string_view coded, const DicomHeader& h, int frame) {
  const auto word = [&](std::size_t at) {
    return at + 2 <= coded.size() ? wordAt(coded, at, 2, true) : 0;
  };
  std::size_t at = 2;
  if (word(0) != 0xffd8) return damaged(frame, "is no JPEG picture");
  while (at + 10 <= coded.size() && static_cast<std::uint8_t>(coded[at]) == 0xff) {
    const std::uint32_t marker = word(at) & 0xff;
    if (marker == 0xff) {  // fill
      ++at;
      continue;
    }
    const bool other = marker == 0xc4 || marker == 0xc8 || marker == 0xcc;  // tables
    if (marker == 0xf7 || (marker >= 0xc0 && marker <= 0xcf && !other))
      return agree(word(at + 7), word(at + 5), static_cast<std::uint8_t>(coded[at + 9]),
                   static_cast<std::uint8_t>(coded[at + 4]), h, frame);
    if (marker == 0xda) break;
    at += 2 + word(at + 2);
  }
  return damaged(frame, "has no JPEG frame header");
}

Result<void> checkJpeg2000(std::string_view coded, const DicomHeader& h, int frame) {
  constexpr std::size_t kFixed = 42;  // SOC and SIZ up to the components
  const std::size_t samples = coded.size() < kFixed ? 0 : wordAt(coded, 40, 2, true);
  if (samples < 1 || coded.size() < kFixed + 3 * samples ||
      wordAt(coded, 0, 4, true) != 0xff4fff51 || wordAt(coded, 4, 2, true) != 38 + 3 * samples)
    return damaged(frame, "is no JPEG 2000 picture");
  const auto word = [&](std::size_t at) { return wordAt(coded, at, 4, true); };
  int bits = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    const int depth = (static_cast<std::uint8_t>(coded[kFixed + 3 * i]) & 0x7f) + 1;
    if (wordAt(coded, kFixed + 3 * i + 1, 2, true) != 0x0101 || (i > 0 && depth != bits))
      return damaged(frame, "has samples of several sizes");
    bits = depth;
  }
  return agree(word(8) - word(16), word(12) - word(20), static_cast<int>(samples), bits, h, frame);
}
}  // namespace swallowclip::study
