// SPDX-License-Identifier: MIT
#include "cli/option_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "pipeline/components.h"

namespace swallowclip::cli {
namespace {
using pipeline::RunOptions;
using Words = std::vector<std::string>;

Result<double> number(const char* place, const std::string& word, double min, double max) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool whole = error == std::errc{} && end == word.data() + word.size();
  if (whole && value >= min && value <= max) return value;
  return usageError(place, fmt::format("\"{}\" is not a number from {} to {}", word, min, max),
                    "Correct the value.");
}

Result<int> integer(const char* place, const std::string& word, int min, int max) {
  int value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc{} && end == word.data() + word.size() && value >= min && value <= max)
    return value;
  return usageError(place,
                    fmt::format("\"{}\" is not a whole number from {} to {}", word, min, max),
                    "Correct the value.");
}

Result<std::string> oneOf(const char* place, const std::string& word, const Words& known) {
  if (std::ranges::find(known, word) != known.end()) return word;
  const std::string near = nearestName(word, known);
  return usageError(place, fmt::format("unknown word \"{}\"", word),
                    near.empty() ? fmt::format("Known: {}.", fmt::join(known, ", "))
                                 : fmt::format("Did you mean \"{}\"?", near));
}

/// Stores a successful result, passes on the error of another.
template <class T, class U>
Result<void> store(Result<T> result, U& into) {
  if (!result) return std::unexpected(result.error());
  into = static_cast<U>(std::move(*result));
  return {};
}

Words splitAt(const std::string& text, char separator) {
  Words parts;
  std::size_t start = 0;
  for (std::size_t at; (at = text.find(separator, start)) != std::string::npos; start = at + 1)
    parts.push_back(text.substr(start, at - start));
  parts.push_back(text.substr(start));
  return parts;
}

Result<void> applyComponent(const Words& words, RunOptions& options) {
  Words known;
  for (const pipeline::Component& c : pipeline::components()) {
    if (words[0] == c.word || words[0] == std::to_string(c.number)) {
      options.component = c.number;
      return {};
    }
    known.push_back(c.word);
  }
  const std::string near = nearestName(words[0], known);
  return usageError("--component", fmt::format("unknown component \"{}\"", words[0]),
                    near.empty() ? "Give 1 to 17; `swallowclip list components` names them."
                                 : fmt::format("Did you mean \"{}\"?", near));
}

/// Whether the component has these scores is checked after all options are known.
Result<void> applyScore(const Words& words, RunOptions& options) {
  options.scores.clear();
  if (words[0] == "all") {
    options.scores = {0, 1, 2, 3, 4};
    return {};
  }
  for (const std::string& word : splitAt(words[0], ',')) {
    const auto score = integer("--score", word, 0, 4);
    if (!score)
      return usageError("--score", fmt::format("unknown score \"{}\"", word),
                        "Give 0, 1, 2, 3, 4 or all.");
    options.scores.push_back(*score);
  }
  std::ranges::sort(options.scores);
  const auto twice = std::ranges::unique(options.scores);
  options.scores.erase(twice.begin(), twice.end());
  return {};
}

/// Names are checked against the preset, which defines them (cli/names.h).
Result<void> applyViews(const Words& words, RunOptions& options) {
  options.views.clear();
  for (const std::string& word : splitAt(words[0], ','))
    if (std::ranges::find(options.views, word) == options.views.end())
      options.views.push_back(word);
  return {};
}

Result<void> applySets(const Words& words, RunOptions& options) {
  for (const std::string& word : words) {
    const std::size_t equals = word.find('='), dot = word.rfind('.', equals);
    if (equals == std::string::npos || dot == std::string::npos || dot == 0 || dot + 1 >= equals)
      return usageError("--set", fmt::format("\"{}\" is not of the form track.key=value", word),
                        "For example --set tongue.delay_s=3.");
    const auto value = number("--set", word.substr(equals + 1), -1e9, 1e9);
    if (!value) return std::unexpected(value.error());
    options.sets.push_back({word.substr(0, dot), word.substr(dot + 1, equals - dot - 1), *value});
  }
  return {};
}

template <auto member>
Result<void> applyText(const Words& words, RunOptions& options) {
  options.*member = words[0];
  return {};
}

Result<void> applySpacing(const Words& words, RunOptions& options) {
  // Below 0.5 mm 5 mL are 40 000 particles: days, not minutes. Above 4 mm they are 78.
  return store(number("--spacing-mm", words[0], 0.5, 4), options.spacing_mm);
}
Result<void> applySolver(const Words& words, RunOptions& options) {
  return store(oneOf("--solver", words[0], {"dfsph", "wcsph"}), options.solver);
}
Result<void> applyJobs(const Words& words, RunOptions& options) {
  return store(integer("--jobs", words[0], 1, 1024), options.jobs);
}
Result<void> applyFormat(const Words& words, RunOptions& options) {
  return store(oneOf("--format", words[0], {"csv", "obj", "vtp"}), options.format);
}
Result<void> applyTopic(const Words& words, RunOptions& options) {
  return store(
      oneOf("list", words[0], {"components", "scores", "views", "presets", "boluses", "scenes"}),
      options.topic);
}
Result<void> applyJson(const Words&, RunOptions& options) {
  options.json = true;
  return {};
}
Result<void> applySubset(const Words& words, RunOptions& options) {
  return store(oneOf("--subset", words[0], {"short", "all"}), options.verify.subset);
}
Result<void> applyVerifySolver(const Words& words, RunOptions& options) {
  return store(oneOf("--solver", words[0], {"dfsph", "wcsph"}), options.verify.solver);
}
Result<void> applyVerifySpacing(const Words& words, RunOptions& options) {
  return store(number("--spacing-mm", words[0], 0.2, 10), options.verify.spacing_mm);
}
Result<void> applyVerifyOut(const Words& words, RunOptions& options) {
  options.verify.out = words[0];
  return {};
}
Result<void> applyBench(const Words&, RunOptions& options) {
  options.verify.bench = true;
  return {};
}
Result<void> applyLibraryOut(const Words& words, RunOptions& options) {
  options.library.out = words[0];
  return {};
}
Result<void> applySpec(const Words& words, RunOptions& options) {
  options.library.spec = words[0];
  return {};
}
Result<void> applyEngine(const Words& words, RunOptions& options) {
  return store(oneOf("--engine", words[0], {"local", "slurm"}), options.library.engine);
}
Result<void> applyPlan(const Words&, RunOptions& options) {
  options.library.plan = true;
  return {};
}
Result<void> applyPublish(const Words&, RunOptions& options) {
  options.library.publish = true;
  return {};
}
Result<void> applyKey(const Words& words, RunOptions& options) {
  options.library.key = words[0];
  return {};
}
Result<void> applyFiles(const Words& words, RunOptions& options) {
  options.files.assign(words.begin(), words.end());
  return {};
}

constexpr unsigned kSwallow = kRender | kSimulate, kPictures = kRender | kDraw;

constexpr CommandRow kCommands[] = {
    {kRender, "render", "Simulate a swallow, measure it and film it, one clip per view"},
    {kSimulate, "simulate", "Simulate a swallow into a history file"},
    {kMeasure, "measure", "Measure events, quantities and scores of a history"},
    {kDraw, "draw", "Film a history again, without simulating"},
    {kExport, "export", "Write a history as files for other programs"},
    {kImport, "import", "Make a scene from meshes of one's own"},
    {kList, "list", "Show what can be chosen"},
    {kCheck, "check", "Check scene, swallow, bolus and preset files"},
    {kVerify, "verify", "Run the fluid solver on cases with known answers"},
    {kNightly, "nightly",
     "Bring the whole clip library up to date and publish it when it is whole"},
    {kJob, "job", "Make one product of the nightly plan, unless it is there already"},
};

constexpr OptionRow kOptions[] = {
    {"--component", "N", "Component to show, 1 to 17 or its word", kSwallow, 0, false,
     applyComponent},
    {"--score", "0|1|2|3|4|all", "Score to show, several with commas", kSwallow, 0, false,
     applyScore},
    {"--bolus", "NAME|FILE|none", "Bolus (default thesis-honey)", kSwallow, 0, false,
     applyText<&RunOptions::bolus>},
    {"--views", "LIST", "Views with commas (default oblique,ap,si)", kPictures, 0, false,
     applyViews},
    {"--scene", "NAME|DIR", "Anatomy (default adult)", kSwallow, 0, false,
     applyText<&RunOptions::scene>},
    {"--swallow", "FILE", "Swallow file instead of the one of component and score", kSwallow, 0,
     false, applyText<&RunOptions::swallow>},
    {"--set", "TRACK.KEY=VALUE", "Replace numbers of the swallow", kSwallow, 0, true, applySets},
    {"--preset", "NAME|FILE", "Look of the pictures (default training)", kPictures, 0, false,
     applyText<&RunOptions::preset>},
    {"--spacing-mm", "MM", "Particle spacing, 0.5 to 4 (default 2)", kSwallow, 0, false,
     applySpacing},
    {"--solver", "dfsph|wcsph", "Fluid solver (default dfsph)", kSwallow, 0, false, applySolver},
    {"--map", "FILE", "Which mesh is which structure", kImport, kImport, false,
     applyText<&RunOptions::map>},
    {"--format", "csv|obj|vtp", "File format (default csv)", kExport, 0, false, applyFormat},
    {"--json", "", "Print JSON instead of a table", kMeasure, 0, false, applyJson},
    {"--history", "FILE.h5", "History file to write", kSimulate, kSimulate, false,
     applyText<&RunOptions::history>},
    {"--out", "DIR", "Folder for results (default output)", kPictures | kExport | kImport, kImport,
     false, applyText<&RunOptions::out>},
    {"--jobs", "N", "Threads to use (default: all processors)",
     kSwallow | kDraw | kVerify | kNightly, 0, false, applyJobs},
    {"--checkpoint", "FILE",
     "Keep the state of the run in FILE, and go on from it when a run was interrupted", kSimulate,
     0, false, applyText<&RunOptions::checkpoint>},
    {"history", "RUN.h5", "History file to read", kMeasure | kDraw | kExport,
     kMeasure | kDraw | kExport, false, applyText<&RunOptions::history>},
    {"input", "DIR|FILE", "Meshes: a folder or one file", kImport, kImport, false,
     applyText<&RunOptions::input>},
    {"topic", "components|scores|views|presets|boluses|scenes", "What to list", kList, kList, false,
     applyTopic},
    {"files", "FILE...", "Files to check", kCheck, kCheck, true, applyFiles},
    {"cases", "CASE.json...", "Case files (default: all in scenes/verify)", kVerify, 0, true,
     applyFiles},
    {"--subset", "short|all", "Which of the shipped cases (default all)", kVerify, 0, false,
     applySubset},
    {"--solver", "dfsph|wcsph", "Fluid solver instead of that of every case", kVerify, 0, false,
     applyVerifySolver},
    {"--bench", "", "Time the solver beside published times instead of running cases", kVerify, 0,
     false, applyBench},
    {"--spacing-mm", "MM", "Particle spacing instead of that of every case, 0.2 to 10", kVerify, 0,
     false, applyVerifySpacing},
    {"--out", "DIR", "Folder for verify.json and charts (default output/verify)", kVerify, 0, false,
     applyVerifyOut},
    {"--spec", "FILE", "What the library is to hold (default scenes/nightly.json)", kNightly, 0,
     false, applySpec},
    {"--engine", "local|slurm", "Ninja on this machine, or a Slurm cluster (default local)",
     kNightly, 0, false, applyEngine},
    {"--plan", "", "Print the job graph, what is stale and why, and stop", kNightly, 0, false,
     applyPlan},
    {"--publish", "", "Run no job: check and publish what is there", kNightly, 0, false,
     applyPublish},
    {"--out", "DIR", "Folder of the library (default output/library)", kNightly | kJob, 0, false,
     applyLibraryOut},
    {"key", "KEY", "Key of the product, from nightly --plan", kJob, kJob, false, applyKey},
};
}  // namespace

std::span<const CommandRow> commandTable() {
  return kCommands;
}
std::span<const OptionRow> optionTable() {
  return kOptions;
}

std::string optionsPage() {
  std::string page = "# Commands and options\n\nMade from `src/cli/option_table.cpp`.\n";
  for (const CommandRow& command : kCommands) {
    page += fmt::format("\n## swallowclip {}\n\n{}.\n\n", command.word, command.help);
    for (const OptionRow& row : kOptions)
      if (row.commands & command.bit)
        page += fmt::format("- `{}{}{}`: {}{}\n", row.name, *row.value ? " " : "", row.value,
                            row.help, row.required & command.bit ? " (required)" : "");
  }
  return page;
}
}  // namespace swallowclip::cli
