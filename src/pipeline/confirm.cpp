// SPDX-License-Identifier: MIT
#include "pipeline/confirm.h"

#include "scene/rules_file.h"
#include "scoring/measure.h"

namespace swallowclip::pipeline {

Result<scoring::Metrics> measureHistory(const std::filesystem::path& scenesFolder,
                                        const frame::History& history) {
  auto rules = scene::loadScoringRules(scene::scoringRulesFile(scenesFolder));
  if (!rules) return std::unexpected(rules.error());
  return scoring::measure(history, *rules);
}

Confirmation confirm(const frame::Meta& meta, const scoring::Metrics& metrics) {
  if (meta.component == 0 || meta.score < 0) return {true, "no score was intended"};
  const bool confirmed = metrics.labelConfirmed.value_or(false);
  return {confirmed, confirmed ? fmt::format("score {} confirmed by measurement", meta.score)
                               : "NOT confirmed: " + metrics.labelReason};
}

std::filesystem::path placeFor(const Confirmation& c, const std::filesystem::path& folder) {
  return c.publish ? folder : folder / "rejected";
}
}  // namespace swallowclip::pipeline
