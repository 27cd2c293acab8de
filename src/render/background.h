// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>

#include "core/image.h"
#include "render/render_preset.h"

namespace swallowclip::render {
/// What stands behind everything; half a level of fixed ordered noise hides the bands of the dark
/// colours. Alpha 0: no structure.
Image makeBackground(const RenderPreset& preset);
/// sRGB of a square root of linear, both in 8 bits.
std::array<std::uint8_t, 256> makeEncoding();
}  // namespace swallowclip::render
