// SPDX-License-Identifier: MIT
// The work of one job, the same whoever calls: Ninja, Slurm or a person.
#pragma once
#include <filesystem>

#include "library/job.h"
#include "library/root.h"
#include "pipeline/progress.h"

namespace swallowclip::library {

/// Makes the files of the product in `part`. What it needs must be in the store.
Result<void> perform(const Job& job, const Root& root, const std::filesystem::path& part,
                     pipeline::Progress& progress);

/// `swallowclip job KEY`: one product of the plan. Nothing happens when it is there already.
Result<void> job(const pipeline::RunOptions& options, pipeline::Progress& progress);
}  // namespace swallowclip::library
