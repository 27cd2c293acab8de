// SPDX-License-Identifier: MIT
// The "checks" of a case file.
#pragma once
#include "scene/json_reader.h"
#include "verify/case.h"

namespace swallowclip::verify {
std::vector<CheckDef> readChecks(const scene::JsonNode& root);
}  // namespace swallowclip::verify
