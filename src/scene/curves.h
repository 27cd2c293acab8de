// SPDX-License-Identifier: MIT
// Control curves in scene files: lists of [x, value] or [x, value, value], x strictly increasing.
#pragma once
#include <array>

#include "core/curve.h"
#include "scene/json_reader.h"

namespace swallowclip::scene {
/// Both scales turn file units into SI. A list that is empty or not increasing is recorded as an
/// error and gives a harmless curve.
Curve readCurve(const JsonNode& node, std::string_view key, double xScale, double valueScale);
std::array<Curve, 2> readCurvePair(const JsonNode& node, std::string_view key, double xScale,
                                   double valueScale);
}  // namespace swallowclip::scene
