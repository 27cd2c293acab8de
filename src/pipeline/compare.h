// SPDX-License-Identifier: MIT
// What a changed swallow does otherwise than the unchanged one: clearance, residue, protection of
// the airway.
#pragma once
#include <span>
#include <string>

#include "core/error.h"
#include "frame/history.h"
#include "pipeline/progress.h"
#include "pipeline/run_options.h"
#include "scoring/metrics.h"

namespace swallowclip::pipeline {

/// A measure that tells how well a swallow went.
struct Outcome {
  const char* quantity;  ///< of Metrics
  const char* title;
  const char* unit;
  double scale;  ///< to the unit
};
std::span<const Outcome> outcomes();

/// Its value in its unit; NaN when it could not be measured.
double outcome(const scoring::Metrics& metrics, const Outcome& which);

/// A table of both and the difference.
std::string changesTable(const scoring::Metrics& before, const scoring::Metrics& after);

/// Prints that table when --set changed the swallow and --compare names the unchanged history.
Result<void> reportChanges(const RunOptions& options, const frame::History& changed,
                           Progress& progress);
}  // namespace swallowclip::pipeline
