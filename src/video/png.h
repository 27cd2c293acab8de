// SPDX-License-Identifier: MIT
#pragma once
#include <filesystem>
#include <string>

#include "core/error.h"
#include "core/image.h"

namespace swallowclip::video {

/// The picture as PNG bytes: sRGB, RGB when every pixel is opaque, else RGBA. Same picture, same
/// bytes (for one libpng and zlib).
Result<std::string> encodePng(const Image& image);

/// Writes and publishes whole.
Result<void> writePng(const Image& image, const std::filesystem::path& path);

/// Any PNG up to 16384 x 16384, as 8-bit sRGB RGBA.
Result<Image> readPng(const std::filesystem::path& path);
}  // namespace swallowclip::video
