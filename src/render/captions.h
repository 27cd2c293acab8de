// SPDX-License-Identifier: MIT
// Words and the time bar on a finished picture, set by pango and cairo.
#pragma once
#include <string>
#include <vector>

#include "core/error.h"
#include "core/image.h"
#include "render/render_preset.h"

namespace swallowclip::render {

struct CaptionEvent {
  std::string name;
  double time_s = 0;
};

struct CaptionText {
  std::string title;                               ///< "MBSImP component 4, score 0: ..."
  std::string subtitle;                            ///< bolus, case
  std::string viewLabel;                           ///< empty = the view's captionTitle
  std::string credit;                              ///< empty = the preset's
  std::vector<CaptionEvent> events;                ///< sorted by time
  double time_s = 0, start_s = 0, duration_s = 0;  ///< bar runs start .. start + duration
};

/// Draws the captions into the picture. The current event is the last one that has begun.
Result<void> drawCaptions(Image& image, const CaptionDef& def, const CaptionText& text);
}  // namespace swallowclip::render
