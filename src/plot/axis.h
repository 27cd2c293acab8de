// SPDX-License-Identifier: MIT
// Round numbers along an axis.
#pragma once
#include <string>
#include <vector>

namespace swallowclip::plot {

struct Ticks {
  double low = 0, high = 1;    ///< ends of the axis, both at or beyond the data
  std::vector<double> values;  ///< multiples of 1, 2 or 5 times a power of ten
};

/// About `wanted` ticks around [low, high]; any finite range, an empty one too.
Ticks niceTicks(double low, double high, int wanted);
std::string tickText(double value, double step);
}  // namespace swallowclip::plot
