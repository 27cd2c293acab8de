// SPDX-License-Identifier: MIT
#include "cli/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <thread>

#include "pipeline/components.h"

namespace swallowclip::cli {
namespace {
using pipeline::RunOptions;

constexpr const char* kHelpHint =
    "`swallowclip --help` and `swallowclip COMMAND --help` tell more.";

struct Parser {
  CLI::App app{"Simulates a swallow in 3D and films it.", "swallowclip"};
  std::map<unsigned, CLI::App*> commands;
  std::map<std::pair<unsigned, const OptionRow*>, std::vector<std::string>> words;
  std::map<std::pair<unsigned, const OptionRow*>, bool> switches;
};

void fillParser(Parser& parser) {
  parser.app.set_version_flag("--version", "swallowclip " SWALLOWCLIP_VERSION);
  parser.app.require_subcommand(1);
  for (const CommandRow& command : commandTable()) {
    CLI::App* sub = parser.app.add_subcommand(command.word, command.help);
    parser.commands[command.bit] = sub;
    for (const OptionRow& row : optionTable()) {
      if (!(row.commands & command.bit)) continue;
      const auto key = std::pair(unsigned(command.bit), &row);
      if (!*row.value) {
        sub->add_flag(row.name, parser.switches[key], row.help);
        continue;
      }
      CLI::Option* option = sub->add_option(row.name, parser.words[key], row.help);
      option->type_name(row.value)->required(row.required & command.bit);
      if (row.many)
        option->expected(1, -1);
      else
        option->expected(1)->allow_extra_args(false);  // what follows may be a file
    }
  }
}

/// An unknown command or option, with the nearest known one.
Result<void> checkNames(const std::vector<std::string>& words) {
  std::vector<std::string> known;
  for (const CommandRow& command : commandTable()) known.push_back(command.word);
  if (words.empty() || words[0].starts_with('-')) return {};
  const auto at = std::ranges::find(known, words[0]);
  if (at == known.end()) {
    const std::string near = nearestName(words[0], known);
    return usageError("", fmt::format("unknown command \"{}\"", words[0]),
                      near.empty() ? fmt::format("Known: {}.", fmt::join(known, ", "))
                                   : fmt::format("Did you mean \"{}\"?", near));
  }
  const unsigned bit = commandTable()[at - known.begin()].bit;
  std::vector<std::string> options{"--help"};
  for (const OptionRow& row : optionTable())
    if (row.commands & bit) options.push_back(row.name);
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (!words[i].starts_with("--") || words[i] == "--") continue;
    const std::string name = words[i].substr(0, words[i].find('='));
    if (std::ranges::find(options, name) != options.end()) continue;
    const std::string near = nearestName(name, options);
    return usageError("", fmt::format("{} has no option {}", words[0], name),
                      near.empty() ? kHelpHint : fmt::format("Did you mean {}?", near));
  }
  return {};
}

/// A study with its events, or the demonstration.
Result<void> checkOverlay(const RunOptions& options) {
  const pipeline::OverlayOptions& o = options.overlay;
  if (o.demo) {
    if (!o.vf.empty() || !o.events.empty())
      return usageError("--demo", "makes its own study", "Leave out --vf and --events.");
    return {};
  }
  if (o.vf.empty() || o.events.empty())
    return usageError(o.vf.empty() ? "--vf" : "--events", "no study or no events given",
                      "Give --vf STUDY --events FILE (`swallowclip events` helps), or --demo.");
  if (o.out.empty()) return usageError("--out", "no clip named", "Give --out FILE.mp4.");
  if (o.out.extension() != ".mp4")
    return usageError("--out", "not an .mp4 file", "Give --out FILE.mp4.");
  return {};
}

/// Whether `overlay` needs component and score (or a swallow file).
bool makesSwallow(const RunOptions& options) {
  return options.component != 0 || !options.scores.empty() ||
         (!options.overlay.demo && options.history.empty());
}

/// What the choices mean together: component and scores, or a swallow file.
Result<void> checkTogether(unsigned command, RunOptions& options) {
  if (command == kOverlay)
    if (auto done = checkOverlay(options); !done || !makesSwallow(options)) return done;
  if (!(command & (kRender | kSimulate | kSweep | kOverlay))) return {};
  if (command == kSweep && !options.range)
    return usageError("--set", "sweep needs a range", "Give track.key=from:to:step.");
  if (command != kSweep && options.range)
    return usageError("--set", "a range of values", "Give one value, or use sweep.");
  if (options.component == 0 && options.swallow.empty())
    return usageError("--component", "no component chosen",
                      "Give --component and --score, or --swallow FILE.");
  if (options.component == 0) {
    if (!options.scores.empty())
      return usageError("--score", "a score needs a component", "Give --component as well.");
    return {};
  }
  const pipeline::Component& c = *pipeline::findComponent(options.component);
  if (options.scores.empty() && options.swallow.empty())
    return usageError(
        "--score", "no score chosen",
        fmt::format("Component {} has the scores 0 to {}, or all.", c.number, c.highestScore()));
  const bool all = options.scores.size() == 5;
  if (all) options.scores.resize(c.highestScore() + 1);
  if (!options.scores.empty() && options.scores.back() > c.highestScore())
    return usageError("--score",
                      fmt::format("component {} has no score {}", c.number, options.scores.back()),
                      fmt::format("Its scores are 0 to {}.", c.highestScore()));
  if (command != kRender && options.scores.size() > 1)
    return usageError("--score", "takes one score here", "Choose one, or use render.");
  if (!options.swallow.empty() && options.scores.size() > 1)
    return usageError("--score", "one swallow file shows one score", "Choose one.");
  return {};
}

std::string quoted(const std::vector<std::string>& words) {
  std::string line = "swallowclip";
  for (const std::string& word : words) {
    const bool plain =
        !word.empty() && word.find_first_of(" \t\n'\"\\$&|;<>()*?[]#~`!{}") == std::string::npos;
    if (plain) {
      line += fmt::format(" {}", word);
      continue;
    }
    std::string inner;
    for (const char c : word) inner += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += fmt::format(" '{}'", inner);
  }
  return line;
}

/// The table's rows write what CLI11 has collected into the options.
Result<void> applyRows(Parser& parser, unsigned command, RunOptions& options) {
  for (const OptionRow& row : optionTable()) {
    if (!(row.commands & command)) continue;
    const auto key = std::pair(command, &row);
    const std::vector<std::string>& words = parser.words[key];
    if (words.empty() && !parser.switches[key]) continue;
    for (const std::string& word : words)
      if (word.empty())
        return usageError(row.name, "an empty value", "Give a value or leave the option out.");
    if (auto done = row.apply(words, options); !done) return done;
  }
  return {};
}
}  // namespace

Result<CommandLine> parseCommandLine(const std::vector<std::string>& words,
                                     const std::filesystem::path& data) {
  CommandLine line;
  line.options.data = data;
  line.options.commandLine = quoted(words);
  line.options.jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  if (auto known = checkNames(words); !known) return std::unexpected(known.error());
  Parser parser;
  fillParser(parser);
  try {
    parser.app.parse(std::vector<std::string>(words.rbegin(), words.rend()));  // it pops the back
  } catch (const CLI::CallForVersion&) {
    line.helpText = "swallowclip " SWALLOWCLIP_VERSION "\n";
    return line;
  } catch (const CLI::CallForHelp&) {
    const CLI::App* shown = &parser.app;
    for (const auto& [bit, sub] : parser.commands)
      if (sub->parsed()) shown = sub;
    line.helpText = shown->help(shown == &parser.app ? "" : "swallowclip");
    return line;
  } catch (const CLI::ParseError& error) {
    return usageError("", error.what(), kHelpHint);
  }
  for (const auto& [bit, sub] : parser.commands)
    if (sub->parsed()) line.command = static_cast<CommandBit>(bit);
  if (auto done = applyRows(parser, line.command, line.options); !done)
    return std::unexpected(done.error());
  if (auto done = checkTogether(line.command, line.options); !done)
    return std::unexpected(done.error());
  return line;
}
}  // namespace swallowclip::cli
