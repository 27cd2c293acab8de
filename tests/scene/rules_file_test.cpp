// SPDX-License-Identifier: MIT
#include "scene/rules_file.h"

#include <gtest/gtest.h>

#include "core/file.h"
#include "core/vec.h"
#include "scene/file_kind.h"
#include "scene/swallow_file.h"
#include "scratch.h"

namespace swallowclip::scene {
namespace {
const std::filesystem::path kScenes = SWALLOWCLIP_SOURCE_DIR "/scenes";

class RulesFile : public testing::Test {
 protected:
  /// The shipped file with one text replaced.
  Result<scoring::ScoringRules> loadWith(const std::string& from, const std::string& to) {
    std::string text = readFile(scoringRulesFile(kScenes)).value();
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) text.replace(at, from.size(), to);
    const auto file = folder / "rules.json";
    EXPECT_TRUE(writeFile(file, text));
    return loadScoringRules(file);
  }
  void expectError(const Result<scoring::ScoringRules>& rules, const std::string& words) {
    ASSERT_FALSE(rules);
    EXPECT_NE(rules.error().text().find(words), std::string::npos) << rules.error().text();
    EXPECT_NE(rules.error().text().find("rules.json"), std::string::npos);
  }
  test::Scratch folder;
};

TEST_F(RulesFile, EveryNumberComesFromTheFileInSIUnits) {
  const auto rules = loadWith("\"sealed_mm\": 0.3", "\"sealed_mm\": 0.4");
  ASSERT_TRUE(rules) << rules.error().text();
  EXPECT_DOUBLE_EQ(rules->sealed_m, 0.4e-3);
  EXPECT_DOUBLE_EQ(rules->ramus_m, 0.072);
  EXPECT_NEAR(rules->inverted_rad, 115 * kPi / 180, 1e-12);
  for (const auto& field : scoring::ruleFields())
    EXPECT_TRUE(std::isfinite((*rules).*field.member)) << field.section << "." << field.key;
}

TEST_F(RulesFile, MistakesAreNamedWithTheirPlace) {
  expectError(loadWith("\"sealed_mm\": 0.3", "\"sealed_nm\": 0.3"), "sealed_mm");
  expectError(loadWith("\"bowing_ratio\": 0.10", "\"bowing_ratio\": 10"), "bowing_ratio");
  expectError(loadWith("\"bowing_ratio\": 0.10", "\"bowing_ratio\": \"much\""), "bowing_ratio");
  expectError(loadWith("\"sealed_mm\": 0.3", "\"sealed_mm\": 0.3, \"trace_rato\": 1"),
              "trace_ratio");
  expectError(loadWith("\"component_15\"", "\"component_51\""), "component_15");
}

TEST_F(RulesFile, CutsOutOfOrderAreRefused) {
  expectError(loadWith("\"trace_ratio\": 0.15", "\"trace_ratio\": 0.6"),
              "sealed_ratio < trace_ratio < narrow_ratio does not hold");
}

TEST_F(RulesFile, IsToldFromOtherFilesByItsKeys) {
  EXPECT_EQ(fileKind(scoringRulesFile(kScenes)), FileKind::scoringRules);
  EXPECT_TRUE(checkFile(scoringRulesFile(kScenes), FileKind::scoringRules, kScenes));
}

class Set : public testing::Test {
 protected:
  kinematics::SwallowDef swallow = loadSwallow(kScenes / "swallows/normal.json").value();
  std::string problem(const std::string& assignment) {
    const auto done = applySet(swallow, assignment);
    return done ? "" : done.error().text();
  }
};

TEST_F(Set, AGroupMovesAllItsTracks) {
  ASSERT_EQ(problem("larynx.delay_s=0.4"), "");
  for (const char* name : {"larynx_superior", "larynx_anterior", "arytenoid", "epiglottis"})
    EXPECT_DOUBLE_EQ(swallow.track(name).delay_s, 0.4) << name;
  EXPECT_DOUBLE_EQ(swallow.track("hyoid_superior").delay_s, 0);
  ASSERT_EQ(problem("hyoid.amplitude=0.5"), "");
  EXPECT_DOUBLE_EQ(swallow.track("hyoid_anterior").amplitude, 0.5);
}

TEST_F(Set, AnotherOnsetMovesTheWholeTrack) {
  const kinematics::Track before = swallow.track("velum");
  ASSERT_EQ(problem("velum.onset_s=0.4"), "");
  const kinematics::Track after = swallow.track("velum");
  EXPECT_DOUBLE_EQ(after.onset_s, 0.4);
  EXPECT_NEAR(after.peak_s - after.onset_s, before.peak_s - before.onset_s, 1e-12);
  EXPECT_NEAR(after.offset_s - after.hold_s, before.offset_s - before.hold_s, 1e-12);
}

TEST_F(Set, MistakesAreNamedWithTheNearestName) {
  EXPECT_NE(problem("larinx.delay_s=0.4").find("'larynx'"), std::string::npos);
  EXPECT_NE(problem("larynx.delay=0.4").find("'delay_s'"), std::string::npos);
  EXPECT_NE(problem("larynx.speed=90").find("[0.05, 20]"), std::string::npos);
  EXPECT_NE(problem("larynx.peak_s=0.1").find("several tracks"), std::string::npos);
  EXPECT_NE(problem("velum.peak_s=9").find("no longer holds"), std::string::npos);
}
}  // namespace
}  // namespace swallowclip::scene
