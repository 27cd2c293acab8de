// SPDX-License-Identifier: MIT
#pragma once
#include "study/study.h"

namespace swallowclip::study {

/// A DICOM multi-frame study, parsed and decompressed in a child process with limited memory and
/// time: whatever a hostile file does to a decoder ends there, and is a refusal here.
Result<std::unique_ptr<Study>> openDicom(const StudyDef& def);
}  // namespace swallowclip::study
