// SPDX-License-Identifier: MIT
// One call of the program: parse, check, hand over to the pipeline, end with an exit code.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "cli/option_table.h"
#include "pipeline/progress.h"
#include "pipeline/run_options.h"

namespace swallowclip::cli {

enum ExitCode { kDone = 0, kFailed = 1, kUsage = 2, kInterrupted = 130 };

using Handler = std::function<Result<void>(const pipeline::RunOptions&, pipeline::Progress&)>;
using Handlers = std::map<CommandBit, Handler>;

/// `words` without the program's name.
int run(const std::vector<std::string>& words, const std::filesystem::path& data,
        const Handlers& handlers);
}  // namespace swallowclip::cli
