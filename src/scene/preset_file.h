// SPDX-License-Identifier: MIT
// render_presets/NAME.json -> render::RenderPreset. Every key is optional but "name" and "views";
// what is left out is as in the preset named by "base", else as in render_preset.h. "palette" names
// a file of colours (palette_file.h), which a preset may swap under the look of its base. Files
// carry mm, deg and "#rrggbb".
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

/// `presetsFolder` is where its base and palette are looked for.
Result<render::RenderPreset> loadPresetFile(const std::filesystem::path& path,
                                            const std::filesystem::path& presetsFolder);

/// All that a look is read from: its preset, what that is based on, and its palette.
Result<std::vector<std::filesystem::path>> presetFiles(const std::filesystem::path& presetsFolder,
                                                       const std::string& nameOrFile);

/// Stems of the *.json files of a folder, sorted. For lists and "did you mean".
std::vector<std::string> presetNames(const std::filesystem::path& presetsFolder);
}  // namespace swallowclip::scene
