// SPDX-License-Identifier: MIT
#include "study/dicom_elements.h"

#include <algorithm>
#include <array>

namespace swallowclip::study {
namespace {
constexpr std::uint32_t kUndefined = 0xffffffff;
constexpr Tag kItem = 0xfffee000, kItemEnd = 0xfffee00d, kSequenceEnd = 0xfffee0dd;
constexpr Tag kPixelData = 0x7fe00010;
constexpr int kDeepest = 16;  // sequences within sequences; assumed, range 8 to 64

/// Steps through the elements of a level; the places it names count from the level's start.
class Walker {
 public:
  Walker(std::string_view bytes, ElementCoding coding) : bytes_(bytes), coding_(coding) {}

  bool atEnd() const { return at_ >= bytes_.size(); }
  std::size_t at() const { return at_; }
  /// The tag that comes next; 0 when fewer bytes than a tag and a length are left.
  Tag peek() const { return bytes_.size() - at_ < 8 ? 0 : word(at_, 2) << 16 | word(at_ + 2, 2); }

  /// What the item that comes next holds, and perhaps more behind its delimiter.
  std::optional<std::string_view> item() const {
    if (peek() != kItem) return std::nullopt;
    const std::uint32_t length = word(at_ + 4, 4);
    return bytes_.substr(at_ + 8, length == kUndefined ? std::string_view::npos : length);
  }

  /// Reads an element whole. `depth`: of the sequences around it.
  Result<std::pair<Tag, Element>> next(int depth) {
    tag_ = peek();
    if (tag_ == 0) return damaged("ends where an element is expected");
    Element e;
    std::uint64_t length = 0;
    if (const bool delimiter = tag_ >> 16 == 0xfffe; delimiter || !coding_.explicitVr) {
      length = word(at_ + 4, 4);
      at_ += 8;
    } else {
      const std::string_view vr = bytes_.substr(at_ + 4, 2);
      if (!std::ranges::all_of(vr, [](char c) { return c >= 'A' && c <= 'Z'; }))
        return damaged(name() + " has no value representation");
      static constexpr std::array<std::string_view, 13> kLong{
          "OB", "OD", "OF", "OL", "OV", "OW", "SQ", "SV", "UC", "UN", "UR", "UT", "UV"};
      const bool isLong = std::ranges::find(kLong, vr) != kLong.end();
      if (isLong && bytes_.size() - at_ < 12) return damaged(name() + " is cut off");
      length = isLong ? word(at_ + 8, 4) : word(at_ + 6, 2);
      at_ += isLong ? 12 : 8;
      e.words = vr == "OW";
      e.unknown = vr == "UN";
    }
    const std::size_t begin = at_;
    if (length == kUndefined) {
      e.openEnded = true;
      Walker inside(bytes_.substr(at_), e.unknown ? ElementCoding{false, false} : coding_);
      if (auto skipped = inside.skipItems(tag_ == kPixelData, depth); !skipped)
        return std::unexpected(skipped.error());
      at_ += inside.at_;
      e.value = bytes_.substr(begin, at_ - begin - 8);
      return std::pair{tag_, e};
    }
    if (length > bytes_.size() - at_)
      return damaged(
          tag_ == kPixelData
              ? fmt::format("ends before its pixels do: {} bytes told, {} there", length,
                            bytes_.size() - at_)
              : fmt::format("{} tells {} bytes, {} are left", name(), length, bytes_.size() - at_));
    e.value = bytes_.substr(begin, length);
    at_ += length;
    return std::pair{tag_, e};
  }

  /// To behind the delimiter of a sequence. Items of undefined length hold elements, except among
  /// pixels, where there are none.
  Result<void> skipItems(bool pixels, int depth) {
    if (depth >= kDeepest)
      return damaged(fmt::format("has more than {} nested sequences", kDeepest));
    for (;;) {
      tag_ = peek();
      if (tag_ == 0)
        return damaged(pixels ? "ends before its pixels do" : "ends within a sequence");
      const std::uint32_t length = word(at_ + 4, 4);
      at_ += 8;
      if (tag_ == kSequenceEnd) return {};
      if (tag_ != kItem)
        return damaged(fmt::format("{} where an item {} is expected", name(),
                                   pixels ? "of compressed pixels" : "of a sequence"));
      if (length != kUndefined) {
        if (length > bytes_.size() - at_)
          return damaged(
              fmt::format("{}: an item tells {} bytes, {} are left",
                          pixels ? "ends before its pixels do" : "ends within a sequence", length,
                          bytes_.size() - at_));
        at_ += length;
        continue;
      }
      if (pixels) return damaged("its compressed pixels have an item of undefined length");
      while (peek() != kItemEnd)
        if (auto element = next(depth + 1); !element) return std::unexpected(element.error());
      at_ += 8;
    }
  }

 private:
  std::uint32_t word(std::size_t at, std::size_t count) const {
    return wordAt(bytes_, at, count, coding_.bigEndian);
  }
  std::string name() const {
    return fmt::format("element ({:04x},{:04x})", tag_ >> 16, tag_ & 0xffff);
  }
  static std::unexpected<Error> damaged(const std::string& what) {
    return refuse(what, "It is cut off or damaged: export it again.");
  }

  std::string_view bytes_;
  ElementCoding coding_;
  std::size_t at_ = 0;
  Tag tag_ = 0;
};
}  // namespace

std::uint32_t wordAt(std::string_view bytes, std::size_t at, std::size_t count, bool bigEndian) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i)
    value |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(bytes[at + i]))
             << 8 * (bigEndian ? count - 1 - i : i);
  return value;
}

Result<DataSet> DataSet::parse(std::string_view bytes, ElementCoding coding) {
  DataSet set;
  set.coding_ = coding;
  Walker walker(bytes, coding);
  while (!walker.atEnd() && walker.peek() != kItemEnd) {
    auto element = walker.next(0);
    if (!element) return std::unexpected(element.error());
    set.elements_.insert(*element);
    if (element->first == kPixelData) break;
  }
  return set;
}

const Element* DataSet::find(Tag tag) const {
  const auto found = elements_.find(tag);
  return found == elements_.end() ? nullptr : &found->second;
}

std::optional<DataSet> DataSet::item(Tag tag) const {
  const Element* e = find(tag);
  if (!e) return std::nullopt;
  const ElementCoding coding = e->unknown ? ElementCoding{false, false} : coding_;
  const auto content = Walker(e->value, coding).item();
  auto set = content ? parse(*content, coding) : Result<DataSet>();
  return content && set ? std::optional(*set) : std::nullopt;
}

Result<DicomFile> parseMeta(std::string_view bytes) {
  constexpr std::size_t kPreamble = 132;
  const bool modern = bytes.size() >= kPreamble && bytes.substr(kPreamble - 4, 4) == "DICM";
  if (modern) bytes.remove_prefix(kPreamble);
  DicomFile file;
  Walker meta(bytes, {});
  while (meta.peek() >> 16 == 2) {
    auto element = meta.next(0);
    if (!element) return std::unexpected(element.error());
    if (element->first == 0x00020010) file.transferSyntax = element->second.value;
  }
  while (file.transferSyntax.ends_with('\0') || file.transferSyntax.ends_with(' '))
    file.transferSyntax.pop_back();
  file.set = bytes.substr(meta.at());
  if (file.set.size() < 8) return refuse("is no whole DICOM file", "Export it again.");
  const char* implicit = "1.2.840.10008.1.2";
  const char* plain = "1.2.840.10008.1.2.1";
  if (file.transferSyntax.empty() && modern)
    return refuse("tells no transfer syntax (0002,0010)",
                  "It is encrypted or damaged: decrypt it, or export it again.");
  if (file.transferSyntax.empty())  // an object of before 1993: a representation tells itself
    file.transferSyntax = file.set[4] >= 'A' && file.set[5] >= 'A' ? plain : implicit;
  file.coding = {file.transferSyntax != implicit, file.transferSyntax == "1.2.840.10008.1.2.2"};
  return file;
}

Result<std::vector<std::string_view>> fragmentsOf(const Element& pixels) {
  if (!pixels.openEnded)
    return refuse("its compressed pixels are not in fragments", "Export it again.");
  std::vector<std::string_view> items;  // lengths were checked when the element was read
  for (std::size_t at = 0; at + 8 <= pixels.value.size();) {
    const std::uint32_t length = wordAt(pixels.value, at + 4, 4);
    items.push_back(pixels.value.substr(at + 8, length));
    at += 8 + std::size_t{length};
  }
  if (items.empty()) return refuse("its compressed pixels are missing", "Export it again.");
  return items;
}
}  // namespace swallowclip::study
