// SPDX-License-Identifier: MIT
// render_presets/palettes/NAME.json: every colour of a look by name, and which of them must be told
// apart: {"palette": {"bone": "#e6d8b8", ...}, "leastDifference": 10, "apart": [["bone", ...],
// ...]}. Within each list of "apart" any two colours differ by at least `leastDifference`
// (CIEDE2000) to normal, protan, deutan and tritan eyes; a palette that fails is an error.
#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "core/error.h"
#include "render/render_preset.h"
#include "scene/json_reader.h"

namespace swallowclip::scene {

using Palette = std::map<std::string, render::Colour>;

/// Where the palette of that name is.
Result<std::filesystem::path> palettePath(const std::filesystem::path& presetsFolder,
                                          const std::string& nameOrFile);

/// A name in PRESETS/palettes, or (if it ends in ".json") the path of a palette file.
Result<Palette> loadPalette(const std::filesystem::path& presetsFolder,
                            const std::string& nameOrFile);

/// "#rrggbb", [r, g, b] with components 0 to 1, or a name of the palette (unknown: the nearest).
render::Colour readColour(const JsonNode& node, std::string_view key,
                          const render::Colour& defaultValue, const Palette& palette);
}  // namespace swallowclip::scene
