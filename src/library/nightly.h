// SPDX-License-Identifier: MIT
// The whole library, every night: plan, run what is stale, publish when it is whole.
#pragma once
#include "core/error.h"
#include "pipeline/progress.h"
#include "pipeline/run_options.h"

namespace swallowclip::library {

/// `swallowclip nightly`. Prints one line of JSON; an error means that the library shown is not
/// the one the spec asks for.
Result<void> nightly(const pipeline::RunOptions& options, pipeline::Progress& progress);
}  // namespace swallowclip::library
