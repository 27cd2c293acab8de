// SPDX-License-Identifier: MIT
// What a JSON file holds, told by its keys, wherever it lies and whatever it is called.
#pragma once
#include <filesystem>

#include "core/error.h"

namespace swallowclip::scene {

enum class FileKind { preset, palette, bolusList, bolus, scoringRules, other };

/// An error only when the file cannot be read or is not JSON.
Result<FileKind> fileKind(const std::filesystem::path& path);

/// A whole preset, palette, bolus list, single bolus or rules file read and checked; `other` is not
/// looked at. `presetsFolder`: where bases and palettes are looked for by name.
Result<void> checkFile(const std::filesystem::path& path, FileKind kind,
                       const std::filesystem::path& presetsFolder);
}  // namespace swallowclip::scene
