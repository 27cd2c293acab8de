// SPDX-License-Identifier: MIT
// Products by key. A product is a folder that appears whole: its files are written aside, flushed,
// listed with their hashes in done.json (the last file), and the folder is renamed into place.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "library/root.h"

namespace swallowclip::library {

struct StoredFile {
  std::string name;
  std::uintmax_t bytes = 0;
  std::string sha256;
};

/// done.json: what a product consists of and what it cost.
struct Marker {
  std::string key, stage, name;
  std::vector<StoredFile> files;
  double cpu_s = 0, wall_s = 0;  ///< user and system time, elapsed time
  double peak_MB = 0;            ///< resident memory
  std::string host, processor;   ///< bytes are promised per processor vendor only

  const StoredFile* file(const std::string& fileName) const;
};

std::string markerText(const Marker& marker);
Result<Marker> readMarker(const std::filesystem::path& file);

/// Remembers which files have been hashed, by size, times and inode, so that an unchanged file is
/// hashed once. Only a saving: damaged or lost, everything is hashed again.
class Stamps {
 public:
  explicit Stamps(std::filesystem::path file);
  /// True when the file is there with this size and hash.
  bool holds(const std::filesystem::path& file, const StoredFile& expected);
  /// Reads and hashes the file whatever is remembered.
  bool reads(const std::filesystem::path& file, const StoredFile& expected);
  /// For files that were good before a link to them came or went: their change time has moved.
  void refresh();
  /// A folder of known files was renamed.
  void moved(const std::filesystem::path& from, const std::filesystem::path& to);
  Result<void> save() const;

 private:
  struct Stamp {
    std::uintmax_t bytes = 0;
    std::int64_t modified_ns = 0, changed_ns = 0;
    std::uint64_t inode = 0;
    std::string sha256;
  };
  static std::optional<Stamp> look(const std::filesystem::path& file);
  std::filesystem::path file_;
  std::map<std::string, Stamp> stamps_;
  std::map<std::string, Stamp> seen_;  ///< asked for in this run: the rest is forgotten
};

class Store {
 public:
  Store(Root root, Stamps& stamps) : root_(std::move(root)), stamps_(stamps) {}

  struct State {
    std::optional<Marker> marker;  ///< empty: to be made
    std::string why;               ///< then: "not made yet", or what is damaged
  };
  /// Is the product there, and are all its files what they were? Damaged ones are moved out.
  State check(const std::string& key, bool repair);
  /// Products that are not `wanted`, oldest first, until the rest fits `most_gb`; leftovers of
  /// jobs that were killed go always. Returns the number deleted. Only while holding the lock.
  int prune(const std::vector<std::string>& wanted, double most_gb);

 private:
  Root root_;
  Stamps& stamps_;
};

/// Where a job puts its files before they are a product.
std::filesystem::path partFolder(const Root& root, const std::string& key);
/// Hashes and flushes what is in `part`, writes done.json and renames the folder. When another
/// process was quicker its product stays: it is the same.
Result<void> publishProduct(const Root& root, const std::filesystem::path& part, Marker marker);

/// fsync of a file or folder.
Result<void> flush(const std::filesystem::path& path);
}  // namespace swallowclip::library
