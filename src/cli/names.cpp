// SPDX-License-Identifier: MIT
#include "cli/names.h"

#include <algorithm>

#include "scene/bolus_file.h"
#include "scene/preset_file.h"

namespace swallowclip::cli {
namespace {
namespace fs = std::filesystem;
using pipeline::RunOptions;

Result<void> checkViews(const RunOptions& options, const std::vector<std::string>& views) {
  auto preset = scene::loadPreset(options.presetsFolder(), options.preset);
  if (!preset) return std::unexpected(preset.error());
  std::vector<std::string> known;
  for (const auto& [name, view] : preset->views) known.push_back(name);
  for (const std::string& view : views) {
    if (std::ranges::find(known, view) != known.end()) continue;
    const std::string near = nearestName(view, known);
    return usageError("--views", fmt::format("preset {} has no view \"{}\"", preset->name, view),
                      near.empty() ? fmt::format("Known: {}.", fmt::join(known, ", "))
                                   : fmt::format("Did you mean \"{}\"?", near));
  }
  return {};
}

bool isScene(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / "anatomy.json", error) || fs::exists(folder / "scene.json", error);
}

Result<void> checkScene(const RunOptions& options) {
  std::error_code error;
  if (isScene(options.sceneFolder())) return {};
  if (fs::is_directory(options.sceneFolder(), error))
    return usageError("--scene",
                      fmt::format("{} holds neither an anatomy.json nor a scene.json",
                                  options.sceneFolder().string()),
                      "Name a folder that `import` has made, or one like scenes/adult.");
  std::vector<std::string> known;
  for (const auto& entry : fs::directory_iterator(options.scenesFolder(), error))
    if (isScene(entry.path())) known.push_back(entry.path().filename().string());
  std::ranges::sort(known);
  const std::string near = nearestName(options.scene, known);
  return usageError("--scene", fmt::format("unknown scene \"{}\"", options.scene),
                    near.empty() ? fmt::format("Known: {}; or a folder.", fmt::join(known, ", "))
                                 : fmt::format("Did you mean \"{}\"?", near));
}

Result<void> checkReadable(const char* place, const fs::path& path, bool folderToo) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_regular_file(status) || (folderToo && fs::is_directory(status))) return {};
  return usageError(
      place,
      fmt::format("{}: {}", path.string(), fs::exists(status) ? "not a file" : "no such file"),
      "Check the name and the folder.");
}
}  // namespace

Result<void> checkNames(CommandBit command, const RunOptions& options) {
  if (command & (kRender | kSimulate | kSweep)) {
    if (auto found = checkScene(options); !found) return found;
    if (options.hasBolus())
      if (auto bolus = scene::loadBolus(options.scenesFolder(), options.bolus); !bolus)
        return std::unexpected(bolus.error());
    if (!options.swallow.empty())
      if (auto found = checkReadable("--swallow", options.swallow, false); !found) return found;
  }
  if (command & (kRender | kDraw))
    if (auto found = checkViews(options, options.views); !found) return found;
  if (command == kOverlay) {
    if (auto found = checkViews(options, options.overlay.views); !found) return found;
    if (options.history.empty() || options.overlay.demo || options.overlay.resimulate)
      if (auto found = checkScene(options); !found) return found;
    if (!options.history.empty())
      if (auto found = checkReadable("--history", options.history, false); !found) return found;
  }
  if (command & (kMeasure | kDraw | kExport))
    if (auto found = checkReadable("history", options.history, false); !found) return found;
  if (command & kImport) {
    if (auto found = checkReadable("import", options.input, true); !found) return found;
    if (auto found = checkReadable("--map", options.map, false); !found) return found;
  }
  for (const fs::path& file : options.files)
    if (auto found =
            checkReadable(command == kVerify ? "verify" : "check", file, command != kVerify);
        !found)
      return found;
  return {};
}
}  // namespace swallowclip::cli
