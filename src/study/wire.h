// SPDX-License-Identifier: MIT
// Values as bytes between a decoder's process and ours, and back with every length checked: what
// comes from a decoder that a hostile file has taken over is hostile too. Private to this room.
#pragma once
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace swallowclip::study {

class WireWriter {
 public:
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void put(const T& value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof value); }
  void put(const std::string& text) {
    put(static_cast<std::uint64_t>(text.size()));
    bytes_ += text;
  }
  template <class T>
  void put(const std::vector<T>& list) {
    put(static_cast<std::uint64_t>(list.size()));
    for (const T& item : list) put(item);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class WireReader {
 public:
  explicit WireReader(const std::string& bytes) : bytes_(bytes) {}
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void get(T& value) {
    if (!has(sizeof value)) return;
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
  }
  void get(std::string& text) {
    std::uint64_t size = 0;
    get(size);
    if (!has(size)) return;
    text.assign(bytes_, at_, size);
    at_ += size;
  }
  template <class T>
  void get(std::vector<T>& list) {
    std::uint64_t size = 0;
    get(size);
    if (!has(size)) return;  // an item takes at least a byte
    list.resize(size);
    for (T& item : list) get(item);
  }
  /// Everything was there and nothing is left over.
  bool complete() const { return good_ && at_ == bytes_.size(); }

 private:
  bool has(std::uint64_t count) {
    good_ = good_ && count <= bytes_.size() - at_;
    return good_;
  }
  const std::string& bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
};
}  // namespace swallowclip::study
