// SPDX-License-Identifier: MIT
#include "render/background.h"

#include <algorithm>
#include <cmath>

#include "render/colour_vision.h"

namespace swallowclip::render {

Image makeBackground(const RenderPreset& preset) {
  Image image(preset.width, preset.height);
  for (int y = 0; y < image.height; ++y) {
    const float up = 1 - (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height);
    const float f = up * up * (3 - 2 * up);
    const Colour sky = (1 - f) * preset.background.bottom_srgb + f * preset.background.top_srgb;
    for (int x = 0; x < image.width; ++x) {
      const float noise = static_cast<float>((x * 5 + y * 3) & 7) / 8 - 0.4375f;
      for (int k = 0; k < 3; ++k)
        image.row(y)[4 * x + k] =
            static_cast<std::uint8_t>(std::clamp(std::lround(255 * sky[k] + noise), 0L, 255L));
      image.row(y)[4 * x + 3] = 0;
    }
  }
  return image;
}

std::array<std::uint8_t, 256> makeEncoding() {
  std::array<std::uint8_t, 256> table{};
  for (int i = 0; i < 256; ++i) {
    const float root = static_cast<float>(i) / 255;
    table[i] = static_cast<std::uint8_t>(std::lround(255 * toSrgb(root * root)));
  }
  return table;
}
}  // namespace swallowclip::render
