// SPDX-License-Identifier: MIT
#include "library/publish.h"

#include <fmt/chrono.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <ctime>
#include <set>

#include "core/file.h"

namespace swallowclip::library {
namespace fs = std::filesystem;
namespace {
/// 12 of "n000012-20261123"; 0 for other names. Nights are in order by this, whatever the clock.
int numberOf(const std::string& night) {
  int number = 0;
  if (!night.starts_with('n')) return 0;
  const auto [end, ec] = std::from_chars(night.data() + 1, night.data() + night.size(), number);
  return ec == std::errc() && number > 0 && *end == '-' ? number : 0;
}

std::vector<std::string> nightNames(const Root& root) {
  std::vector<std::string> names;
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(root.nights(), ec))
    if (entry.is_directory(ec) && !entry.is_symlink(ec) &&
        numberOf(entry.path().filename().string()) > 0)
      names.push_back(entry.path().filename().string());
  std::ranges::sort(names, [](const auto& a, const auto& b) { return numberOf(a) > numberOf(b); });
  return names;
}

std::string nextName(const Root& root) {
  const auto names = nightNames(root);
  return fmt::format("n{:06}-{:%Y%m%d}", names.empty() ? 1 : numberOf(names.front()) + 1,
                     fmt::gmtime(std::time(nullptr)));
}

std::string currentName(const Root& root) {
  std::error_code ec;
  return fs::read_symlink(root.current(), ec).filename().string();
}

auto cannot(const fs::path& place, const char* what, const std::string& reason) {
  return failure(place.string(), fmt::format("{} ({})", what, reason),
                 "The last night stays published. Check the disk.");
}

/// Where each file of the night comes from.
std::map<std::string, fs::path> sources(const Night& night, const Plan& plan, const Root& root) {
  std::map<std::string, fs::path> from;
  for (const PlannedClip& clip : plan.clips) {
    const NightClip* c = night.find(clip.name);
    if (!c) continue;
    const auto product = [&](int stage) {
      return root.product(plan.jobs[clip.jobs[stage]].job.key);
    };
    const std::string stem = fs::path(clip.name).filename().string();
    for (const char* kind : {".mp4", ".png", ".vtt"})
      from[nightPath(*c, kind)] = product(3) / (stem + kind);
    from[nightPath(*c, ".json")] = product(2) / "measures.json";
    from[nightPath(*c, "sheet")] = product(4) / "sheet.png";
    from[nightPath(*c, "thumb")] = product(4) / "thumb.png";
  }
  return from;
}

Result<void> fill(const fs::path& part, const Night& night, const std::optional<Night>& last,
                  const Plan& plan, const Root& root, Stamps& stamps) {
  const auto from = sources(night, plan, root);
  const auto old = last ? last->files() : std::map<std::string, StoredFile>{};
  std::set<fs::path> folders{part};
  std::error_code ec;
  for (const auto& [path, file] : night.files()) {
    const fs::path to = part / path;
    for (fs::path f = to.parent_path(); f != part; f = f.parent_path()) folders.insert(f);
    fs::create_directories(to.parent_path(), ec);
    const auto same = old.find(path);
    const bool linked = last && same != old.end() && same->second.sha256 == file.sha256 &&
                        stamps.holds(root.nights() / last->name / path, file) &&
                        (fs::create_hard_link(root.nights() / last->name / path, to, ec), !ec);
    if (linked) continue;
    ec.clear();
    fs::copy_file(from.at(path), to, ec);
    if (ec) return cannot(to, "can't be copied", ec.message());
    if (auto done = flush(to); !done) return done;
  }
  if (auto done = writeFile(part / "manifest.json", manifestText(night)); !done) return done;
  if (auto done = writeFile(part / "SHA256SUMS", sumsText(night)); !done) return done;
  for (const fs::path& f : folders)
    if (auto done = flush(f); !done) return done;
  return {};
}

/// Reads every byte that a viewer will get.
Result<void> readBackAll(const fs::path& part, const Night& night, Stamps& stamps) {
  for (const auto& [path, file] : night.files())
    if (!stamps.reads(part / path, file))
      return failure((part / path).string(), "is not what was written",
                     "The last night stays published. Check the disk and the memory.");
  auto manifest = readManifest(part / "manifest.json");
  if (!manifest) return std::unexpected(manifest.error());
  if (manifest->content() != night.content())
    return failure((part / "manifest.json").string(), "is not what was written", "Check the disk.");
  return {};
}

Result<void> swapCurrent(const Root& root, const std::string& name) {
  const fs::path aside = root.path / fmt::format(".current.{}", ::getpid());
  std::error_code ec;
  fs::remove(aside, ec);
  fs::create_symlink(fs::path("nights") / name, aside, ec);
  if (ec) return cannot(aside, "can't be linked", ec.message());
  if (::rename(aside.c_str(), root.current().c_str()) != 0) {
    const std::string reason = std::strerror(errno);
    fs::remove(aside, ec);
    return cannot(root.current(), "can't be swapped", reason);
  }
  return flush(root.path);
}
}  // namespace

std::optional<Night> publishedNight(const Root& root) {
  auto night = readManifest(root.current() / "manifest.json");
  if (!night || night->name != currentName(root)) return std::nullopt;
  return std::move(*night);
}

bool nightHolds(const Root& root, const Night& night, Stamps& stamps) {
  return std::ranges::all_of(night.files(), [&](const auto& file) {
    return stamps.holds(root.nights() / night.name / file.first, file.second);
  });
}

Result<void> publishNight(Night& night, const std::optional<Night>& last, const Plan& plan,
                          const Root& root, Stamps& stamps) {
  night.name = nextName(root);
  const fs::path part = root.nights() / ("." + night.name + ".part");
  const fs::path final = root.nights() / night.name;
  std::error_code ec;
  fs::remove_all(part, ec);
  Result<void> done;
  if (fs::create_directory(part, ec); ec)
    done = cannot(part, "can't be made", ec.message());
  else
    done = fill(part, night, last, plan, root, stamps);
  if (done) done = readBackAll(part, night, stamps);
  if (done && ::rename(part.c_str(), final.c_str()) != 0)
    done = cannot(final, "can't be renamed into place", std::strerror(errno));
  if (!done) {
    fs::remove_all(part, ec);
    return done;
  }
  stamps.moved(part, final);
  if (done = flush(root.nights()); done) done = swapCurrent(root, night.name);
  return done;
}

int pruneNights(const Root& root, const PublishDef& limits) {
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(root.nights(), ec))
    if (const auto name = entry.path().filename().string();
        name.starts_with(".n") && name.ends_with(".part"))
      fs::remove_all(entry.path(), ec);
  for (const auto& entry : fs::directory_iterator(root.path, ec))
    if (entry.path().filename().string().starts_with(".current.")) fs::remove(entry.path(), ec);
  const std::string current = currentName(root);
  std::set<ino_t> seen;
  double bytes = 0;
  int count = 0, deleted = 0;
  for (const std::string& name : nightNames(root)) {
    // Files shared with newer nights cost nothing.
    for (fs::recursive_directory_iterator at(root.nights() / name, ec), end; !ec && at != end;
         at.increment(ec)) {
      struct stat s {};
      if (::lstat(at->path().c_str(), &s) == 0 && seen.insert(s.st_ino).second)
        bytes += static_cast<double>(s.st_size);
    }
    const bool tooMany = ++count > limits.keepNights, tooBig = bytes > limits.keep_gb * 1e9;
    if (name == current || (!tooMany && !tooBig)) continue;
    fs::remove_all(root.nights() / name, ec);
    ++deleted;
  }
  return deleted;
}
}  // namespace swallowclip::library
