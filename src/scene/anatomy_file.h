// SPDX-License-Identifier: MIT
// scenes/*/anatomy.json -> anatomy::AnatomyDef. Millimetres and degrees in the file, the unit in
// each key; metres and radians inside. Unknown keys, words and ranges are errors with their place.
#pragma once
#include <filesystem>

#include "anatomy/anatomy_def.h"
#include "core/error.h"

namespace swallowclip::scene {
Result<anatomy::AnatomyDef> loadAnatomyDef(const std::filesystem::path& path);
}  // namespace swallowclip::scene
