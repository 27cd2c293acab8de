// SPDX-License-Identifier: MIT
#include "scene/file_kind.h"

#include "scene/bolus_file.h"
#include "scene/json_reader.h"
#include "scene/palette_file.h"
#include "scene/preset_file.h"
#include "scene/rules_file.h"

namespace swallowclip::scene {

Result<FileKind> fileKind(const std::filesystem::path& path) {
  const auto file = JsonFile::load(path);
  if (!file) return std::unexpected(file.error());
  const JsonNode root = file->root();
  if (!root.isObject()) return FileKind::other;
  if (root.has("boluses")) return FileKind::bolusList;
  if (root.has("rheology")) return FileKind::bolus;
  if (root.has("views") || root.has("base")) {
    // swallow files have a base too; theirs is a file name
    if (root.has("views") || !root.text("base").ends_with(".json")) return FileKind::preset;
  }
  if (root.has("palette")) return FileKind::palette;
  if (root.has("residue_rule")) return FileKind::scoringRules;
  return FileKind::other;
}

Result<void> checkFile(const std::filesystem::path& path, FileKind kind,
                       const std::filesystem::path& presetsFolder) {
  const auto outcome = [](const auto& loaded) -> Result<void> {
    if (!loaded) return std::unexpected(loaded.error());
    return {};
  };
  switch (kind) {
    case FileKind::preset:
      return outcome(loadPresetFile(path, presetsFolder));
    case FileKind::palette:
      return outcome(loadPalette(presetsFolder, path.string()));
    case FileKind::bolusList:
      return outcome(loadBolusList(path));
    case FileKind::bolus:
      return outcome(loadBolusFile(path));
    case FileKind::scoringRules:
      return outcome(loadScoringRules(path));
    case FileKind::other:
      break;
  }
  return {};
}
}  // namespace swallowclip::scene
