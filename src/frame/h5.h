// SPDX-License-Identifier: MIT
// The only door to HDF5 (C API), private to this room. Both classes keep the first error and turn
// later calls into nothing, so that callers read as a plain list of what a file holds.
#pragma once
#include <hdf5.h>

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"

namespace swallowclip::frame::h5 {

using Shape = std::vector<hsize_t>;
inline constexpr hsize_t kAny = ~static_cast<hsize_t>(0);

/// Closes what it owns; works for every kind of HDF5 identifier.
class Handle {
 public:
  explicit Handle(hid_t id = -1) : id_(id) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Handle() { close(); }
  bool valid() const { return id_ >= 0; }
  bool close() { return id_ < 0 || H5Idec_ref(std::exchange(id_, -1)) >= 0; }
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
};

/// One thread at a time in the library, and no printing of its own while inside.
class Quiet {
 public:
  Quiet();
  ~Quiet();

 private:
  std::unique_lock<std::recursive_mutex> lock_;
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

template <class T>
hid_t memoryType();
template <>
inline hid_t memoryType<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
inline hid_t memoryType<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
inline hid_t memoryType<std::int32_t>() {
  return H5T_NATIVE_INT32;
}
template <>
inline hid_t memoryType<std::uint8_t>() {
  return H5T_NATIVE_UINT8;
}

/// Builds a file in memory: little-endian, chunked (along the first axis), shuffled, deflated and
/// checksummed data sets without times, so that the same values give the same bytes. Nothing
/// touches a disk here, because HDF5 1.10 can't close a file that did not fit on one.
class Writer {
 public:
  Writer();
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  void group(const std::string& path);
  template <class T>
  void data(const std::string& path, const Shape& shape, const std::vector<T>& values) {
    write(path, shape, values.data(), values.size(), memoryType<T>());
  }
  void text(const std::string& owner, const std::string& name, const std::string& value);
  void number(const std::string& owner, const std::string& name, double value);
  void whole(const std::string& owner, const std::string& name, int value);
  /// The bytes of the finished file, or what went wrong.
  std::expected<std::string, std::string> finish();

 private:
  void write(const std::string& path, const Shape& shape, const void* values, std::size_t count,
             hid_t type);
  void attribute(const std::string& owner, const std::string& name, hid_t fileType, hid_t type,
                 const void* value);
  void fail(const std::string& what);

  Quiet quiet_;
  std::string fault_;
  std::vector<unsigned char> memory_;  ///< HDF5 keeps the file here
  Handle file_;                        ///< closed before its memory goes
};

/// Reads data sets of a stated shape (kAny = free) and never trusts what the file says of itself.
class Reader {
 public:
  explicit Reader(const std::string& path);
  /// Fills `out` and returns the shape found (empty after an error).
  template <class T>
  Shape data(const std::string& path, const Shape& expected, std::vector<T>& out) {
    Handle set;
    const Shape shape = open(path, expected, memoryType<T>(), set);
    if (shape.empty()) return {};
    hsize_t count = 1;
    for (hsize_t n : shape) count *= n;
    out.resize(count);
    if (count > 0) fill(path, set, memoryType<T>(), out.data());
    return fine() ? shape : Shape{};
  }
  std::string text(const std::string& owner, const std::string& name);
  double number(const std::string& owner, const std::string& name);
  /// The same for a number that older files lack.
  double number(const std::string& owner, const std::string& name, double absent);
  int whole(const std::string& owner, const std::string& name);

  /// Whether a data set is there that need not be.
  bool has(const std::string& path) { return fine() && linked(path); }
  bool fine() const { return !error_; }
  void fail(const std::string& place, const std::string& problem);
  Error error() const { return *error_; }

 private:
  void openFile();
  Shape open(const std::string& path, const Shape& expected, hid_t type, Handle& set);
  void fill(const std::string& path, const Handle& set, hid_t type, void* out);
  Handle openAttribute(const std::string& owner, const std::string& name, H5T_class_t kind);
  bool linked(const std::string& path);

  Quiet quiet_;
  std::string path_;
  Handle file_;
  hsize_t bytesRead_ = 0;
  std::optional<Error> error_;
};
}  // namespace swallowclip::frame::h5
