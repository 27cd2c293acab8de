// SPDX-License-Identifier: MIT
#include "cli/option_table.h"

#include <algorithm>
#include <cmath>

#include "cli/option_words.h"
#include "pipeline/components.h"

namespace swallowclip::cli {
namespace {
using pipeline::RunOptions;

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

/// from:to:step, for sweep.
Result<pipeline::TrackRange> range(const std::string& word, std::string track, std::string key,
                                   const Words& parts) {
  pipeline::TrackRange r{std::move(track), std::move(key)};
  double* const numbers[] = {&r.from, &r.to, &r.step};
  for (std::size_t k = 0; k < parts.size(); ++k)
    if (auto ok = store(number("--set", parts[k], -1e9, 1e9), *numbers[k]); !ok)
      return std::unexpected(ok.error());
  constexpr double kMostSteps = 200;
  if (parts.size() != 3 || !(r.step > 0) || !(r.to > r.from) ||
      (r.to - r.from) / r.step > kMostSteps)
    return usageError("--set", fmt::format("\"{}\" is no range", word),
                      "Give track.key=from:to:step, rising, of at most 200 steps.");
  return r;
}

Result<void> applySets(const Words& words, RunOptions& options) {
  for (const std::string& word : words) {
    const std::size_t equals = word.find('='), dot = word.rfind('.', equals);
    if (equals == std::string::npos || dot == std::string::npos || dot == 0 || dot + 1 >= equals)
      return usageError("--set", fmt::format("\"{}\" is not of the form track.key=value", word),
                        "For example --set larynx.delay_s=0.3.");
    const std::string track = word.substr(0, dot), key = word.substr(dot + 1, equals - dot - 1);
    const Words parts = splitAt(word.substr(equals + 1), ':');
    if (parts.size() > 1) {
      if (options.range)
        return usageError("--set", "a sweep runs over one range", "Give the others one value.");
      if (auto ok = store(range(word, track, key, parts), options.range); !ok) return ok;
      continue;
    }
    const auto value = number("--set", parts[0], -1e9, 1e9);
    if (!value) return std::unexpected(value.error());
    options.sets.push_back({track, key, *value});
  }
  return {};
}

template <auto member>
Result<void> applyText(const Words& words, RunOptions& options) {
  options.*member = words[0];
  return {};
}

Result<void> applyVolume(const Words& words, RunOptions& options) {
  return store(number("--volume-ml", words[0], 1, 20), options.volume_mL);
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
Result<void> applyDrawBench(const Words&, RunOptions& options) {
  options.bench = true;
  return {};
}
Result<void> applyBench(const Words&, RunOptions& options) {
  options.verify.bench = true;
  return {};
}
/// Options of `events` and `overlay`: texts, switches, and what has a form of its own.
template <auto member>
Result<void> applyOverlay(const Words& words, RunOptions& options) {
  options.overlay.*member = words[0];
  return {};
}
template <auto member>
Result<void> applyOverlaySwitch(const Words&, RunOptions& options) {
  options.overlay.*member = true;
  return {};
}
Result<void> applyLayout(const Words& words, RunOptions& options) {
  return store(oneOf("--layout", words[0], {"side-by-side", "superimposed", "both"}),
               options.overlay.layout);
}
Result<void> applyStyle(const Words& words, RunOptions& options) {
  return store(oneOf("--style", words[0], {"outlines", "translucent"}), options.overlay.style);
}
Result<void> applyFrameRate(const Words& words, RunOptions& options) {
  return store(number("--frame-rate", words[0], 0.1, 1000), options.overlay.frameRate_hz);
}
Result<void> applyPanes(const Words& words, RunOptions& options) {
  options.overlay.views = splitAt(words[0], ',');
  if (options.overlay.views.size() > 4)
    return usageError("--views", "more than four views", "Give one to four.");
  return {};
}
Result<void> applyMasks(const Words& words, RunOptions& options) {
  for (const std::string& word : words) {
    const Words parts = splitAt(word, ',');
    std::array<int, 4> mask{};
    for (std::size_t i = 0; i < 4; ++i) {
      const auto value = integer("--mask", i < parts.size() ? parts[i] : "", 0, 8192);
      if (!value || parts.size() != 4)
        return usageError("--mask", "not of the form X,Y,WIDTH,HEIGHT",
                          "Count pixels of the study from its upper left corner.");
      mask[i] = *value;
    }
    options.overlay.masks.push_back(mask);
  }
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

using pipeline::OverlayOptions;
constexpr unsigned kSwallow = kRender | kSimulate | kSweep | kOverlay, kPictures = kRender | kDraw,
                   kStudy = kEvents | kOverlay;

constexpr CommandRow kCommands[] = {
    {kRender, "render", "Simulate a swallow, measure it and film it, one clip per view"},
    {kSimulate, "simulate", "Simulate a swallow into a history file"},
    {kSweep, "sweep", "Run a swallow over a range of one number and chart what changes"},
    {kMeasure, "measure", "Measure events, quantities and scores of a history"},
    {kDraw, "draw", "Film a history again, without simulating"},
    {kExport, "export", "Write a history as files for other programs"},
    {kImport, "import", "Make a scene from meshes of one's own"},
    {kList, "list", "Show what can be chosen"},
    {kCheck, "check",
     "Check scene, swallow, bolus and preset files, or what the views of a history show"},
    {kConfusion, "confusion",
     "Simulate every built-in score; print intended against measured scores"},
    {kVerify, "verify", "Run the fluid solver on cases with known answers"},
    {kEvents, "events", "Number the frames of a videofluoroscopy on contact sheets"},
    {kOverlay, "overlay", "Film the model beside a videofluoroscopy, or on it"},
    {kNightly, "nightly",
     "Bring the whole clip library up to date and publish it when it is whole"},
    {kJob, "job", "Make one product of the nightly plan, unless it is there already"},
};

constexpr OptionRow kOptions[] = {
    {"--component", "N", "Component to show, 1 to 17 or its word", kSwallow | kConfusion, 0, false,
     applyComponent},
    {"--score", "0|1|2|3|4|all", "Score to show, several with commas", kSwallow, 0, false,
     applyScore},
    {"--bolus", "NAME|FILE|none", "Bolus (default thesis-honey)", kSwallow, 0, false,
     applyText<&RunOptions::bolus>},
    {"--volume-ml", "ML", "Volume of the bolus, 1 to 20 (default 5)", kSwallow, 0, false,
     applyVolume},
    {"--views", "LIST", "Views with commas (default oblique,ap,si)", kPictures, 0, false,
     applyViews},
    {"--scene", "NAME|DIR", "Anatomy (default adult)", kSwallow, 0, false,
     applyText<&RunOptions::scene>},
    {"--swallow", "FILE", "Swallow file instead of the one of component and score", kSwallow, 0,
     false, applyText<&RunOptions::swallow>},
    {"--set", "TRACK.KEY=VALUE",
     "Replace numbers of the swallow; for sweep one of them as FROM:TO:STEP", kSwallow, kSweep,
     true, applySets},
    {"--compare", "RUN.h5", "History of the unchanged swallow: print what --set changes",
     kRender | kSimulate, 0, false, applyText<&RunOptions::compare>},
    {"--preset", "NAME|FILE", "Look of the pictures (default training)",
     kPictures | kCheck | kOverlay, 0, false, applyText<&RunOptions::preset>},
    {"--spacing-mm", "MM", "Particle spacing, 0.5 to 4 (default 2)", kSwallow, 0, false,
     applySpacing},
    {"--solver", "dfsph|wcsph", "Fluid solver (default dfsph)", kSwallow, 0, false, applySolver},
    {"--map", "FILE", "Which mesh is which structure", kImport, kImport, false,
     applyText<&RunOptions::map>},
    {"--format", "csv|obj|vtp", "File format (default csv)", kExport, 0, false, applyFormat},
    {"--plot", "FILE.svg|.png", "Also draw the swallow sheet", kMeasure, 0, false,
     applyText<&RunOptions::plot>},
    {"--json", "", "Print JSON instead of a table", kMeasure, 0, false, applyJson},
    {"--history", "FILE.h5", "History file to write", kSimulate, kSimulate, false,
     applyText<&RunOptions::history>},
    {"--out", "DIR", "Folder for results (default output)",
     kPictures | kExport | kImport | kSweep | kEvents, kImport | kEvents, false,
     applyText<&RunOptions::out>},
    {"--jobs", "N", "Threads to use (default: all processors)",
     kSwallow | kDraw | kVerify | kConfusion | kNightly, 0, false, applyJobs},
    {"--checkpoint", "FILE",
     "Keep the state of the run in FILE, and go on from it when a run was interrupted", kSimulate,
     0, false, applyText<&RunOptions::checkpoint>},
    {"history", "RUN.h5", "History file to read", kMeasure | kDraw | kExport,
     kMeasure | kDraw | kExport, false, applyText<&RunOptions::history>},
    {"--bench", "", "Print what a frame costs instead of filming", kDraw, 0, false, applyDrawBench},
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
    {"study", "STUDY", "Video or DICOM file", kEvents, kEvents, false,
     applyOverlay<&OverlayOptions::vf>},
    {"--vf", "STUDY", "Videofluoroscopy: video or DICOM file", kOverlay, 0, false,
     applyOverlay<&OverlayOptions::vf>},
    {"--events", "FILE", "Its events and landmarks, JSON or CSV", kOverlay, 0, false,
     applyOverlay<&OverlayOptions::events>},
    {"--demo", "", "Make the study from simulated fluoroscopy of another swallow", kOverlay, 0,
     false, applyOverlaySwitch<&OverlayOptions::demo>},
    {"--history", "RUN.h5", "History of the model (default: simulate component and score)",
     kOverlay, 0, false, applyText<&RunOptions::history>},
    {"--layout", "side-by-side|superimposed|both", "Where the model goes (default side-by-side)",
     kOverlay, 0, false, applyLayout},
    {"--style", "outlines|translucent", "Look of the model on the X-ray (default outlines)",
     kOverlay, 0, false, applyStyle},
    {"--views", "LIST", "One to four views beside the X-ray (default oblique)", kOverlay, 0, false,
     applyPanes},
    {"--resimulate", "", "Move the motion and simulate again, instead of warping time", kOverlay, 0,
     false, applyOverlaySwitch<&OverlayOptions::resimulate>},
    {"--out", "FILE.mp4", "Clip to write (default with --demo: output/overlay/demo.mp4)", kOverlay,
     0, false, applyOverlay<&OverlayOptions::out>},
    {"--dicom", "", "Write the clip as a derived DICOM object too", kOverlay, 0, false,
     applyOverlaySwitch<&OverlayOptions::dicom>},
    {"--mask", "X,Y,WIDTH,HEIGHT", "Black out rectangles with patient text, in study pixels",
     kStudy, 0, true, applyMasks},
    {"--no-burned-in-text", "", "Vouch that no patient text is burned into the pixels", kStudy, 0,
     false, applyOverlaySwitch<&OverlayOptions::noBurnedInText>},
    {"--keep-border", "", "Do not black out what lies outside the X-ray's opening", kStudy, 0,
     false, applyOverlaySwitch<&OverlayOptions::keepBorder>},
    {"--frame-rate", "HZ", "Rate of a study that holds no frame times", kStudy, 0, false,
     applyFrameRate},
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
