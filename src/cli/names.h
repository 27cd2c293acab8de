// SPDX-License-Identifier: MIT
// Names on the command line against the files that define them, before any work begins.
#pragma once
#include "cli/option_table.h"

namespace swallowclip::cli {
/// Bolus, preset, views, scene and input files exist; unknown ones get the nearest name.
Result<void> checkNames(CommandBit command, const pipeline::RunOptions& options);
}  // namespace swallowclip::cli
