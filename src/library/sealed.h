// SPDX-License-Identifier: MIT
// Small JSON files of our own that carry a hash of themselves, so that damage is noticed.
#pragma once
#include <filesystem>
#include <string>

#include "core/error.h"
#include "scene/json_reader.h"

namespace swallowclip::library {

/// `members` without the braces around them: "\"a\": 1,\n\"b\": 2".
std::string sealed(const std::string& members);

/// An error when the file is missing, cut or changed by hand.
Result<scene::JsonFile> readSealed(const std::filesystem::path& file);
}  // namespace swallowclip::library
