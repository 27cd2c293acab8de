// SPDX-License-Identifier: MIT
#include "cli/run.h"

#include "cli/command_line.h"
#include "cli/names.h"
#include "cli/progress.h"
#include "pipeline/interrupt.h"

namespace swallowclip::cli {
namespace {
int exitCode(const Error& error) {
  if (pipeline::interrupted()) return kInterrupted;
  return error.kind == ErrorKind::usage ? kUsage : kFailed;
}

Result<void> perform(const std::vector<std::string>& words, const std::filesystem::path& data,
                     const Handlers& handlers, TerminalProgress& progress) {
  auto line = parseCommandLine(words, data);
  if (!line) return std::unexpected(line.error());
  if (!line->helpText.empty()) {
    progress.print(line->helpText);
    return {};
  }
  if (auto known = checkNames(line->command, line->options); !known) return known;
  return handlers.at(line->command)(line->options, progress);
}
}  // namespace

int run(const std::vector<std::string>& words, const std::filesystem::path& data,
        const Handlers& handlers) {
  TerminalProgress progress;
  try {
    const Result<void> done = perform(words, data, handlers, progress);
    if (!done) {
      progress.finish();
      progress.note(fmt::format("swallowclip: {}", done.error().text()));
      return exitCode(done.error());
    }
  } catch (const std::bad_alloc&) {
    progress.note("swallowclip: out of memory\n  Use a wider --spacing-mm or fewer --jobs.");
    return kFailed;
  } catch (const std::exception& error) {
    progress.note(fmt::format("swallowclip: internal error: {}", error.what()));
    return kFailed;
  }
  if (progress.finish()) return pipeline::interrupted() ? kInterrupted : kDone;
  progress.note("swallowclip: standard output could not be written\n  Is the disk full?");
  return kFailed;
}
}  // namespace swallowclip::cli
