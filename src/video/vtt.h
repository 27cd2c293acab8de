// SPDX-License-Identifier: MIT
// A clip's chapter track (WebVTT): one chapter from each event to the next.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"

namespace swallowclip::video {

struct Chapter {
  std::string name;
  double start_s = 0;  ///< in the clip's time, 0 is its first frame
};

/// Chapters in any order. One that starts before the clip covers its beginning; ones from
/// `duration_s` on are left out; those within the same millisecond share a cue ("A, B"); what lies
/// before the first is called `opening`.
Result<std::string> vttText(std::vector<Chapter> chapters, double duration_s,
                            const std::string& opening = "Start");

Result<void> writeVtt(const std::vector<Chapter>& chapters, double duration_s,
                      const std::filesystem::path& path, const std::string& opening = "Start");
}  // namespace swallowclip::video
