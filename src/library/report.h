// SPDX-License-Identifier: MIT
// The page that people look at after a night: report/index.html, without a server.
#pragma once
#include "library/manifest.h"
#include "library/summary.h"

namespace swallowclip::library {

/// A clip whose bytes differ from last night's.
struct Change {
  std::string clip;
  bool isNew = false;
  double difference = 0;           ///< visible, of the contact sheets: 0 equal .. about 1
  std::vector<std::string> moved;  ///< measured values that are not what they were
};

/// Compares the products at hand with the last published night.
std::vector<Change> changesSince(const std::optional<Night>& last, const Night& now,
                                 const Plan& plan, const Root& root);

struct Report {
  const Summary& summary;
  const Plan& plan;
  const Night& gathered;              ///< what this night could have shown
  const std::optional<Night>& shown;  ///< what `current` shows
  const std::vector<Change>& changes;
  const Tonight& tonight;
};

/// Writes index.html and its charts.
Result<void> writeReport(const Report& report, const Root& root);
}  // namespace swallowclip::library
