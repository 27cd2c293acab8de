// SPDX-License-Identifier: MIT
#include "library/manifest.h"

#include "core/digest.h"
#include "library/sealed.h"
#include "scene/json_text.h"

namespace swallowclip::library {
namespace {
using scene::quotedJson;

/// A number, or null: as it stands in measures.json.
std::string scoreText(const scene::JsonNode& node) {
  return node.isNumber() ? fmt::format("{}", node.asNumber(0, 4)) : "null";
}

std::string filesText(const std::vector<StoredFile>& files) {
  std::string text;
  for (const StoredFile& f : files)
    text += fmt::format("{}\n    {{\"path\": {}, \"bytes\": {}, \"sha256\": \"{}\"}}",
                        text.empty() ? "" : ",", quotedJson(f.name), f.bytes, f.sha256);
  return text;
}

template <class Map, class Value>
std::string mapText(const Map& map, Value value) {
  std::string text;
  for (const auto& [key, v] : map)
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", quotedJson(key), value(v));
  return text;
}

/// The files of a clip by their place in the night: `kind` -> product file.
void addFiles(const PlannedClip& clip, const Plan& plan, NightClip& into) {
  const auto add = [&](int stage, const std::string& file, const std::string& kind) {
    const Marker& m = *plan.jobs[clip.jobs[stage]].marker;
    if (const StoredFile* f = m.file(file))
      into.files.push_back({nightPath(into, kind), f->bytes, f->sha256});
  };
  const std::string stem = std::filesystem::path(clip.name).filename().string();
  for (const char* kind : {".mp4", ".png", ".vtt"}) add(3, stem + kind, kind);
  add(2, "measures.json", ".json");
  add(4, "sheet.png", "sheet");
  add(4, "thumb.png", "thumb");
}
}  // namespace

std::string nightPath(const NightClip& clip, const std::string& kind) {
  if (kind == "sheet" || kind == "thumb") return kind + "s/" + clip.name + ".png";
  if (kind == ".json") return clip.name.substr(0, clip.name.rfind('-')) + kind;  // of all views
  return clip.name + kind;
}

Result<Measured> readMeasured(const std::filesystem::path& path) {
  auto file = scene::JsonFile::load(path);
  if (!file) return std::unexpected(file.error());
  const scene::JsonNode root = file->root();
  Measured m;
  // Null, when nothing could be judged, is no confirmation.
  m.labelConfirmed = root.boolean("label_confirmed", false);
  m.labelReason = root.text("label_reason", "");
  for (const auto& [component, node] : root.object("scores_measured").members())
    m.scores[component] = scoreText(node);
  for (const auto& [name, node] : root.object("quantities").members())
    if (node.member("value").isNumber()) m.quantities[name] = node.number("value", -1e300, 1e300);
  return m;
}

Night gatherNight(const Plan& plan, const Root& root) {
  Night night;
  night.draft = !plan.spec.publish.labelsConfirmed;
  for (const PlannedClip& clip : plan.clips) {
    std::string why, failed;
    for (const int k : clip.jobs)
      if (const PlannedJob& p = plan.jobs[k]; p.stale() && why.empty()) {
        why = p.job.name + " failed";
        failed = p.job.key;
      }
    if (!why.empty()) {
      night.missing.push_back({clip.name, why, failed});
      continue;
    }
    auto measured = readMeasured(root.product(plan.jobs[clip.jobs[2]].job.key) / "measures.json");
    if (!measured) {
      night.missing.push_back({clip.name, measured.error().text(), ""});
      continue;
    }
    if (!measured->labelConfirmed && !night.draft) {
      night.missing.push_back({clip.name, "label not confirmed: " + measured->labelReason, ""});
      continue;
    }
    NightClip c;
    c.name = clip.name;
    c.key = plan.jobs[clip.jobs[3]].job.key;
    c.historyKey = plan.jobs[clip.jobs[1]].job.key;
    for (const int k : clip.jobs)
      for (const RecipeLine& line : plan.jobs[k].job.recipe)
        if (line.what.starts_with("file ")) c.inputs[line.what.substr(5)] = line.value;
    c.measured = std::move(*measured);
    addFiles(clip, plan, c);
    night.clips.push_back(std::move(c));
  }
  return night;
}

std::map<std::string, StoredFile> Night::files() const {
  std::map<std::string, StoredFile> all;
  for (const NightClip& c : clips)
    for (const StoredFile& f : c.files) all[f.name] = f;
  return all;
}

const NightClip* Night::find(const std::string& clip) const {
  for (const NightClip& c : clips)
    if (c.name == clip) return &c;
  return nullptr;
}

std::string Night::content() const {
  std::string all = draft ? "draft\n" : "";
  for (const auto& [path, f] : files()) all += f.sha256 + "  " + path + "\n";
  for (const MissingClip& m : missing) all += "missing " + m.name + "\n";
  return sha256Hex(all);
}

std::string sumsText(const Night& night) {
  std::string text = sha256Hex(manifestText(night)) + "  manifest.json\n";
  for (const auto& [path, f] : night.files()) text += f.sha256 + "  " + path + "\n";
  return text;
}

std::string manifestText(const Night& night) {
  std::string clips, missing;
  for (const NightClip& c : night.clips)
    clips += fmt::format(
        "{}\n  {{\"clip\": {}, \"key\": \"{}\", \"history_key\": \"{}\", \"label_confirmed\": {},\n"
        "   \"label_reason\": {},\n   \"scores_measured\": {{{}}},\n   \"inputs\": {{{}}},\n"
        "   \"files\": [{}]}}",
        clips.empty() ? "" : ",", quotedJson(c.name), c.key, c.historyKey,
        c.measured.labelConfirmed, quotedJson(c.measured.labelReason),
        mapText(c.measured.scores, [](const std::string& s) { return s; }),
        mapText(c.inputs, [](const std::string& s) { return quotedJson(s); }), filesText(c.files));
  for (const MissingClip& m : night.missing)
    missing += fmt::format("{}\n  {{\"clip\": {}, \"why\": {}}}", missing.empty() ? "" : ",",
                           quotedJson(m.name), quotedJson(m.why));
  return sealed(fmt::format(
      "\"night\": {}, \"version\": \"{}\", \"draft\": {}, \"content\": \"{}\",\n"
      "\"credit\": \"Training illustrations, not for diagnosis. MBSImP is named only to say what "
      "a clip shows.\",\n\"missing\": [{}],\n\"clips\": [{}]",
      quotedJson(night.name), SWALLOWCLIP_VERSION, night.draft, night.content(), missing, clips));
}

Result<Night> readManifest(const std::filesystem::path& path) {
  auto file = readSealed(path);
  if (!file) return std::unexpected(file.error());
  const scene::JsonNode root = file->root();
  Night night;
  night.name = root.text("night");
  night.draft = root.boolean("draft", false);
  for (const auto& node : root.array("missing"))
    night.missing.push_back({node.text("clip"), node.text("why"), ""});
  for (const auto& node : root.array("clips")) {
    NightClip& c = night.clips.emplace_back();
    c.name = node.text("clip");
    c.key = node.text("key");
    c.historyKey = node.text("history_key");
    c.measured.labelConfirmed = node.boolean("label_confirmed", false);
    c.measured.labelReason = node.text("label_reason");
    for (const auto& f : node.array("files"))
      c.files.push_back({f.text("path"), static_cast<std::uintmax_t>(f.number("bytes", 0, 1e15)),
                         f.text("sha256")});
  }
  return night;
}
}  // namespace swallowclip::library
