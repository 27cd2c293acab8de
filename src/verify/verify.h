// SPDX-License-Identifier: MIT
// The command `swallowclip verify`: case files through the solver, results as a table on standard
// output, verify.json and charts in the folder.
#pragma once
#include "core/error.h"
#include "pipeline/progress.h"
#include "pipeline/run_options.h"

namespace swallowclip::verify {

Result<void> verify(const pipeline::RunOptions& options, pipeline::Progress& progress);
}  // namespace swallowclip::verify
