// SPDX-License-Identifier: MIT
// Files appear under their final name only when whole: written aside, flushed, renamed.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "core/error.h"

namespace swallowclip {

Result<std::string> readFile(const std::filesystem::path& path);

/// Name to write to before `publishFile`: a hidden sibling ".NAME.PID.part.EXT" (the extension is
/// kept, since libraries guess formats by it).
std::filesystem::path asidePath(const std::filesystem::path& finalPath);

/// Flushes `aside` to disk and renames it to `finalPath`.
Result<void> publishFile(const std::filesystem::path& aside,
                         const std::filesystem::path& finalPath);

/// All of it: writes bytes aside and publishes them.
Result<void> writeFile(const std::filesystem::path& finalPath, std::string_view bytes);

/// Creates the folder and proves that it can be written to.
Result<void> prepareFolder(const std::filesystem::path& folder);
}  // namespace swallowclip
