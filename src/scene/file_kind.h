// SPDX-License-Identifier: MIT
// What a JSON file holds, told by its keys, wherever it lies and whatever it is called.
#pragma once
#include <filesystem>

#include "core/error.h"

namespace swallowclip::scene {

enum class FileKind { preset, bolusList, bolus, scoringRules, other };

/// An error only when the file cannot be read or is not JSON.
Result<FileKind> fileKind(const std::filesystem::path& path);

/// A whole preset, bolus list, single bolus or rules file read and checked; `other` is not looked
/// at.
Result<void> checkFile(const std::filesystem::path& path, FileKind kind);
}  // namespace swallowclip::scene
