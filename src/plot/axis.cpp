// SPDX-License-Identifier: MIT
#include "plot/axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace swallowclip::plot {

Ticks niceTicks(double low, double high, int wanted) {
  Ticks ticks;
  if (!std::isfinite(low) || !std::isfinite(high)) low = 0, high = 1;
  if (low > high) std::swap(low, high);
  // A flat line gets a tenth of its value (or 1) on either side.
  if (high - low <= 1e-12 * std::max(std::abs(low), std::abs(high)))
    low -= std::max(0.1 * std::abs(low), 1e-12), high += std::max(0.1 * std::abs(high), 1e-12);
  const double raw = (high - low) / std::max(1, wanted);
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double digit = raw / power;
  const double step = power * (digit <= 1 ? 1 : digit <= 2 ? 2 : digit <= 5 ? 5 : 10);
  const double first = std::floor(low / step + 1e-9), last = std::ceil(high / step - 1e-9);
  for (double k = first; k <= last; ++k) ticks.values.push_back(k * step);
  ticks.low = ticks.values.front();
  ticks.high = ticks.values.back();
  return ticks;
}

std::string tickText(double value, double step) {
  if (std::abs(value) < 1e-9 * step) value = 0;
  const double size = std::max(std::abs(value), step);
  if (size >= 1e5 || step < 1e-4) return fmt::format("{:.3g}", value);
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  return fmt::format("{:.{}f}", value, decimals);
}
}  // namespace swallowclip::plot
