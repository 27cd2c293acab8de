// SPDX-License-Identifier: MIT
#include "library/store.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <set>

#include "core/digest.h"
#include "core/file.h"
#include "library/sealed.h"
#include "scene/json_text.h"

namespace swallowclip::library {
namespace fs = std::filesystem;

const StoredFile* Marker::file(const std::string& fileName) const {
  for (const StoredFile& f : files)
    if (f.name == fileName) return &f;
  return nullptr;
}

std::string markerText(const Marker& m) {
  std::string files;
  for (const StoredFile& f : m.files)
    files += fmt::format("{}\n  {{\"name\": {}, \"bytes\": {}, \"sha256\": \"{}\"}}",
                         files.empty() ? "" : ",", scene::quotedJson(f.name), f.bytes, f.sha256);
  return sealed(
      fmt::format("\"key\": \"{}\", \"stage\": \"{}\", \"name\": {},\n\"files\": [{}],\n"
                  "\"cpu_s\": {:.3f}, \"wall_s\": {:.3f}, \"peak_MB\": {:.1f},\n"
                  "\"host\": {}, \"processor\": {}",
                  m.key, m.stage, scene::quotedJson(m.name), files, m.cpu_s, m.wall_s, m.peak_MB,
                  scene::quotedJson(m.host), scene::quotedJson(m.processor)));
}

Result<Marker> readMarker(const fs::path& path) {
  auto file = readSealed(path);
  if (!file) return std::unexpected(file.error());
  const scene::JsonNode root = file->root();
  Marker m;
  m.key = root.text("key");
  m.stage = root.text("stage");
  m.name = root.text("name");
  for (const auto& node : root.array("files")) {
    StoredFile f{node.text("name"), static_cast<std::uintmax_t>(node.number("bytes", 0, 1e15)),
                 node.text("sha256")};
    if (f.name.empty() || f.name.find('/') != std::string::npos)
      node.fail("not the name of a file", "Let it be made anew.");
    m.files.push_back(std::move(f));
  }
  m.cpu_s = root.number("cpu_s", 0, 1e9);
  m.wall_s = root.number("wall_s", 0, 1e9);
  m.peak_MB = root.number("peak_MB", 0, 1e9);
  m.host = root.text("host");
  m.processor = root.text("processor");
  if (auto done = file->finish(); !done) return std::unexpected(done.error());
  return m;
}

Store::State Store::check(const std::string& key, bool repair) {
  const fs::path folder = root_.product(key);
  std::error_code ec;
  if (!fs::exists(fs::symlink_status(folder, ec))) return {{}, "not made yet"};
  std::string why;
  auto marker = readMarker(folder / "done.json");
  if (!marker)
    why = "done.json is missing or damaged";
  else if (marker->key != key)
    why = "done.json is of another product";
  else
    for (const StoredFile& f : marker->files)
      if (!stamps_.holds(folder / f.name, f)) {
        why = f.name + " is missing or damaged";
        break;
      }
  if (why.empty()) return {std::move(*marker), ""};
  if (repair) fs::remove_all(folder, ec);
  return {{}, why};
}

int Store::prune(const std::vector<std::string>& wanted, double most_gb) {
  const std::set<std::string> keep(wanted.begin(), wanted.end());
  struct Old {
    fs::file_time_type time;
    double bytes;
    fs::path folder;
  };
  std::vector<Old> old;
  std::error_code ec;
  for (const char* kind : {"jobs", "logs", "checkpoints"})
    for (const auto& entry : fs::directory_iterator(root_.run() / kind, ec))
      if (!keep.contains(entry.path().stem().string())) fs::remove(entry.path(), ec);
  for (const fs::path& folder : {root_.run(), root_.report()})  // cut off between write and rename
    for (const auto& entry : fs::directory_iterator(folder, ec))
      if (const auto name = entry.path().filename().string();
          name.starts_with('.') && name.find(".part") != std::string::npos)
        fs::remove(entry.path(), ec);
  for (const auto& shelf : fs::directory_iterator(root_.store(), ec)) {
    if (!shelf.is_directory(ec) || shelf.is_symlink(ec)) continue;
    for (const auto& product : fs::directory_iterator(shelf.path(), ec)) {
      const std::string name = product.path().filename().string();
      if (keep.contains(name)) continue;
      const auto marker = readMarker(product.path() / "done.json");
      double bytes = 0;
      if (marker && name == marker->key)
        for (const StoredFile& f : marker->files) bytes += static_cast<double>(f.bytes);
      const bool leftover = !marker || name != marker->key;
      old.push_back({leftover ? fs::file_time_type::min() : product.last_write_time(ec),
                     leftover ? 1e18 : bytes, product.path()});
    }
  }
  // Newest first; whatever goes beyond the limit is deleted, leftovers in any case.
  std::ranges::sort(old, [](const Old& a, const Old& b) { return a.time > b.time; });
  double sum = 0;
  int deleted = 0;
  for (const Old& o : old) {
    sum += o.bytes;
    if (sum <= most_gb * 1e9) continue;
    fs::remove_all(o.folder, ec);
    ++deleted;
  }
  return deleted;
}

fs::path partFolder(const Root& root, const std::string& key) {
  return root.store() / key.substr(0, 2) / fmt::format(".{}.{}.part", key, ::getpid());
}

Result<void> flush(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY);
  const bool done = fd >= 0 && ::fsync(fd) == 0;
  const std::string reason = std::strerror(errno);
  if (fd >= 0) ::close(fd);
  if (done) return {};
  return failure(path.string(), fmt::format("can't be flushed to disk ({})", reason),
                 "Check that the disk has space.");
}

Result<void> publishProduct(const Root& root, const fs::path& part, Marker marker) {
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(part, ec)) {
    auto bytes = readFile(entry.path());
    if (!bytes) return std::unexpected(bytes.error());
    if (auto done = flush(entry.path()); !done) return done;
    marker.files.push_back({entry.path().filename().string(), bytes->size(), sha256Hex(*bytes)});
  }
  std::ranges::sort(marker.files, {}, &StoredFile::name);
  if (auto done = writeFile(part / "done.json", markerText(marker)); !done) return done;
  const fs::path final = root.product(marker.key);
  if (::rename(part.c_str(), final.c_str()) != 0) {
    const int reason = errno;
    const bool there = readMarker(final / "done.json").has_value();
    fs::remove_all(part, ec);
    if (there) return {};
    return failure(final.string(),
                   fmt::format("can't be renamed into place ({})", std::strerror(reason)),
                   "`swallowclip nightly` clears damaged products away; run it.");
  }
  return flush(final.parent_path());
}
}  // namespace swallowclip::library
