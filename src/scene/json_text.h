// SPDX-License-Identifier: MIT
// JSON as text: what is written by hand needs its strings quoted; what is hashed needs one form.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace swallowclip::scene {

/// "..." with quotes, backslashes and control characters escaped; bytes that are no UTF-8 become
/// U+FFFD.
std::string quotedJson(std::string_view text);

/// What a file means, as one line: keys sorted, white space, "comment" and "source" left out. With
/// `list` and `member`, of the object under `list` only that member is kept (one view of a preset,
/// one bolus of the list). Two files of the same meaning give the same text.
Result<std::string> canonicalJson(const std::filesystem::path& path, const std::string& list = "",
                                  const std::string& member = "");
}  // namespace swallowclip::scene
