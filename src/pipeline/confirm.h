// SPDX-License-Identifier: MIT
// The promise: a clip is published under its name only when the measure confirms its score. One
// function decides, for a single render as for a whole night.
#pragma once
#include <filesystem>
#include <string>

#include "core/error.h"
#include "frame/history.h"
#include "scoring/metrics.h"

namespace swallowclip::pipeline {

/// By the rules of SCENES/scoring_rules.json.
Result<scoring::Metrics> measureHistory(const std::filesystem::path& scenesFolder,
                                        const frame::History& history);

struct Confirmation {
  bool publish = false;
  std::string reason;  ///< in words, also when it is published
};

/// Published: nothing was intended (the swallow stands for itself), or the intended score was
/// measured and every deciding quantity is farther from its cut than the rules' margin. Rejected:
/// another score, too near a cut, or a score that could not be measured at all.
Confirmation confirm(const frame::Meta& meta, const scoring::Metrics& metrics);

/// Where the clips go: the folder itself, or its "rejected" beside them.
std::filesystem::path placeFor(const Confirmation& confirmation,
                               const std::filesystem::path& folder);
}  // namespace swallowclip::pipeline
