// SPDX-License-Identifier: MIT
// The promise, for every built-in swallow: its bolus is conserved, and it measures as itself.
// Minutes long: ctest -L slow.
#include <cmath>

#include "airway/interpenetration.h"
#include "pipeline/simulation.h"
#include "run.h"
#include "scene/rules_file.h"
#include "scoring/measure.h"

namespace swallowclip::pipeline {
namespace {
struct Swallowed {
  frame::History history;
  scoring::Metrics metrics;
  double value(const char* name) const {
    const auto* q = metrics.quantity(name);
    return q && q->value ? *q->value : std::nan("");
  }
};

std::optional<Swallowed> swallow(RunOptions options, int score, const std::string& bolus) {
  test::Notes notes;
  options.bolus = bolus;
  options.jobs = 2;
  auto history = simulateSwallow(options, score, 30, notes);
  EXPECT_TRUE(history) << history.error().text();
  if (!history) return std::nullopt;
  const auto rules = scene::loadScoringRules(scene::scoringRulesFile(options.scenesFolder()));
  EXPECT_TRUE(rules) << rules.error().text();
  if (!rules) return std::nullopt;
  auto metrics = scoring::measure(*history, *rules);
  EXPECT_TRUE(metrics) << metrics.error().text();
  if (!metrics) return std::nullopt;
  return Swallowed{std::move(*history), std::move(*metrics)};
}

// The skin as it was filmed and measured, frame by frame.
void expectSoundSkin(const frame::SkinTrack& skin) {
  const auto report = checkManifold(skin.triangles, static_cast<int>(skin.wall.size()));
  EXPECT_TRUE(report.closed()) << report.text();
  ThreadPool pool(2);
  for (std::size_t k = 0; k < skin.positions.size(); ++k) {
    std::vector<Vec3> x;
    for (const Vec3f& p : skin.positions[k]) x.push_back(p.cast<double>());
    EXPECT_GT(volume(x, skin.triangles), 0) << "frame " << k;
    const auto hit = airway::maxInterpenetration(x, skin.triangles, pool);
    EXPECT_LE(hit.depth_m, 0.5e-3) << "frame " << k << ", vertex " << hit.vertex;
  }
}

struct Shown {
  int component, score;
  const char* bolus;
};

class BuiltIn : public test::Run, public testing::WithParamInterface<Shown> {};

TEST_P(BuiltIn, MeasuresAsItselfAndConservesTheBolus) {
  const auto [component, score, bolus] = GetParam();
  options.component = component;
  const auto run = swallow(options, score, bolus);
  ASSERT_TRUE(run);
  ASSERT_TRUE(run->metrics.scores.at(component));
  EXPECT_EQ(*run->metrics.scores.at(component), score);
  EXPECT_TRUE(run->metrics.labelConfirmed.value_or(false)) << run->metrics.labelReason;
  if (std::string_view(bolus) == "none") {
    expectSoundSkin(run->history.skin);
    return;
  }

  const frame::LedgerRow end = run->history.ledger.back();
  EXPECT_EQ(end.start, end.fluid + end.film + end.swallowed);
  EXPECT_EQ(end.escaped, 0);
  const bool openLarynx = component == 8 && score >= 2;
  for (auto region : run->history.bolus.region.back()) {
    EXPECT_TRUE(openLarynx || region != frame::Region::larynx);
    EXPECT_NE(region, frame::Region::nasopharynx);
  }
  EXPECT_LE(run->history.meta.meanDensityError, 0.003);
  EXPECT_LE(run->history.meta.shareAboveTenPercent, 0.01);
  EXPECT_LE(run->history.meta.maxDensityError, 0.15);
  EXPECT_LE(run->history.meta.maxSpeed_ms, 3);
  if (score == 4 && component <= 5) {
    EXPECT_EQ(end.swallowed, 0);
    return;
  }
  if (component == 4 || score == 0) {
    EXPECT_GE(end.swallowed, 0.95 * end.start);
  }
  if (score != 0) return;
  EXPECT_GE(run->value("oral_transit"), 0.35);  // clinical-reference 2
  EXPECT_LE(run->value("oral_transit"), 1.54);
  EXPECT_GE(run->value("pharyngeal_transit"), 0.35);
  EXPECT_LE(run->value("pharyngeal_transit"), 1.19);
}

std::vector<Shown> allShown() {
  std::vector<Shown> all;
  const auto add = [&](int component, int highest, std::initializer_list<const char*> boluses) {
    for (int score = 0; score <= highest; ++score)
      for (const char* bolus : boluses) all.push_back({component, score, bolus});
  };
  add(4, 4, {"thesis-honey", "thin", "none"});
  add(5, 4, {"thin", "honey"});
  add(8, 3, {"thin", "honey"});
  add(13, 3, {"nectar", "pudding"});
  add(15, 4, {"thin", "honey"});
  return all;
}

INSTANTIATE_TEST_SUITE_P(Scores, BuiltIn, testing::ValuesIn(allShown()), [](const auto& named) {
  const Shown& s = named.param;
  std::string name = fmt::format("c{:02}_s{}_{}", s.component, s.score, s.bolus);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

class Solvers : public test::Run {};

// Measured: all 621 swallowed by both, t50 in the same frame.
TEST_F(Solvers, AgreeOnANormalSwallow) {
  const auto projected = swallow(options, 0, "thesis-honey");
  options.solver = "wcsph";
  const auto compressible = swallow(options, 0, "thesis-honey");
  ASSERT_TRUE(projected && compressible);
  EXPECT_EQ(projected->history.meta.solver, "dfsph");
  EXPECT_EQ(compressible->history.meta.solver, "wcsph");
  const frame::LedgerRow a = projected->history.ledger.back();
  const frame::LedgerRow b = compressible->history.ledger.back();
  ASSERT_EQ(a.start, 621);
  ASSERT_EQ(b.start, 621);
  EXPECT_EQ(b.escaped, 0);
  EXPECT_EQ(b.start, b.fluid + b.film + b.swallowed);
  EXPECT_NEAR(b.swallowed / 621.0, a.swallowed / 621.0, 0.02);
  EXPECT_NEAR(compressible->value("t50_past_ramus"), projected->value("t50_past_ramus"), 0.05);
}

class Viscosity : public test::Run {};

TEST_F(Viscosity, ThinLeavesTheMouthBeforeHoneyBeforeAThickerOne) {
  const auto thick = folder / "thick.json";
  std::ofstream(thick) << R"({"description": "2.5 Pa.s", "density_kgm3": 1000,
                             "rheology": "newtonian", "viscosity_Pas": 2.5})";
  double before = 0;
  for (const std::string& bolus :
       {std::string("thin"), std::string("thesis-honey"), thick.string()}) {
    const auto run = swallow(options, 0, bolus);
    ASSERT_TRUE(run);
    const double left_s = run->value("t50_past_ramus");
    EXPECT_GT(left_s, before) << bolus;
    before = left_s;
  }
}
}  // namespace
}  // namespace swallowclip::pipeline
