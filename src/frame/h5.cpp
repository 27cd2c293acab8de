// SPDX-License-Identifier: MIT
#include "frame/h5.h"

#include <H5PLpublic.h>

#include <algorithm>
#include <cstring>
#include <filesystem>

namespace swallowclip::frame::h5 {
namespace {
// One chunk holds whole first-axis entries (frames) up to this size, so that a viewer which steps
// through time reads little more than it shows. assumed, range 64 KiB to 1 MiB (HDF5's chunk
// cache holds 1 MiB).
constexpr hsize_t kChunkBytes = 256 * 1024;
// zlib's level; measured on skin-like data: level 9 saves under 1 % more for three times the time.
constexpr unsigned kDeflateLevel = 4;
// DEFLATE can't shrink below 1032:1 (zlib technical notes, "maximum compression factor"), so a
// declared size beyond this multiple of the stored bytes is a lie or was never written.
constexpr hsize_t kMaxDeflateRatio = 1100;
// All arrays of one file in memory; a normal swallow has about 40 MB. assumed, range 1 to 8 GiB.
constexpr hsize_t kMaxBytes = hsize_t{4} << 30;
// HDF5 keeps attributes below 64 KiB in the object header.
constexpr std::size_t kLongestText = 60000;
constexpr const char* kRemedy =
    "Simulate again to write a fresh history, or check that the copy is complete.";

std::recursive_mutex& libraryMutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

hid_t fileType(hid_t memory) {
  if (H5Tequal(memory, H5T_NATIVE_FLOAT) > 0) return H5T_IEEE_F32LE;
  if (H5Tequal(memory, H5T_NATIVE_DOUBLE) > 0) return H5T_IEEE_F64LE;
  if (H5Tequal(memory, H5T_NATIVE_INT32) > 0) return H5T_STD_I32LE;
  return H5T_STD_U8LE;
}

std::string shapeText(const Shape& shape) {
  std::string s;
  for (hsize_t n : shape) {
    if (!s.empty()) s += ",";
    s += n == kAny ? std::string("any") : std::to_string(n);
  }
  return fmt::format("[{}]", s);
}

/// n entries of `size` bytes, or kAny when the product does not fit.
hsize_t totalBytes(const Shape& shape, hsize_t size) {
  hsize_t total = size;
  for (hsize_t n : shape) {
    if (n != 0 && total > kMaxBytes / n) return kAny;
    total *= n;
  }
  return total;
}

/// No creation times, and for data: chunks, shuffle, deflate, checksum.
Handle creation(hid_t kind, const Shape& shape = {}, hsize_t size = 0) {
  Handle list(H5Pcreate(kind));
  H5Pset_obj_track_times(list, false);
  if (totalBytes(shape, size) == 0 || size == 0) return list;  // nothing to chunk
  Shape chunk = shape;
  const hsize_t entry = totalBytes(shape, size) / shape[0];
  chunk[0] = std::clamp<hsize_t>(kChunkBytes / std::max<hsize_t>(entry, 1), 1, shape[0]);
  H5Pset_chunk(list, static_cast<int>(chunk.size()), chunk.data());
  H5Pset_shuffle(list);
  H5Pset_deflate(list, kDeflateLevel);
  H5Pset_fletcher32(list);
  return list;
}

// HDF5's core driver keeps its file in a buffer of ours, so that the finished bytes (after the
// close, which still edits them) stay with us. Its own copy-out call leaves a wrong checksum.
using Buffer = std::vector<unsigned char>;
void* growBuffer(void*, std::size_t size, H5FD_file_image_op_t, void* user) {
  auto& buffer = *static_cast<Buffer*>(user);
  buffer.resize(size);
  return buffer.data();
}
void* newBuffer(std::size_t size, H5FD_file_image_op_t op, void* user) {
  return growBuffer(nullptr, size, op, user);
}
void* copyBytes(void* to, const void* from, std::size_t size, H5FD_file_image_op_t, void*) {
  return std::memcpy(to, from, size);
}
herr_t keepBuffer(void*, H5FD_file_image_op_t, void*) {
  return 0;
}
void* sameUser(void* user) {
  return user;
}
herr_t keepUser(void*) {
  return 0;
}

/// In memory; the newest format that HDF5 1.10 reads, because its metadata carry checksums.
Handle memoryAccess(Buffer& buffer) {
  Handle access(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  constexpr std::size_t kGrowth = 1 << 20;  // bytes added at a time
  H5Pset_fapl_core(access, kGrowth, false);
  H5FD_file_image_callbacks_t callbacks = {newBuffer, copyBytes, growBuffer, keepBuffer,
                                           sameUser,  keepUser,  &buffer};
  H5Pset_file_image_callbacks(access, &callbacks);
  return access;
}
}  // namespace

Quiet::Quiet() : lock_(libraryMutex()) {
  // Every file is closed here, and HDF5's own work at exit complains loudly about damaged ones.
  static const herr_t noExitWork = H5dont_atexit();
  static_cast<void>(noExitWork);
  H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  H5PLset_loading_state(0);  // a file must not make us load filter plugins
}

Quiet::~Quiet() {
  H5Eset_auto2(H5E_DEFAULT, function_, data_);
}

Writer::Writer() {
  const Handle access = memoryAccess(memory_);
  const Handle create = creation(H5P_FILE_CREATE);
  file_ = Handle(H5Fcreate("history", H5F_ACC_TRUNC, create, access));
  if (!file_.valid()) fail("the file can't be begun in memory");
}

void Writer::fail(const std::string& what) {
  if (fault_.empty()) fault_ = what;
}

void Writer::group(const std::string& path) {
  if (!fault_.empty()) return;
  const Handle create = creation(H5P_GROUP_CREATE);
  const Handle made(H5Gcreate2(file_, path.c_str(), H5P_DEFAULT, create, H5P_DEFAULT));
  if (!made.valid()) fail(fmt::format("group {} can't be made", path));
}

void Writer::write(const std::string& path, const Shape& shape, const void* values,
                   std::size_t count, hid_t type) {
  if (!fault_.empty()) return;
  const hsize_t size = H5Tget_size(type);
  CHECK_EQ(totalBytes(shape, size), count * size);
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr));
  const Handle create = creation(H5P_DATASET_CREATE, shape, size);
  const Handle set(
      H5Dcreate2(file_, path.c_str(), fileType(type), space, H5P_DEFAULT, create, H5P_DEFAULT));
  if (!set.valid() || (count > 0 && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0))
    fail(fmt::format("data set {} {} can't be stored", path, shapeText(shape)));
}

void Writer::attribute(const std::string& owner, const std::string& name, hid_t stored, hid_t type,
                       const void* value) {
  if (!fault_.empty()) return;
  const Handle object(H5Oopen(file_, owner.c_str(), H5P_DEFAULT));
  const Handle space(H5Screate(H5S_SCALAR));
  const Handle made(H5Acreate2(object, name.c_str(), stored, space, H5P_DEFAULT, H5P_DEFAULT));
  if (!made.valid() || H5Awrite(made, type, value) < 0)
    fail(fmt::format("attribute {} of {} can't be stored", name, owner));
}

void Writer::text(const std::string& owner, const std::string& name, const std::string& value) {
  if (value.size() > kLongestText || value.find('\0') != std::string::npos)
    return fail(fmt::format("attribute {} of {}: text of up to {} bytes expected", name, owner,
                            kLongestText));
  const Handle type(H5Tcopy(H5T_C_S1));
  H5Tset_size(type, value.size() + 1);
  H5Tset_cset(type, H5T_CSET_UTF8);
  attribute(owner, name, type, type, value.c_str());
}

void Writer::number(const std::string& owner, const std::string& name, double value) {
  attribute(owner, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

void Writer::whole(const std::string& owner, const std::string& name, int value) {
  attribute(owner, name, H5T_STD_I32LE, H5T_NATIVE_INT, &value);
}

std::expected<std::string, std::string> Writer::finish() {
  if (!file_.close()) fail("the file can't be completed in memory");
  // The buffer grows in steps; where the file ends in it is said by its superblock (HDF5 file
  // format 3.0, section II.A, version 2 and 3: end-of-file address, 8 bytes at offset 28).
  constexpr std::size_t kEndAt = 28;
  std::uint64_t end = 0;
  if (memory_.size() >= kEndAt + sizeof end) std::memcpy(&end, memory_.data() + kEndAt, sizeof end);
  if (end == 0 || end > memory_.size()) fail("the file can't be completed in memory");
  if (!fault_.empty()) return std::unexpected(fault_);
  return std::string(reinterpret_cast<const char*>(memory_.data()), end);
}

Reader::Reader(const std::string& path) : path_(path) {
  openFile();
}

void Reader::openFile() {
  namespace fs = std::filesystem;
  constexpr const char* kNameOne = "Name a file written by `swallowclip simulate --history`.";
  std::error_code ec;
  const auto refuse = [&](const std::string& problem, const std::string& remedy) {
    error_ = Error{ErrorKind::usage, path_, problem, remedy};
  };
  if (!fs::exists(path_, ec)) return refuse("no such file", "Check the name and the folder.");
  if (!fs::is_regular_file(path_, ec))
    return refuse("is not a file; a history (.h5) was expected", kNameOne);
  if (H5Fis_hdf5(path_.c_str()) <= 0)
    return refuse("is not readable as HDF5; a history (.h5) was expected", kNameOne);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_file_locking(access, false, true);  // read-only shares often can't lock
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  file_ = Handle(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, access));
  if (!file_.valid()) refuse("can't be opened: the file is truncated or damaged", kRemedy);
}

void Reader::fail(const std::string& place, const std::string& problem) {
  if (!error_) error_ = Error{ErrorKind::usage, path_ + ":" + place, problem, kRemedy};
}

/// True when every step of the path is a hard link; soft and external ones could lead anywhere.
bool Reader::linked(const std::string& path) {
  for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
    const std::string part = path.substr(0, end);
    H5L_info_t info;
    if (H5Lexists(file_, part.c_str(), H5P_DEFAULT) <= 0) return false;
    if (H5Lget_info(file_, part.c_str(), &info, H5P_DEFAULT) < 0) return false;
    if (info.type != H5L_TYPE_HARD) return false;
    if (end == std::string::npos) return true;
  }
}

Shape Reader::open(const std::string& path, const Shape& expected, hid_t type, Handle& set) {
  if (!fine()) return {};
  const auto refuse = [&](const std::string& problem) {
    fail(path, problem);
    return Shape{};
  };
  if (!linked(path)) return refuse("data set " + shapeText(expected) + " is missing");
  set = Handle(H5Dopen2(file_, path.c_str(), H5P_DEFAULT));
  const Handle space(set.valid() ? H5Dget_space(set) : -1);
  const Handle stored(set.valid() ? H5Dget_type(set) : -1);
  const Handle create(set.valid() ? H5Dget_create_plist(set) : -1);
  if (!set.valid() || !space.valid() || !stored.valid() || !create.valid())
    return refuse("is not a readable data set; " + shapeText(expected) + " expected");
  if (H5Tget_class(stored) != H5Tget_class(type) || H5Tget_size(stored) > 8)
    return refuse(H5Tget_class(type) == H5T_FLOAT ? "real numbers expected"
                                                  : "whole numbers expected");
  const int rank = H5Sget_simple_extent_ndims(space);
  Shape found(rank > 0 ? static_cast<std::size_t>(rank) : 0);
  if (rank > 0) H5Sget_simple_extent_dims(space, found.data(), nullptr);
  bool same = found.size() == expected.size();
  for (std::size_t i = 0; same && i < found.size(); ++i)
    same = expected[i] == kAny || expected[i] == found[i];
  if (!same)
    return refuse(fmt::format("shape is {}, {} expected", shapeText(found), shapeText(expected)));

  // A file can promise any size; believe only what its stored bytes can hold.
  const hsize_t bytes = totalBytes(found, std::max(H5Tget_size(stored), H5Tget_size(type)));
  if (bytes > kMaxBytes || (bytesRead_ += bytes) > kMaxBytes)
    return refuse(fmt::format("shape {} is too large; at most {} GiB expected in one history",
                              shapeText(found), kMaxBytes >> 30));
  const H5D_layout_t layout = H5Pget_layout(create);
  if ((layout != H5D_CHUNKED && layout != H5D_CONTIGUOUS && layout != H5D_COMPACT) ||
      H5Pget_external_count(create) > 0)
    return refuse("its values are kept in another file; expected in this one");
  if (bytes > 0 && H5Dget_storage_size(set) < bytes / kMaxDeflateRatio + 1)
    return refuse(fmt::format("shape {} promises more than is stored", shapeText(found)));
  return found;
}

void Reader::fill(const std::string& path, const Handle& set, hid_t type, void* out) {
  if (H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out) < 0)
    fail(path, "values can't be read: the file is truncated or damaged");
}

Handle Reader::openAttribute(const std::string& owner, const std::string& name, H5T_class_t kind) {
  const std::string place = owner + "@" + name;
  if (!fine()) return Handle();
  if (!linked(owner) || H5Aexists_by_name(file_, owner.c_str(), name.c_str(), H5P_DEFAULT) <= 0) {
    fail(place, "attribute is missing");
    return Handle();
  }
  Handle found(H5Aopen_by_name(file_, owner.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT));
  const Handle type(found.valid() ? H5Aget_type(found) : -1);
  const Handle space(found.valid() ? H5Aget_space(found) : -1);
  if (!type.valid() || !space.valid() || H5Tget_class(type) != kind ||
      H5Sget_simple_extent_npoints(space) != 1) {
    fail(place, kind == H5T_STRING ? "one text expected" : "one number expected");
    return Handle();
  }
  return found;
}

std::string Reader::text(const std::string& owner, const std::string& name) {
  const Handle found = openAttribute(owner, name, H5T_STRING);
  if (!found.valid()) return {};
  const Handle type(H5Aget_type(found));
  const std::size_t size = H5Tget_size(type);
  if (H5Tis_variable_str(type) != 0 || size > kLongestText + 1) {
    fail(owner + "@" + name, fmt::format("fixed text of up to {} bytes expected", kLongestText));
    return {};
  }
  std::string value(size + 1, '\0');
  if (H5Aread(found, type, value.data()) < 0) fail(owner + "@" + name, "can't be read");
  return value.c_str();  // up to the first zero
}

double Reader::number(const std::string& owner, const std::string& name) {
  double value = 0;
  const Handle found = openAttribute(owner, name, H5T_FLOAT);
  if (found.valid() && H5Aread(found, H5T_NATIVE_DOUBLE, &value) < 0)
    fail(owner + "@" + name, "can't be read");
  return value;
}

double Reader::number(const std::string& owner, const std::string& name, double absent) {
  const bool there = fine() && linked(owner) &&
                     H5Aexists_by_name(file_, owner.c_str(), name.c_str(), H5P_DEFAULT) > 0;
  return there ? number(owner, name) : absent;
}

int Reader::whole(const std::string& owner, const std::string& name) {
  int value = 0;
  const Handle found = openAttribute(owner, name, H5T_INTEGER);
  if (found.valid() && H5Aread(found, H5T_NATIVE_INT, &value) < 0)
    fail(owner + "@" + name, "can't be read");
  return value;
}
}  // namespace swallowclip::frame::h5
