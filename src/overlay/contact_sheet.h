// SPDX-License-Identifier: MIT
// Numbered frames of a study, many to a sheet, from which events and landmarks are read off.
#pragma once
#include <filesystem>

#include "pipeline/progress.h"
#include "study/protect.h"
#include "study/study.h"

namespace swallowclip::overlay {

/// FOLDER/sheet-01.png and so on, FOLDER/landmarks.png (the middle frame, pixel for pixel) and,
/// unless there is one, FOLDER/study.events.json to fill in. Returns the number of sheets.
Result<int> writeContactSheets(study::Study& study, const study::Protector& protector,
                               const std::filesystem::path& folder, pipeline::Progress& progress);
}  // namespace swallowclip::overlay
