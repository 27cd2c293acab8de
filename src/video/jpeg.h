// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "core/error.h"
#include "core/image.h"

namespace swallowclip::video {

/// Baseline JPEG, Y Cb Cr of full range (BT.601) with colour halved along rows (4:2:2), as DICOM's
/// YBR_FULL_422 expects it. `quantiser` 2 (best) to 31. Same picture, same bytes.
Result<std::string> encodeJpeg(const Image& image, int quantiser);
}  // namespace swallowclip::video
