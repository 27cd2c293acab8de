// SPDX-License-Identifier: MIT
// A travelling closure carries 5 mL from one end of a tube to the other, gap down to 0.1 mm.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>

#include "bolus/solver.h"
#include "shapes.h"

namespace swallowclip::bolus {
namespace {
struct Case {
  const char* name;
  double viscosity_Pas, density_kgm3, spacing_m;
  SolverKind solver = SolverKind::dfsph;
};
class ClosingTube : public ::testing::TestWithParam<Case> {};

TEST_P(ClosingTube, CarriesAllOfIt) {
  const Case& c = GetParam();
  const WallMotion walls = testing::closingTube({});
  BolusDef d;
  d.fluid.viscosity_Pas = c.viscosity_Pas;
  d.fluid.density_kgm3 = c.density_kgm3;
  d.spacing_m = c.spacing_m;
  d.solver = c.solver;
  d.swallowedAt_s_m = 0.08;
  Solver s(d, walls, 2);
  ASSERT_TRUE(s.seed(0, {0, 0.06}));
  const auto rest = s.relax(0, 0.3);  // a tube has no trough: it would spread for seconds
  ASSERT_TRUE(rest) << rest.error().text();
  const auto begin = std::chrono::steady_clock::now();
  const double end_s = 0.9;
  for (int frame = 1; frame <= 30 * end_s; ++frame) {
    const auto r = s.advanceTo(frame / 30.0);
    ASSERT_TRUE(r) << r.error().text();
    const Ledger l = s.ledger();
    ASSERT_EQ(l.fluid + l.film + l.swallowed, l.start);
    ASSERT_EQ(l.escaped, 0) << "frame " << frame;
  }
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
  const Ledger l = s.ledger();
  const Stats& st = s.stats();
  const std::string report = fmt::format(
      "{}: {:.1f} s for {:.1f} s; {} steps, density {:.1f}, rate {:.1f}, viscosity {:.1f} "
      "iterations a step; rest after {:.2f} s at {:.2f} mm/s, {:.3f} %; swallowed {} of {}, film "
      "{}; "
      "error mean {:.3f} %, max {:.1f} %, above 10 %: {:.4f} %; fastest {:.2f} m/s; clamped {}, "
      "rescued {}",
      c.name, spent.count(), end_s, st.steps, double(st.densityIterations) / st.steps,
      double(st.rateIterations) / st.steps, double(st.viscosityIterations) / st.steps, rest->time_s,
      rest->meanDrift_ms * 1e3, rest->meanDensityError * 100, l.swallowed, l.start, l.film,
      st.meanDensityError * 100, st.maxDensityError * 100, st.shareAboveTenPercent * 100,
      st.maxSpeed_ms, st.clamped, st.rescued);
  RecordProperty("report", report);
  SCOPED_TRACE(report);
  EXPECT_GE(l.swallowed, 0.95 * l.start);
  EXPECT_EQ(st.escaped, 0);
  EXPECT_LT(st.meanDensityError, 0.01);
  EXPECT_LT(st.shareAboveTenPercent, 0.01);
  if (std::getenv("SWALLOWCLIP_TEST_REPORT")) fmt::print(stderr, "{}\n", report);
}
INSTANTIATE_TEST_SUITE_P(Fluids, ClosingTube,
                         ::testing::Values(Case{"honey", 1.0, 1000, 2e-3},
                                           Case{"thin", 0.004, 1330, 2e-3},
                                           Case{"syrup", 0.1, 1000, 2e-3},
                                           Case{"honeyWcsph", 1.0, 1000, 2e-3, SolverKind::wcsph},
                                           Case{"thinWcsph", 0.004, 1330, 2e-3, SolverKind::wcsph}),
                         [](const auto& i) { return i.param.name; });
}  // namespace
}  // namespace swallowclip::bolus
