// SPDX-License-Identifier: MIT
// Who runs the stale jobs: Ninja on this machine, Slurm on a cluster. Both start
// `swallowclip job KEY` and know nothing else; queue, isolation and retries are theirs.
#pragma once
#include "library/plan.h"
#include "pipeline/progress.h"

namespace swallowclip::library {

/// Writes run/jobs/KEY.json for every stale job and clears their logs.
Result<void> writeJobFiles(const Plan& plan, const Root& root);

/// Text of run/build.ninja: stale jobs only, longest way to go first. Its targets are never files,
/// so no clock and no time stamp matters.
std::string ninjaText(const Plan& plan, const Root& root, const std::string& program);

/// Runs them `jobs` at a time, going on after failures. An error only when Ninja itself could not
/// work; which jobs have failed is seen by what is in the store.
Result<void> runNinja(const Plan& plan, const Root& root, int jobs, pipeline::Progress& progress);

/// The keys of each array task: one swallow with one bolus and all its clips, longest first.
std::vector<std::vector<std::string>> slurmTasks(const Plan& plan);

/// Refuses while an earlier night of this library is still in Slurm's queue.
Result<void> checkSlurmIdle(const Root& root);

/// Submits one job array and, `afterany` of it, `finish` (a shell command line). Returns the id of
/// the latter.
Result<std::string> submitSlurm(const Plan& plan, const Root& root, const std::string& finish);

/// Waits for a job to leave the queue.
Result<void> waitForSlurm(const std::string& id, const Plan& plan, const Root& root,
                          pipeline::Progress& progress);
}  // namespace swallowclip::library
