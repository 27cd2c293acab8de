// SPDX-License-Identifier: MIT
#include "library/job.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "core/digest.h"
#include "core/file.h"
#include "library/sealed.h"
#include "library/versions.h"
#include "scene/json_text.h"
#include "scene/preset_file.h"
#include "scene/rules_file.h"
#include "scene/swallow_file.h"

namespace swallowclip::library {
namespace fs = std::filesystem;
namespace {
constexpr const char* kNames[] = {"bake", "simulate", "measure", "draw", "verify"};
constexpr std::size_t kKeyDigits = 32;  // 128 bits: no two recipes will ever meet

/// All files below a folder in order, hidden ones and remarks (*.md) apart; links are not followed.
Result<std::vector<fs::path>> filesBelow(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ec;
  for (fs::recursive_directory_iterator at(folder, ec), end; !ec && at != end; at.increment(ec))
    if (at->is_regular_file(ec) && at->path().extension() != ".md" &&
        !at->path().filename().string().starts_with('.'))
      files.push_back(at->path());
  if (ec)
    return failure(folder.string(), fmt::format("can't be read ({})", ec.message()),
                   "Check its permissions.");
  std::ranges::sort(files);
  return files;
}

struct Cook {
  Job& job;
  Inputs& inputs;

  void add(std::string what, std::string value) {
    job.recipe.push_back({std::move(what), std::move(value)});
  }
  Result<void> file(const fs::path& path, const std::string& list = "",
                    const std::string& member = "") {
    auto digest = inputs.digest(path, list, member);
    if (!digest) return std::unexpected(digest.error());
    add(fmt::format("file {}{}{}", path.filename().string(), member.empty() ? "" : " ", member),
        *digest);
    return {};
  }
  Result<void> folder(const fs::path& path) {
    auto files = filesBelow(path);
    if (!files) return std::unexpected(files.error());
    for (const fs::path& f : *files)
      if (auto done = file(f); !done) return done;
    return {};
  }

  Result<void> motion() {
    const Choice& c = job.choice;
    const pipeline::RunOptions o = c.options();
    add("scene", c.scene);
    add("frames per second", fmt::format("{}", c.fps));
    if (auto done = folder(o.sceneFolder()); !done) return done;
    if (o.sceneFolder() != o.scenesFolder() / "adult")  // imported ones lend its soft parts
      if (auto done = folder(o.scenesFolder() / "adult"); !done) return done;
    auto files = scene::swallowFiles(c.swallow);
    if (!files) return std::unexpected(files.error());
    for (const fs::path& f : *files)
      if (auto done = file(f); !done) return done;
    return {};
  }

  Result<void> fluid() {
    const Choice& c = job.choice;
    add("bolus", c.bolus);
    if (c.bolus == "none") return {};
    add("solver", c.solver);
    add("spacing mm", fmt::format("{}", c.spacing_mm));
    return file(c.data / "scenes" / "boluses.json", "boluses", c.bolus);
  }

  Result<void> picture() {
    const Choice& c = job.choice;
    add("clip", fmt::format("{}-{}", c.stem(), c.view));
    if (auto done = folder(c.data / "shaders"); !done) return done;
    // Captions are set in DejaVu Sans; where it is not installed fontconfig takes another.
    const fs::path font = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
    std::error_code ec;
    if (fs::exists(font, ec))
      if (auto done = file(font); !done) return done;
    auto look = scene::presetFiles(c.options().presetsFolder(), c.preset);
    if (!look) return std::unexpected(look.error());
    for (const fs::path& f : *look)
      if (auto done = file(f, "views", c.view); !done) return done;
    return {};
  }
};
}  // namespace

const char* name(Stage stage) {
  return kNames[static_cast<int>(stage)];
}

std::optional<Stage> stageFromName(const std::string& word) {
  for (const Stage s : kStages)
    if (word == name(s)) return s;
  return std::nullopt;
}

pipeline::RunOptions Choice::options() const {
  pipeline::RunOptions o;
  o.data = data;
  o.scene = scene;
  o.solver = solver;
  o.spacing_mm = spacing_mm;
  o.component = component;
  o.scores = {score};
  o.swallow = swallow;
  o.bolus = bolus;
  o.preset = preset;
  o.views = {view};
  o.jobs = 1;  // the engine runs as many jobs as there are processors
  return o;
}

std::string Choice::stem() const {
  return fmt::format("c{:02}-s{}-{}", component, score, bolus);
}

Result<std::string> Inputs::digest(const fs::path& file, const std::string& list,
                                   const std::string& member) {
  const std::string id = file.string() + "\n" + member;
  if (const auto at = known_.find(id); at != known_.end()) return at->second;
  auto text =
      file.extension() == ".json" ? scene::canonicalJson(file, list, member) : readFile(file);
  if (!text) return std::unexpected(text.error());
  return known_[id] = sha256Hex(*text);
}

Result<void> cook(Job& job, Inputs& inputs) {
  job.recipe.clear();
  Cook cook{job, inputs};
  cook.add("stage", name(job.stage));
  cook.add("our sources", sourceVersion(job.stage));
  cook.add("libraries", libraryVersions(job.stage));
  for (const std::string& key : job.needs) cook.add("product", key);
  Result<void> done;
  if (job.stage == Stage::bake || job.stage == Stage::simulate) done = cook.motion();
  if (done && job.stage == Stage::simulate) done = cook.fluid();
  if (done && job.stage == Stage::draw) done = cook.picture();
  if (done && (job.stage == Stage::measure || job.stage == Stage::draw))
    done = cook.file(scene::scoringRulesFile(job.choice.options().scenesFolder()));
  if (!done) return done;
  if (job.stage == Stage::verify) {
    const SheetDef& s = job.choice.sheet;
    cook.add("sheet", fmt::format("{} x {} of {} px", s.columns, s.rows, s.width_px));
  }
  std::string text;
  for (const RecipeLine& line : job.recipe) text += line.what + "\t" + line.value + "\n";
  job.key = sha256Hex(text).substr(0, kKeyDigits);
  return {};
}

std::string jobText(const Job& job) {
  const Choice& c = job.choice;
  const auto quoted = scene::quotedJson;
  std::string needs;
  for (const std::string& key : job.needs)
    needs += fmt::format("{}\"{}\"", needs.empty() ? "" : ", ", key);
  return sealed(fmt::format(
      "\"key\": \"{}\", \"stage\": \"{}\", \"name\": {},\n\"needs\": [{}],\n"
      "\"data\": {}, \"scene\": {}, \"solver\": \"{}\", \"spacing_mm\": {}, \"fps\": {},\n"
      "\"component\": {}, \"score\": {}, \"swallow\": {}, \"bolus\": {},\n"
      "\"preset\": {}, \"view\": {}, \"sheet\": [{}, {}, {}]",
      job.key, name(job.stage), quoted(job.name), needs, quoted(c.data.string()), quoted(c.scene),
      c.solver, c.spacing_mm, c.fps, c.component, c.score, quoted(c.swallow.string()),
      quoted(c.bolus), quoted(c.preset), quoted(c.view), c.sheet.columns, c.sheet.rows,
      c.sheet.width_px));
}

Result<Job> readJob(const fs::path& path) {
  auto file = readSealed(path);
  if (!file) return std::unexpected(file.error());
  const scene::JsonNode root = file->root();
  Job job;
  job.key = root.text("key");
  job.stage = stageFromName(root.text("stage")).value_or(Stage::bake);
  job.name = root.text("name");
  job.needs = root.texts("needs");
  Choice& c = job.choice;
  c.data = root.text("data");
  c.scene = root.text("scene");
  c.solver = root.text("solver");
  c.spacing_mm = root.number("spacing_mm", 0.5, 4);
  c.fps = root.number("fps", 1, 1000);
  c.component = root.integer("component", 1, 17);
  c.score = root.integer("score", 0, 4);
  c.swallow = root.text("swallow");
  c.bolus = root.text("bolus");
  c.preset = root.text("preset");
  c.view = root.text("view");
  const std::vector<double> sheet = root.numbers("sheet");
  if (sheet.size() == 3)
    c.sheet = {static_cast<int>(sheet[0]), static_cast<int>(sheet[1]), static_cast<int>(sheet[2])};
  if (auto done = file->finish(); !done) return std::unexpected(done.error());
  return job;
}
}  // namespace swallowclip::library
