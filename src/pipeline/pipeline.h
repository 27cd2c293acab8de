// SPDX-License-Identifier: MIT
// The commands of the program, and the only place that knows the order of the rooms:
// scene -> motion -> model -> airway-skin -> bolus -> history, then measures, pictures and clips.
#pragma once
#include "core/error.h"
#include "pipeline/progress.h"
#include "pipeline/run_options.h"

namespace swallowclip::pipeline {

Result<void> render(const RunOptions& options, Progress& progress);
Result<void> simulate(const RunOptions& options, Progress& progress);
Result<void> measure(const RunOptions& options, Progress& progress);
Result<void> draw(const RunOptions& options, Progress& progress);
Result<void> exportHistory(const RunOptions& options, Progress& progress);
/// The same swallow over a range of one number: a table and a plot of what changes.
Result<void> sweep(const RunOptions& options, Progress& progress);
Result<void> importMeshes(const RunOptions& options, Progress& progress);
Result<void> list(const RunOptions& options, Progress& progress);
/// Simulates every built-in score and prints what was intended against what was measured; fails
/// when one is not confirmed.
Result<void> confusion(const RunOptions& options, Progress& progress);
Result<void> check(const RunOptions& options, Progress& progress);
}  // namespace swallowclip::pipeline
