// SPDX-License-Identifier: MIT
// argv -> command and RunOptions, form only: nothing is read from disk here.
#pragma once
#include <string>
#include <vector>

#include "cli/option_table.h"
#include "core/error.h"
#include "pipeline/run_options.h"

namespace swallowclip::cli {

struct CommandLine {
  CommandBit command = kList;
  pipeline::RunOptions options;
  std::string helpText;  ///< not empty: print it and stop (--help, --version)
};

/// `words` without the program's name. `data` is the folder with scenes/ and render_presets/.
Result<CommandLine> parseCommandLine(const std::vector<std::string>& words,
                                     const std::filesystem::path& data);
}  // namespace swallowclip::cli
