// SPDX-License-Identifier: MIT
#pragma once
#include "render/render_preset.h"
#include "core/image.h"

namespace swallowclip::render {
/// What stands behind everything; half a level of fixed ordered noise hides the bands of the dark
/// colours. Alpha 0: no structure.
Image makeBackground(const RenderPreset& preset);
}  // namespace swallowclip::render
