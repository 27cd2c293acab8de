// SPDX-License-Identifier: MIT
#include "library/root.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/file.h"

namespace swallowclip::library {
namespace fs = std::filesystem;
namespace {
constexpr const char* kMark = ".swallowclip-library";

Result<void> refuse(const fs::path& place, std::string problem, std::string remedy) {
  return usageError(place.string(), std::move(problem), std::move(remedy));
}

/// An existing folder must be ours in every sense before anything in it is written or deleted.
Result<void> checkOwned(const fs::path& folder) {
  struct stat s {};
  if (::lstat(folder.c_str(), &s) != 0) {
    if (errno == ENOENT) return {};
    return refuse(folder, std::strerror(errno), "Choose another folder with --out.");
  }
  if (S_ISLNK(s.st_mode)) return refuse(folder, "is a symbolic link", "Put a real folder there.");
  if (!S_ISDIR(s.st_mode)) return refuse(folder, "is not a folder", "Move it away.");
  if (s.st_uid != ::geteuid())
    return refuse(
        folder,
        fmt::format("belongs to user {}, not to user {} who runs this", s.st_uid, ::geteuid()),
        "Choose a folder of your own with --out, or run as its owner.");
  return {};
}

Result<void> checkContents(const fs::path& folder) {
  std::error_code ec;
  if (!fs::is_directory(folder, ec) || fs::exists(folder / kMark, ec) || fs::is_empty(folder, ec))
    return {};
  return refuse(folder, "holds other things than a library",
                "Choose an empty or new folder with --out: old products in it get deleted.");
}
}  // namespace

Result<Root> openRoot(const fs::path& folder, bool create) {
  std::error_code ec;
  const fs::path real = fs::weakly_canonical(fs::absolute(folder, ec), ec);
  if (ec)
    return usageError(folder.string(), fmt::format("can't be followed ({})", ec.message()),
                      "Remove the link that leads in a circle, or choose another --out.");
  const Root root{real};
  for (const fs::path& f : {root.path, root.store(), root.nights(), root.report(), root.run()})
    if (auto owned = checkOwned(f); !owned) return std::unexpected(owned.error());
  if (auto ours = checkContents(root.path); !ours) return std::unexpected(ours.error());
  if (fs::exists(fs::symlink_status(root.current(), ec)) &&
      !fs::is_symlink(fs::symlink_status(root.current(), ec)))
    return usageError(root.current().string(), "is not a symbolic link",
                      "Move it away: the library is published there.");
  if (!create) return root;
  if (auto ready = prepareFolder(root.path); !ready) return std::unexpected(ready.error());
  if (!fs::exists(root.path / kMark, ec))
    if (auto done = writeFile(root.path / kMark, "Folders here are swallowclip's own.\n"); !done)
      return std::unexpected(done.error());
  for (const fs::path& f : {root.store(), root.nights(), root.report(), root.run() / "jobs",
                            root.run() / "logs", root.run() / "checkpoints"})
    if (auto ready = prepareFolder(f); !ready) return std::unexpected(ready.error());
  return root;
}

Result<Lock> Lock::take(const Root& root, bool wait) {
  const fs::path file = root.path / "lock";
  // Inherited by children on purpose (no O_CLOEXEC): a job that outlives us keeps others out.
  const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW, 0644);
  if (fd < 0)
    return failure(file.string(), fmt::format("can't be opened ({})", std::strerror(errno)),
                   "Check the permissions of the folder.");
  Lock lock(fd);
  int taken;
  do taken = ::flock(fd, LOCK_EX | (wait ? 0 : LOCK_NB));
  while (taken != 0 && errno == EINTR && wait);
  if (taken != 0) {
    char holder[32] = {};
    [[maybe_unused]] const auto count = ::pread(fd, holder, sizeof holder - 1, 0);
    return failure(
        root.path.string(),
        fmt::format("another night is at work here (process {})", *holder ? holder : "unknown"),
        "Wait for it to end; the lock goes away with its last process.");
  }
  const std::string pid = fmt::format("{}", ::getpid());
  [[maybe_unused]] const bool told =
      ::ftruncate(fd, 0) == 0 && ::pwrite(fd, pid.data(), pid.size(), 0) > 0;
  return lock;
}

Lock::~Lock() {
  if (fd_ >= 0) ::close(fd_);
}
}  // namespace swallowclip::library
