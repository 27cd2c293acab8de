// SPDX-License-Identifier: MIT
// scenes/NAME/lumen.json and soft.json: the control curves of the airway and the soft parts.
#pragma once
#include <filesystem>

#include "anatomy/soft_parts.h"
#include "core/error.h"

namespace swallowclip::scene {
Result<anatomy::LumenDef> loadLumenDef(const std::filesystem::path& path);
Result<anatomy::SoftDef> loadSoftDef(const std::filesystem::path& path);
}  // namespace swallowclip::scene
