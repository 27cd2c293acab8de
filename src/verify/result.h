// SPDX-License-Identifier: MIT
// What came of a case.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "verify/quantities.h"

namespace swallowclip::verify {

/// A measured curve beside its reference, in the units of the quantity; of one sample time, or of
/// the whole series.
struct Curve {
  double time_s = 0;
  std::vector<ProfileSum::Point> points;
};

struct CheckResult {
  std::string title, unit, xLabel = {};
  bool series = false;
  double measured = 0, reference = 0;  ///< where they differ most
  double error = 0, tolerance = 0;     ///< shares; absolute ones in the unit itself
  bool absolute = false, pass = false;
  std::optional<double> order = {};  ///< of convergence, when refined
  double coarseError = 0;
  std::vector<Curve> curves = {};
};

struct CaseResult {
  std::string name, description, source, solver;
  bool pass = false;
  std::string failure;  ///< why the run stopped, with its replay command
  double seconds = 0, spacing_m = 0;
  int particles = 0;
  bolus::Stats stats;
  std::vector<CheckResult> checks;
};
}  // namespace swallowclip::verify
