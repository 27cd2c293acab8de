// SPDX-License-Identifier: MIT
// One swallow, from the scene to its finished history.
#pragma once
#include "frame/history.h"
#include "kinematics/swallow_def.h"
#include "pipeline/progress.h"
#include "pipeline/run_options.h"
#include "pipeline/scene_loader.h"

namespace swallowclip::pipeline {

/// The swallow file of component and score (or --swallow), with every --set applied. `score` -1:
/// none intended.
Result<kinematics::SwallowDef> loadSwallow(const RunOptions& options, int score,
                                           std::filesystem::path* file = nullptr);

/// Frames at `fps` from the cue (time 0) to the end of the swallow.
Result<frame::History> simulateSwallow(const RunOptions& options, int score, double fps,
                                       Progress& progress);

/// The same for a swallow that is known already; `swallowFile` counts for the inputs' hash.
Result<frame::History> simulateSwallow(const RunOptions& options,
                                       const kinematics::SwallowDef& swallow,
                                       const std::filesystem::path& swallowFile, double fps,
                                       Progress& progress);
}  // namespace swallowclip::pipeline
