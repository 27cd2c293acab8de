// SPDX-License-Identifier: MIT
// render_presets/NAME.json -> render::RenderPreset. Every key is optional but "name" and "views";
// what is left out keeps the default of render_preset.h. Files carry mm, deg and "#rrggbb".
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "render/render_preset.h"

namespace swallowclip::scene {

/// A name in the presets folder, or (if it ends in ".json") the path of a preset file.
Result<render::RenderPreset> loadPreset(const std::filesystem::path& presetsFolder,
                                        const std::string& nameOrFile);

Result<render::RenderPreset> loadPresetFile(const std::filesystem::path& path);

/// Stems of the *.json files of a folder, sorted. For lists and "did you mean".
std::vector<std::string> presetNames(const std::filesystem::path& presetsFolder);
}  // namespace swallowclip::scene
