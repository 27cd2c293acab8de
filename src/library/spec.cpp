// SPDX-License-Identifier: MIT
#include "library/spec.h"

#include <algorithm>
#include <map>
#include <set>

#include "pipeline/components.h"
#include "pipeline/scene_loader.h"
#include "scene/bolus_file.h"
#include "scene/json_reader.h"
#include "scene/preset_file.h"
#include "scene/swallow_file.h"

namespace swallowclip::library {
namespace {
namespace fs = std::filesystem;
using scene::JsonNode;

/// What the names in a spec can mean, and where problems with them are recorded.
class Names {
 public:
  explicit Names(const pipeline::RunOptions& options) : options_(options) {
    presets_ = scene::presetNames(options.presetsFolder());
    boluses_.push_back("none");
    if (auto list = scene::loadBoluses(options.scenesFolder()))
      for (const auto& b : *list) boluses_.push_back(b.name);
  }

  std::vector<std::string> boluses(const JsonNode& node, std::vector<std::string> otherwise) {
    return words(node, "boluses", boluses_, "bolus", std::move(otherwise));
  }
  std::vector<std::string> presets(const JsonNode& node, std::vector<std::string> otherwise) {
    return words(node, "presets", presets_, "preset", std::move(otherwise));
  }
  /// Views of all `presets`: every preset must have every view.
  std::vector<std::string> views(const JsonNode& node, const std::vector<std::string>& presets,
                                 std::vector<std::string> otherwise) {
    std::set<std::string> known;
    for (const std::string& name : presets) {
      const std::set<std::string>& here = viewsOf(node, name);
      if (known.empty()) known = here;
      std::erase_if(known, [&](const std::string& view) { return !here.contains(view); });
    }
    return words(node, "views", {known.begin(), known.end()}, "view", std::move(otherwise));
  }

 private:
  std::vector<std::string> words(const JsonNode& node, const char* key,
                                 const std::vector<std::string>& known, const char* what,
                                 std::vector<std::string> otherwise) {
    if (!node.has(key)) return otherwise;
    std::vector<std::string> found;
    for (const JsonNode& word : node.array(key)) {
      const std::string name = word.asText();
      if (name.empty()) continue;
      const std::string near = nearestName(name, known);
      if (std::ranges::find(known, name) == known.end())
        word.fail(fmt::format("unknown {} \"{}\"", what, name),
                  near.empty() ? fmt::format("Known: {}.", fmt::join(known, ", "))
                               : fmt::format("Did you mean \"{}\"?", near));
      else if (std::ranges::find(found, name) != found.end())
        word.fail(fmt::format("the {} \"{}\" twice", what, name), "Remove one of the two.");
      else
        found.push_back(name);
    }
    return found;
  }

  const std::set<std::string>& viewsOf(const JsonNode& node, const std::string& preset) {
    const auto [at, isNew] = views_.try_emplace(preset);
    if (!isNew) return at->second;
    auto loaded = scene::loadPreset(options_.presetsFolder(), preset);
    if (!loaded) {
      node.fail(fmt::format("preset \"{}\" can't be used: {}", preset, loaded.error().text()),
                "Correct the preset.");
      return at->second;
    }
    for (const auto& [name, view] : loaded->views) at->second.insert(name);
    return at->second;
  }

  const pipeline::RunOptions& options_;
  std::vector<std::string> presets_, boluses_;
  std::map<std::string, std::set<std::string>> views_;
};

std::vector<int> readScores(const JsonNode& node, const pipeline::Component& component) {
  std::vector<int> scores;
  const int highest = component.highestScore();
  if (node.has("scores") && node.member("scores").isText()) {
    if (node.text("scores") != "all")
      node.member("scores").fail("expected \"all\" or a list of scores", "Correct the value.");
    for (int s = 0; s <= highest; ++s) scores.push_back(s);
    return scores;
  }
  for (const JsonNode& item : node.array("scores")) {
    const int score = static_cast<int>(item.asNumber(0, highest));
    if (std::ranges::find(scores, score) != scores.end())
      item.fail(fmt::format("score {} twice", score), "Remove one of the two.");
    scores.push_back(score);
  }
  if (scores.empty()) node.fail("no scores", "Give \"scores\": \"all\", or a list.");
  return scores;
}

/// The swallow file must be readable and be meant for this very score.
void checkSwallow(const JsonNode& node, const SwallowEntry& entry) {
  auto def = scene::loadSwallow(entry.file);
  if (!def)
    return node.fail(
        fmt::format("component {}, score {}: {}", entry.component, entry.score, def.error().text()),
        "Write or correct the swallow file, or leave the score out.");
  if (def->component != entry.component || def->score != entry.score)
    node.fail(
        fmt::format("{} shows component {}, score {}, not component {}, score {}",
                    entry.file.string(), def->component, def->score, entry.component, entry.score),
        "Correct \"component\" and \"score\" here or there.");
}

void readSwallows(const JsonNode& root, Names& names, const SwallowEntry& defaults,
                  const pipeline::RunOptions& options, SpecDef& spec) {
  std::set<std::pair<int, int>> seen;
  for (const JsonNode& node : root.array("swallows")) {
    SwallowEntry entry;
    entry.component = node.integer("component", 1, 17);
    const pipeline::Component* component = pipeline::findComponent(entry.component);
    if (!component) continue;  // recorded by integer()
    entry.boluses = names.boluses(node, defaults.boluses);
    entry.presets = names.presets(node, defaults.presets);
    entry.views = names.views(node, entry.presets, defaults.views);
    const std::string own = node.text("swallow", "");
    const std::vector<int> scores = readScores(node, *component);
    if (!own.empty() && scores.size() > 1)
      node.fail("one swallow file shows one score", "Give one score, or leave \"swallow\" out.");
    for (const int score : scores) {
      entry.score = score;
      entry.file = own.empty() ? options.scenesFolder() / "swallows" /
                                     fmt::format("c{:02}-s{}.json", entry.component, score)
                               : spec.file.parent_path() / own;
      if (!seen.insert({entry.component, score}).second)
        node.fail(fmt::format("component {}, score {} a second time", entry.component, score),
                  "Clips are named by component and score: remove one of the two.");
      checkSwallow(node, entry);
      spec.swallows.push_back(entry);
    }
  }
  if (root.has("swallows") && spec.swallows.empty())
    root.member("swallows").fail("no swallow", "Add {\"component\": 4, \"scores\": \"all\"}.");
}

void readPublish(const JsonNode& root, PublishDef& d) {
  if (!root.has("publish")) return;
  const JsonNode node = root.object("publish");
  d.labelsConfirmed = node.choice("labels", {"confirmed", "any"}, "confirmed") == "confirmed";
  d.missingClipsAllowed = node.integer("missing_clips_allowed", 0, 100000, d.missingClipsAllowed);
  d.keepNights = node.integer("keep_nights", 1, 10000, d.keepNights);
  d.keep_gb = node.number("keep_gb", 0, 1e6, d.keep_gb);
}

void readSheet(const JsonNode& root, SheetDef& d) {
  if (!root.has("sheet")) return;
  const JsonNode node = root.object("sheet");
  d.columns = node.integer("columns", 1, 12, d.columns);
  d.rows = node.integer("rows", 1, 12, d.rows);
  d.width_px = node.integer("width_px", 32, 640, d.width_px);
}
}  // namespace

Result<SpecDef> loadSpec(const fs::path& path, const pipeline::RunOptions& given) {
  auto file = scene::JsonFile::load(path);
  if (!file) return std::unexpected(file.error());
  const JsonNode root = file->root();
  pipeline::RunOptions options = given;
  SpecDef spec;
  spec.file = path;
  spec.scene = options.scene = root.text("scene", spec.scene);
  if (auto scene = pipeline::loadScene(options); !scene)
    root.fail(fmt::format("scene \"{}\": {}", spec.scene, scene.error().text()),
              "Name a scene that `swallowclip list scenes` shows, or a folder.");
  spec.solver = root.choice("solver", {"dfsph", "wcsph"}, spec.solver);
  spec.spacing_mm = root.number("spacing_mm", 0.5, 4, spec.spacing_mm);
  Names names(options);
  SwallowEntry defaults;
  defaults.boluses = names.boluses(root, {"thesis-honey"});
  defaults.presets = names.presets(root, {"training"});
  defaults.views = names.views(root, defaults.presets, {"oblique", "ap", "si"});
  readSheet(root, spec.sheet);
  readPublish(root, spec.publish);
  readSwallows(root, names, defaults, options, spec);
  const std::vector<Error> problems = file->problems();
  if (problems.empty()) return spec;
  std::string text = fmt::format("{} problem{}", problems.size(), problems.size() > 1 ? "s" : "");
  for (const Error& e : problems) text += fmt::format("\n{}", e.text());
  return usageError(path.string(), text, "");
}
}  // namespace swallowclip::library
