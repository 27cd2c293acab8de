// SPDX-License-Identifier: MIT
// Commands and options, once: this table makes the parser, --help and the page docs/options.md.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "pipeline/run_options.h"

namespace swallowclip::cli {

enum CommandBit : unsigned {
  kRender = 1,
  kSimulate = 2,
  kMeasure = 4,
  kDraw = 8,
  kExport = 16,
  kImport = 32,
  kList = 64,
  kCheck = 128,
  kVerify = 256,
  kEvents = 512,
  kOverlay = 1024,
  kSweep = 4096,
  kConfusion = 8192,
  kNightly = 16384,
  kJob = 32768,
};

struct CommandRow {
  CommandBit bit;
  const char* word;
  const char* help;
};

struct OptionRow {
  const char* name;   ///< "--score"; a word without dashes is a positional argument
  const char* value;  ///< placeholder in --help; "" for a switch
  const char* help;
  unsigned commands;  ///< who takes it
  unsigned required;  ///< who needs it
  bool many;          ///< takes several words
  /// Checks the words and writes them into the options.
  Result<void> (*apply)(const std::vector<std::string>& words, pipeline::RunOptions& options);
};

std::span<const CommandRow> commandTable();
std::span<const OptionRow> optionTable();

/// Markdown page of all commands and options.
std::string optionsPage();
}  // namespace swallowclip::cli
