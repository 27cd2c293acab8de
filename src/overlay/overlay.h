// SPDX-License-Identifier: MIT
// The commands `swallowclip events` and `swallowclip overlay`.
#pragma once
#include "core/error.h"
#include "pipeline/progress.h"
#include "pipeline/run_options.h"

namespace swallowclip::overlay {

/// Contact sheets of a study.
Result<void> events(const pipeline::RunOptions& options, pipeline::Progress& progress);

/// The clip: STEM.mp4, STEM.vtt, STEM.png, STEM.json and, when asked for, STEM.dcm.
Result<void> overlay(const pipeline::RunOptions& options, pipeline::Progress& progress);
}  // namespace swallowclip::overlay
