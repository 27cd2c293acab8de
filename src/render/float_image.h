// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <vector>

namespace swallowclip::render {

/// One value per pixel, row 0 on top.
struct FloatImage {
  int width = 0, height = 0;
  std::vector<float> values;
  float at(int x, int y) const { return values[static_cast<std::size_t>(y) * width + x]; }
};

}  // namespace swallowclip::render
