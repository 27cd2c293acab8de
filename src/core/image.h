// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <vector>

namespace swallowclip {
/// 8-bit sRGB RGBA, row 0 on top, tightly packed.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;

  Image() = default;
  Image(int w, int h) : width(w), height(h), rgba(static_cast<std::size_t>(w) * h * 4, 255) {}
  std::uint8_t* row(int y) { return rgba.data() + static_cast<std::size_t>(y) * width * 4; }
  const std::uint8_t* row(int y) const {
    return rgba.data() + static_cast<std::size_t>(y) * width * 4;
  }
};
}  // namespace swallowclip
