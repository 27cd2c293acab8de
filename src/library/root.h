// SPDX-License-Identifier: MIT
// The folder that a library lives in:
//
//   current -> nights/n000012-20261123     what the world sees, swapped as a whole
//   nights/NAME/                           clips, manifest.json, SHA256SUMS, thumbs/
//   report/index.html                      what the last night did
//   store/ab/KEY/                          products by key, marked whole by done.json
//   run/                                   plan, job files, build.ninja, logs, trends
//   lock                                   held while a night runs
//
// Nothing outside of it is ever written, and nothing in it is deleted unless the folder carries
// our mark.
#pragma once
#include <filesystem>
#include <string>
#include <utility>

#include "core/error.h"

namespace swallowclip::library {

struct Root {
  std::filesystem::path path;  ///< absolute, without links

  std::filesystem::path store() const { return path / "store"; }
  std::filesystem::path nights() const { return path / "nights"; }
  std::filesystem::path current() const { return path / "current"; }
  std::filesystem::path report() const { return path / "report"; }
  std::filesystem::path run() const { return path / "run"; }
  std::filesystem::path jobFile(const std::string& key) const {
    return run() / "jobs" / (key + ".json");
  }
  std::filesystem::path log(const std::string& key) const {
    return run() / "logs" / (key + ".log");
  }
  std::filesystem::path product(const std::string& key) const {
    return store() / key.substr(0, 2) / key;
  }
};

/// The path as it really is. Refuses link loops, folders of others, read-only ones and folders with
/// other things in them. `create`: makes the folders that are missing.
Result<Root> openRoot(const std::filesystem::path& folder, bool create);

/// Held until destruction, or until the process and every job it has started have ended, however
/// they end: the kernel's flock, on a descriptor that children inherit.
class Lock {
 public:
  /// `wait`: until it is free; otherwise an error that names the holder.
  static Result<Lock> take(const Root& root, bool wait);
  Lock(Lock&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Lock& operator=(Lock&&) = delete;
  ~Lock();

 private:
  explicit Lock(int fd) : fd_(fd) {}
  int fd_ = -1;
};
}  // namespace swallowclip::library
