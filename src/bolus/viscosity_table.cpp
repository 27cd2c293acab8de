// SPDX-License-Identifier: MIT
#include "bolus/viscosity_table.h"

#include <bit>
#include <cmath>

namespace swallowclip::bolus {

void ViscosityTable::make(const Fluid& fluid) {
  if (!nodes.empty() && of_ == fluid) return;
  of_ = fluid;
  first = std::bit_cast<int>(kLeast) >> kPartBits;
  const int last = std::bit_cast<int>(kMost) >> kPartBits;
  const auto at = [&](int node) {
    return static_cast<float>(apparentViscosity_Pas(
        fluid, std::sqrt(static_cast<double>(std::bit_cast<float>(node << kPartBits)))));
  };
  nodes.clear();
  for (int node = first; node <= last; ++node) nodes.push_back({at(node), at(node + 1) - at(node)});
}
}  // namespace swallowclip::bolus
