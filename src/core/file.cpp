// SPDX-License-Identifier: MIT
#include "core/file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>

namespace swallowclip {
namespace fs = std::filesystem;

Result<std::string> readFile(const fs::path& path) {
  std::error_code ec;
  if (!fs::exists(path, ec))
    return usageError(path.string(), "no such file", "Check the name and the folder.");
  if (fs::is_directory(path, ec))
    return usageError(path.string(), "is a folder, a file was expected", "Name a file in it.");
  std::ifstream in(path, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (in.bad() || !in.is_open())
    return failure(path.string(), fmt::format("can't be read ({})", std::strerror(errno)),
                   "Check its permissions.");
  return text;
}

fs::path asidePath(const fs::path& p) {
  return p.parent_path() /
         fmt::format(".{}.{}.part{}", p.stem().string(), ::getpid(), p.extension().string());
}

Result<void> publishFile(const fs::path& aside, const fs::path& finalPath) {
  const auto fail = [&](const char* what) {
    const std::string reason = std::strerror(errno);
    std::error_code ignored;
    fs::remove(aside, ignored);
    return failure(finalPath.string(), fmt::format("{} ({})", what, reason),
                   "Free space or choose another folder with --out.");
  };
  const int fd = ::open(aside.c_str(), O_RDONLY);
  if (fd < 0) return fail("the finished file can't be opened");
  const int synced = ::fsync(fd);
  ::close(fd);
  if (synced != 0) return fail("can't be flushed to disk");
  if (::rename(aside.c_str(), finalPath.c_str()) != 0) return fail("can't be renamed into place");
  const fs::path parent = finalPath.parent_path();
  const int dir = ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY);
  if (dir >= 0) {
    ::fsync(dir);
    ::close(dir);
  }
  return {};
}

Result<void> writeFile(const fs::path& finalPath, std::string_view bytes) {
  const fs::path aside = asidePath(finalPath);
  {
    std::ofstream out(aside, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) {
      const std::string reason = std::strerror(errno);
      std::error_code ignored;
      fs::remove(aside, ignored);
      return failure(finalPath.string(), fmt::format("can't be written ({})", reason),
                     "Check that the folder exists, is writable and has space.");
    }
  }
  return publishFile(aside, finalPath);
}

Result<void> prepareFolder(const fs::path& folder) {
  std::error_code ec;
  fs::create_directories(folder, ec);
  if (ec)
    return failure(folder.string(), fmt::format("can't be created ({})", ec.message()),
                   "Choose a writable folder with --out.");
  const fs::path probe = folder / ".writable";
  if (auto written = writeFile(probe, ""); !written) return written;
  fs::remove(probe, ec);
  return {};
}
}  // namespace swallowclip
