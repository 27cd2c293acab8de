// SPDX-License-Identifier: MIT
// The data elements of a DICOM file (PS3.5 section 7, PS3.10 section 7). GDCM 3.0.21 clears room
// for every length that a file claims and ends its process on many damaged files, so the structure
// is read here, each length checked against what holds it, and GDCM decompresses only.
// Private to this room.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "study/study.h"

namespace swallowclip::study {

/// Group in the upper half, element in the lower.
using Tag = std::uint32_t;

struct Element {
  std::string_view value;  ///< between the element's header and its end or delimiter
  bool openEnded = false;  ///< a sequence, or pixels in fragments, of undefined length
  bool unknown = false;    ///< UN: its items are implicit little-endian (PS3.5 6.2.2)
  bool words = false;      ///< OW: swapped in pairs of bytes when big-endian
};

/// How elements are written: decided by the transfer syntax.
struct ElementCoding {
  bool explicitVr = true, bigEndian = false;
};

class DataSet {
 public:
  /// The elements of one level, up to the pixels (what follows them is of no use here). `bytes`
  /// must outlive the result.
  static Result<DataSet> parse(std::string_view bytes, ElementCoding coding);
  const Element* find(Tag tag) const;
  ElementCoding coding() const { return coding_; }
  /// The first item of a sequence; nothing when there is none or it is damaged.
  std::optional<DataSet> item(Tag tag) const;

 private:
  ElementCoding coding_;
  std::map<Tag, Element> elements_;
};

struct DicomFile {
  std::string transferSyntax;  ///< UID
  std::string_view set;        ///< what follows the file's meta information
  ElementCoding coding;        ///< of `set`
};
Result<DicomFile> parseMeta(std::string_view bytes);

/// The items of encapsulated pixels (PS3.5 A.4): offset table, then fragments.
Result<std::vector<std::string_view>> fragmentsOf(const Element& pixels);

/// `count` bytes as a number.
std::uint32_t wordAt(std::string_view bytes, std::size_t at, std::size_t count,
                     bool bigEndian = false);
}  // namespace swallowclip::study
