// SPDX-License-Identifier: MIT
// A small good case as text, to be spoilt in one place.
#pragma once
#include <gtest/gtest.h>

#include <string>

namespace swallowclip::verify::test {

inline const std::string kGoodCase = R"({
  "name": "drop", "description": "A ball falls.", "subset": "short",
  "domain": {"shape": "box", "size_mm": [20, 20, 40]},
  "walls": {"slip": false},
  "fluid": {"density_kgm3": 1000, "rheology": "newtonian", "viscosity_Pas": 1},
  "gravity_ms2": [0, 0, -9.81],
  "spacing_mm": 2,
  "fill": [{"kind": "sphere", "centre_mm": [10, 10, 30], "radius_mm": 5}],
  "duration_s": 0.02, "samples_s": [0.01, 0.02],
  "checks": [{"quantity": {"kind": "mean-velocity", "along": "z"},
              "reference": {"kind": "free-fall-speed"}, "tolerance": 0.001}]
})";

/// The good case with one piece of its text replaced.
inline std::string spoilt(const std::string& from, const std::string& to) {
  std::string text = kGoodCase;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}
}  // namespace swallowclip::verify::test
