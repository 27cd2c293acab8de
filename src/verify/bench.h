// SPDX-License-Identifier: MIT
// `swallowclip verify --bench`: what the solver costs, in wall and processor seconds per simulated
// second, beside the published times of another one and a small fixed loop that tells how fast this
// machine is.
#pragma once
#include "core/error.h"
#include "pipeline/progress.h"
#include "pipeline/run_options.h"

namespace swallowclip::verify {
Result<void> bench(const pipeline::RunOptions& options, pipeline::Progress& progress);
}  // namespace swallowclip::verify
