// SPDX-License-Identifier: MIT
// Swallow files: a full timeline, or a "base" file plus what differs from it.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "kinematics/swallow_def.h"

namespace swallowclip::scene {

Result<kinematics::SwallowDef> loadSwallow(const std::filesystem::path& path);

/// The file and the bases it builds on, nearest first.
Result<std::vector<std::filesystem::path>> swallowFiles(const std::filesystem::path& path);

/// Applies "track.key=value" (keys onset_s, peak_s, hold_s, offset_s, amplitude, delay_s, speed).
/// "larynx" and "hyoid" stand for all tracks of theirs (amplitude, delay_s, speed); another onset_s
/// moves the whole track.
Result<void> applySet(kinematics::SwallowDef& swallow, const std::string& assignment);
}  // namespace swallowclip::scene
