// SPDX-License-Identifier: MIT
#include <sys/stat.h>

#include <fstream>

#include "core/digest.h"
#include "core/file.h"
#include "library/store.h"

namespace swallowclip::library {
namespace fs = std::filesystem;

// One line per file: hash, size, times, inode, path. What is damaged fits no file any more.
Stamps::Stamps(fs::path file) : file_(std::move(file)) {
  std::ifstream lines(file_);
  for (Stamp s; lines >> s.sha256 >> s.bytes >> s.modified_ns >> s.changed_ns >> s.inode;) {
    std::string path;
    lines.ignore(1);
    std::getline(lines, path);
    stamps_[path] = s;
  }
}

std::optional<Stamps::Stamp> Stamps::look(const fs::path& file) {
  struct stat s {};
  if (::lstat(file.c_str(), &s) != 0 || !S_ISREG(s.st_mode)) return std::nullopt;
  const auto ns = [](const timespec& t) { return t.tv_sec * 1'000'000'000 + t.tv_nsec; };
  return Stamp{static_cast<std::uintmax_t>(s.st_size), ns(s.st_mtim), ns(s.st_ctim), s.st_ino, ""};
}

bool Stamps::holds(const fs::path& file, const StoredFile& expected) {
  const auto now = look(file);
  if (!now || now->bytes != expected.bytes) return false;
  const auto known = stamps_.find(file.string());
  if (known == stamps_.end() || known->second.sha256 != expected.sha256 ||
      known->second.bytes != now->bytes || known->second.modified_ns != now->modified_ns ||
      known->second.changed_ns != now->changed_ns || known->second.inode != now->inode)
    return reads(file, expected);
  seen_[file.string()] = known->second;
  return true;
}

bool Stamps::reads(const fs::path& file, const StoredFile& expected) {
  const auto before = look(file);
  if (!before || before->bytes != expected.bytes) return false;
  const auto bytes = readFile(file);
  if (!bytes || sha256Hex(*bytes) != expected.sha256) return false;
  Stamp& s = seen_[file.string()] = *before;
  s.sha256 = expected.sha256;
  return true;
}

void Stamps::refresh() {
  for (auto& [path, stamp] : seen_)
    if (const auto now = look(path);
        now && now->modified_ns == stamp.modified_ns && now->inode == stamp.inode)
      stamp.changed_ns = now->changed_ns;
}

void Stamps::moved(const fs::path& from, const fs::path& to) {
  const std::string prefix = from.string() + "/";
  for (auto at = seen_.lower_bound(prefix); at != seen_.end() && at->first.starts_with(prefix);) {
    seen_[to.string() + "/" + at->first.substr(prefix.size())] = at->second;
    at = seen_.erase(at);
  }
}

Result<void> Stamps::save() const {
  std::string text;
  for (const auto& [path, s] : seen_)
    text += fmt::format("{} {} {} {} {} {}\n", s.sha256, s.bytes, s.modified_ns, s.changed_ns,
                        s.inode, path);
  return writeFile(file_, text);
}
}  // namespace swallowclip::library
