// SPDX-License-Identifier: MIT
#include "scene/rules_file.h"

#include <map>

#include "scene/json_reader.h"

namespace swallowclip::scene {
namespace {
using scoring::ScoringRules;

/// Cuts on one scale must rise, or a score between two of them could never be given.
struct Ladder {
  const char* section;
  const char* text;
  std::vector<double ScoringRules::*> steps;
};

void checkLadders(const std::map<std::string, JsonNode>& sections, const ScoringRules& rules) {
  using R = ScoringRules;
  const Ladder ladders[] = {
      {"gap_rule",
       "sealed_ratio < trace_ratio < narrow_ratio",
       {&R::sealedRatio, &R::traceRatio, &R::narrowRatio}},
      {"residue_rule",
       "trace_share < pool_share < most_share < nearly_all_share",
       {&R::residueTrace, &R::residuePool, &R::residueMost, &R::residueNearlyAll}},
      {"component_4", "slow_mm_per_s < brisk_mm_per_s", {&R::slow_ms, &R::brisk_ms}},
      {"component_8",
       "rise_none_ratio < rise_half_ratio < rise_full_ratio",
       {&R::riseNone, &R::riseHalf, &R::riseFull}},
      {"component_8",
       "vestibule_shut_ratio < vestibule_half_ratio",
       {&R::vestibuleShut, &R::vestibuleHalf}},
      {"component_2", "past_share < most_past_share", {&R::heldPast, &R::heldMostPast}},
      {"component_6",
       "ramus_until_mm < vallecula_until_mm < rim_until_mm",
       {&R::headOral_m, &R::headVallecula_m, &R::headRim_m}},
      {"component_9", "none_ratio < full_ratio", {&R::hyoidNone, &R::hyoidFull}},
      {"component_10", "turned_deg < inverted_deg", {&R::turned_rad, &R::inverted_rad}},
      {"component_12", "none_ratio < full_ratio", {&R::waveNone, &R::waveFull}},
      {"component_12",
       "slowest_mm_per_s < fastest_mm_per_s",
       {&R::waveSlowest_ms, &R::waveFastest_ms}},
      {"component_14",
       "diameter_none_ratio < diameter_narrow_ratio < diameter_full_ratio",
       {&R::uesNone, &R::uesNarrow, &R::uesFull}},
      {"component_14", "open_brief_ratio < open_long_ratio", {&R::uesBrief, &R::uesLong}},
      {"component_14",
       "held_some_share < held_much_share < held_all_share",
       {&R::heldUpSome, &R::heldUpMuch, &R::heldUpAll}},
      {"component_13", "walls_top_mm < walls_end_mm", {&R::wallTop_m, &R::wallEnd_m}},
      {"stations",
       "ramus_mm < pharynx_top_mm < pharynx_end_mm < ues_end_mm",
       {&R::ramus_m, &R::pharynxTop_m, &R::pharynxEnd_m, &R::uesEnd_m}},
  };
  for (const Ladder& ladder : ladders)
    for (std::size_t k = 1; k < ladder.steps.size(); ++k)
      if (!(rules.*ladder.steps[k - 1] < rules.*ladder.steps[k]))
        sections.at(ladder.section)
            .fail(fmt::format("{} does not hold", ladder.text), "Put them in this order.");
}
}  // namespace

Result<ScoringRules> loadScoringRules(const std::filesystem::path& path) {
  auto file = JsonFile::load(path);
  if (!file) return std::unexpected(file.error());
  std::map<std::string, JsonNode> sections;
  ScoringRules rules;
  for (const scoring::RuleField& field : scoring::ruleFields()) {
    auto section = sections.find(field.section);
    if (section == sections.end())
      section = sections.emplace(field.section, file->root().object(field.section)).first;
    rules.*field.member = section->second.number(field.key, field.min, field.max) * field.scale;
  }
  checkLadders(sections, rules);
  if (auto done = file->finish(); !done) return std::unexpected(done.error());
  return rules;
}

std::filesystem::path scoringRulesFile(const std::filesystem::path& scenesFolder) {
  return scenesFolder / "scoring_rules.json";
}
}  // namespace swallowclip::scene
