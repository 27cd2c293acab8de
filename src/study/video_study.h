// SPDX-License-Identifier: MIT
#pragma once
#include "study/study.h"

namespace swallowclip::study {

/// A study that libav reads.
Result<std::unique_ptr<Study>> openVideo(const StudyDef& def);

/// Longest study: 11 minutes at 30 frames/s; a swallow is seconds. assumed, range 5000 to 100000.
inline constexpr int kMaxFrames = 20000;
}  // namespace swallowclip::study
