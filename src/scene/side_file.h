// SPDX-License-Identifier: MIT
// What was measured, as JSON: the side file of a clip (DESIGN section 8) and `measure --json`.
#pragma once
#include <string>

#include "frame/history.h"
#include "scoring/metrics.h"

namespace swallowclip::scene {
/// Pretty-printed, keys sorted, ends with a line feed. Same inputs, same text.
std::string sideFileText(const frame::History& history, const scoring::Metrics& metrics);
}  // namespace swallowclip::scene
