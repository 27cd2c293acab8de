// SPDX-License-Identifier: MIT
// Two hundred tubes that close behind a wave and open late or early before it, drawn from the
// ranges that swallows have (clinical-reference 1 and 3): whatever the walls do, no particle leaves
// them, none gets lost, and what has no room is said to have none.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "bolus/solver.h"
#include "shapes.h"

namespace swallowclip::bolus {
namespace {
struct Draw {
  double gap_m, speed_ms, ramp_m, opensAt_s, opening_s, sealWidth_m, viscosity_Pas, volume_m3;
};

Draw draw(std::mt19937& random) {
  // by hand: the library's distributions differ between implementations
  const auto between = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  const auto logBetween = [&](double low, double high) {
    return std::exp(between(std::log(low), std::log(high)));
  };
  Draw d{};
  d.gap_m = logBetween(0.1e-3, 3e-3);  // closed to a wide residue gap
  d.speed_ms = between(0.09, 0.25);    // stripping wave
  d.ramp_m = between(10e-3, 30e-3);
  d.opensAt_s = between(0.0, 0.5);  // before the wave comes, or too late
  d.opening_s = between(0.05, 0.2);
  d.sealWidth_m = between(3e-3, 8e-3);
  d.viscosity_Pas = logBetween(0.004, 5);
  d.volume_m3 = between(1e-6, 4e-6);
  return d;
}

/// closingTube with a seal at 70 mm that opens.
WallMotion sealedTube(const Draw& d) {
  testing::TubeDef tube;
  tube.leastGap_m = d.gap_m;
  tube.speed_ms = d.speed_ms;
  tube.ramp_m = d.ramp_m;
  tube.front0_m = -d.ramp_m;
  WallMotion w = testing::closingTube(tube);
  const auto wave = w.at;
  constexpr double kSealAt_m = 0.07, kSealedShare = 0.02;  // 0.1 mm of a half height of 5 mm
  w.at = [=](double t, std::vector<Vec3>& x, std::vector<Vec3>& v) {
    wave(t, x, v);
    const double u = std::clamp((t - d.opensAt_s) / d.opening_s, 0.0, 1.0);
    const double open = u * u * (3 - 2 * u), rate = 6 * u * (1 - u) / d.opening_s;
    for (std::size_t i = 0; i + 2 < x.size(); ++i) {
      const double far = (x[i].x() - kSealAt_m) / d.sealWidth_m;
      const double near = std::exp(-far * far) * (1 - kSealedShare);
      const double share = 1 - near * (1 - open);
      v[i].z() = v[i].z() * share + x[i].z() * near * rate;
      x[i].z() *= share;
    }
  };
  return w;
}

TEST(RandomMotions, NothingLeavesAndNothingIsLost) {
  std::mt19937 random(20261123);
  constexpr int kMotions = 200;
  int infeasible = 0, noRoomAtStart = 0;
  double worst = 0;
  std::int64_t clamps = 0;
  for (int k = 0; k < kMotions; ++k) {
    const Draw d = draw(random);
    SCOPED_TRACE(
        fmt::format("motion {}: gap {:.2f} mm, {:.0f} mm/s, opens at {:.2f} s, {:.3f} Pa.s", k,
                    d.gap_m * 1e3, d.speed_ms * 1e3, d.opensAt_s, d.viscosity_Pas));
    const WallMotion walls = sealedTube(d);
    BolusDef def;
    def.volume_m3 = d.volume_m3;
    def.fluid.viscosity_Pas = d.viscosity_Pas;
    def.swallowedAt_s_m = 0.085;
    Solver s(def, walls, 1);
    if (!s.seed(0, {0, 0.06})) {
      ++noRoomAtStart;
      continue;
    }
    if (!s.relax(0, 0.1)) {
      ++noRoomAtStart;
      continue;
    }
    for (int frame = 1; frame <= 24; ++frame) {
      const auto step = s.advanceTo(frame / 30.0);
      const Ledger l = s.ledger();
      ASSERT_EQ(l.fluid + l.film + l.swallowed, l.start);
      ASSERT_EQ(s.stats().escaped, 0);
      if (!step) {
        EXPECT_NE(step.error().problem.find("smaller than the fluid"), std::string::npos)
            << step.error().text();
        EXPECT_NE(step.error().place.find("t ="), std::string::npos);
        ++infeasible;
        break;
      }
    }
    if (std::getenv("SWALLOWCLIP_TEST_REPORT"))
      fmt::print(stderr, "{}: {} steps, {:.2f} m/s, peak {:.2f}, gap {:.2f} mm, {:.3f} Pa.s\n", k,
                 s.stats().steps, s.stats().maxSpeed_ms, s.stats().maxDensityError, d.gap_m * 1e3,
                 d.viscosity_Pas);
    for (const Vec3& x : s.particles().positions) ASSERT_TRUE(x.allFinite());
    worst = std::max(worst, s.stats().maxSpeed_ms);
    clamps += s.stats().clamped;
    ASSERT_LT(s.stats().steps, 200'000);
  }
  const std::string report = fmt::format(
      "{} motions: {} infeasible, {} without room at the start, fastest {:.1f} m/s, {} "
      "speeds clamped",
      kMotions, infeasible, noRoomAtStart, worst, clamps);
  RecordProperty("report", report);
  fmt::print("{}\n", report);
  EXPECT_LT(noRoomAtStart, kMotions / 4);
  EXPECT_LT(infeasible, kMotions / 2);
}
}  // namespace
}  // namespace swallowclip::bolus
