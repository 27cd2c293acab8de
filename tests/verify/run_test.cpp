// SPDX-License-Identifier: MIT
// A quick case from text to verdict, and the command around it.
#include <gtest/gtest.h>

#include "core/file.h"
#include "scratch.h"
#include "verify/cases.h"
#include "verify/report.h"
#include "verify/run_case.h"
#include "verify/verify.h"

using namespace swallowclip;
using namespace swallowclip::verify;
using verify::test::kGoodCase;
using verify::test::spoilt;

namespace {
struct Collected : pipeline::Progress {
  std::string printed;
  void stage(std::string_view) override {}
  void update(double) override {}
  void print(std::string_view text) override { printed += text; }
  void note(std::string_view) override {}
};
}  // namespace

TEST(RunCase, AFallingBallIsRight) {
  const auto def = parseCase(kGoodCase, "case.json");
  ASSERT_TRUE(def) << def.error().text();
  const auto result = runCase(*def);
  ASSERT_TRUE(result) << result.error().text();
  EXPECT_TRUE(result->pass) << tableRows(*result);
  ASSERT_EQ(result->checks.size(), 1u);
  EXPECT_NEAR(result->checks[0].curves.at(0).points.back().measured, -196.2, 0.2) << "mm/s";
  EXPECT_EQ(result->stats.escaped, 0);
}

TEST(RunCase, AWrongAnswerFails) {
  const auto def =
      parseCase(spoilt(R"({"kind": "free-fall-speed"})", R"({"kind": "constant", "value": -0.19})"),
                "case.json");
  ASSERT_TRUE(def) << def.error().text();
  const auto result = runCase(*def);
  ASSERT_TRUE(result);
  EXPECT_FALSE(result->pass);
  EXPECT_NEAR(result->checks[0].error, 1 - 0.0981 / 0.19, 0.001);
}

TEST(RunCase, ATableIsReadAtItsTimes) {
  const auto def = parseCase(spoilt(R"({"kind": "free-fall-speed"})",
                                    R"({"kind": "table", "x_scale": 0.001, "y_scale": -0.00981,
                                        "points": [[0, 0], [100, 100]]})"),
                             "case.json");
  ASSERT_TRUE(def) << def.error().text();
  const auto result = runCase(*def);
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->pass) << tableRows(*result);
}

// A reference whose clock started 5 ms later: right only after both are set to pass 0.15 m/s.
TEST(RunCase, SeriesAreAlignedWhenAsked) {
  std::string text = spoilt(R"({"kind": "free-fall-speed"})",
                            R"({"kind": "table", "points": [[0.005, 0], [0.105, 0.981]]})");
  text.replace(text.find("-9.81"), 5, "9.81");
  for (const std::string how : {"", "\"align\": 0.15, ", "\"align_best\": true, "}) {
    std::string own = text;
    own.replace(own.find("\"tolerance\""), 0, how);
    const auto def = parseCase(own, "case.json");
    ASSERT_TRUE(def) << def.error().text();
    const auto result = runCase(*def);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->pass, !how.empty()) << how << tableRows(*result);
  }
}

TEST(RunCase, RefinementGivesAnOrder) {
  const auto def = parseCase(spoilt("\"spacing_mm\": 2", "\"spacing_mm\": 2, \"refine_mm\": [2.5]"),
                             "case.json");
  ASSERT_TRUE(def) << def.error().text();
  const auto result = runCase(*def);
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->pass) << "an exact answer need not get better: " << tableRows(*result);
  EXPECT_TRUE(result->checks.at(0).order.has_value());
}

TEST(RunCase, KernelsIntegrateToOne) {
  const auto def = parseCase(R"({"name": "k", "type": "kernels", "tolerance": 1e-4})", "k.json");
  ASSERT_TRUE(def) << def.error().text();
  const auto result = runCase(*def);
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->pass) << tableRows(*result);
  EXPECT_EQ(result->checks.size(), 15u);
}

TEST(Verify, WritesTableJsonAndCharts) {
  const swallowclip::test::Scratch folder;
  const auto good = folder.path() / "good.json", bad = folder.path() / "bad.json";
  ASSERT_TRUE(writeFile(good, kGoodCase));
  std::string wrong =
      spoilt(R"({"kind": "free-fall-speed"})", R"({"kind": "constant", "value": 1})");
  wrong.replace(wrong.find("\"drop\""), 6, "\"rise\"");
  ASSERT_TRUE(writeFile(bad, wrong));
  pipeline::RunOptions options;
  options.verify.out = folder.path() / "out";
  options.files = {good};
  Collected progress;
  const auto done = verify::verify(options, progress);
  EXPECT_TRUE(done) << done.error().text();
  EXPECT_NE(progress.printed.find("pass"), std::string::npos);
  for (const char* name : {"verify.json", "drop.svg", "drop.png"})
    EXPECT_TRUE(std::filesystem::exists(options.verify.out / name)) << name;

  options.files = {good, bad};
  options.jobs = 2;
  Collected both;
  const auto failed = verify::verify(options, both);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().kind, ErrorKind::failed);
  EXPECT_LT(both.printed.find("drop"), both.printed.find("rise")) << "in the order given";
  EXPECT_NE(both.printed.find("FAIL"), std::string::npos);

  options.files = {good, good};
  const auto twice = verify::verify(options, both);
  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().kind, ErrorKind::usage);
}
