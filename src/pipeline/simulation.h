// SPDX-License-Identifier: MIT
// One swallow, from the scene to its finished history.
#pragma once
#include <algorithm>
#include <cstdint>

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

/// What the bolus of a run cost, set-up excluded.
struct SolverCost {
  std::size_t particles = 0;
  std::int64_t steps = 0;  ///< of this run: without those of a checkpoint that it went on from
  double wall_s = 0;
  double eachStep_us() const {  ///< of a particle
    return wall_s * 1e6 / static_cast<double>(std::max<std::int64_t>(1, steps) * particles);
  }
};

/// Frames at `fps` from the cue (time 0) to the end of the swallow. `cost`, if given, is filled.
Result<frame::History> simulateSwallow(const RunOptions& options, int score, double fps,
                                       Progress& progress, SolverCost* cost = nullptr);

/// The same for a swallow that is known already; `swallowFile` counts for the inputs' hash.
Result<frame::History> simulateSwallow(const RunOptions& options,
                                       const kinematics::SwallowDef& swallow,
                                       const std::filesystem::path& swallowFile, double fps,
                                       Progress& progress, SolverCost* cost = nullptr);
}  // namespace swallowclip::pipeline
