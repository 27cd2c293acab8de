// SPDX-License-Identifier: MIT
// A finished clip read back as a viewer would: every frame decoded, counted and timed, the poster
// and the chapters beside it read. Makes the contact sheet and the thumbnail on the way.
#pragma once
#include <filesystem>

#include "core/error.h"
#include "core/image.h"
#include "library/spec.h"

namespace swallowclip::library {

struct ClipFacts {
  int frames = 0, width = 0, height = 0;
  double fps = 0;
};

/// `clip` is the .mp4; its poster (.png) and chapters (.vtt) have the same stem. An error says what
/// is not as it must be. Writes sheet.png and thumb.png into `folder`.
Result<ClipFacts> readBack(const std::filesystem::path& clip, int frames, double fps,
                           const SheetDef& sheet, const std::filesystem::path& folder);

/// Area average; `width_px` not above the picture's own.
Image shrink(const Image& image, int width_px);

/// How different two pictures look, 0 (equal) to about 1: one minus the mean structural similarity
/// of the luma in blocks of 8 x 8 pixels (Wang et al. 2004). Of two sizes: 1.
double visibleDifference(const Image& a, const Image& b);
}  // namespace swallowclip::library
