// SPDX-License-Identifier: MIT
// Two hundred tubes that close behind a wave and open late or early before it, drawn from the
// ranges that swallows have (clinical-reference 1 and 3): whatever the walls do, no particle leaves
// them, none gets lost, and what has no room is said to have none.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>
#include <thread>

#include "bolus/solver.h"
#include "core/parallel.h"
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
  tube.edge_m = 2.5e-3;
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

struct Outcome {
  bool hadRoom = false, lost = false, finite = true;
  std::string error, place;  // why it stopped
  Stats stats;
};

Outcome run(const Draw& d) {
  Outcome o;
  const WallMotion walls = sealedTube(d);
  BolusDef def;
  def.volume_m3 = d.volume_m3;
  def.fluid.viscosity_Pas = d.viscosity_Pas;
  def.swallowedAt_s_m = 0.085;
  Solver s(def, walls, 1);
  o.hadRoom = s.seed(0, {0, 0.06}) && s.relax(0, 0.05);
  if (!o.hadRoom) return o;
  for (int frame = 1; frame <= 24 && s.ledger().swallowed < s.ledger().start; ++frame) {
    const auto step = s.advanceTo(frame / 30.0);
    const Ledger l = s.ledger();
    o.lost |= l.fluid + l.film + l.swallowed != l.start;
    if (step) continue;
    o.error = step.error().problem;
    o.place = step.error().place;
    break;
  }
  for (const Vec3& x : s.particles().positions) o.finite &= x.allFinite();
  o.stats = s.stats();
  return o;
}

TEST(RandomMotions, NothingLeavesAndNothingIsLost) {
  std::mt19937 random(20261123);
  constexpr int kMotions = 200;
  std::vector<Draw> draws;
  for (int k = 0; k < kMotions; ++k) draws.push_back(draw(random));
  std::vector<Outcome> outcomes(kMotions);
  ThreadPool pool(static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
  pool.forChunks(kMotions, 1, [&](int begin, int end, int) {
    for (int k = begin; k < end; ++k) outcomes[k] = run(draws[k]);
  });
  int infeasible = 0, noRoomAtStart = 0;
  double worst = 0;
  std::int64_t clamps = 0;
  for (int k = 0; k < kMotions; ++k) {
    const Draw& d = draws[k];
    const Outcome& o = outcomes[k];
    SCOPED_TRACE(
        fmt::format("motion {}: gap {:.2f} mm, {:.0f} mm/s, opens at {:.2f} s, {:.3f} Pa.s", k,
                    d.gap_m * 1e3, d.speed_ms * 1e3, d.opensAt_s, d.viscosity_Pas));
    noRoomAtStart += !o.hadRoom;
    EXPECT_FALSE(o.lost);
    EXPECT_TRUE(o.finite);
    EXPECT_EQ(o.stats.escaped, 0);
    if (!o.error.empty()) {
      EXPECT_NE(o.error.find("smaller than the fluid"), std::string::npos) << o.error;
      EXPECT_NE(o.place.find("t ="), std::string::npos) << o.place;
      ++infeasible;
      continue;  // walls that crush what has no way out make any speed
    }
    worst = std::max(worst, o.stats.maxSpeed_ms);
    clamps += o.stats.clamped;
  }
  const std::string report = fmt::format(
      "{} motions: {} infeasible, {} without room at the start; of the others the fastest "
      "{:.1f} m/s, {} speeds clamped",
      kMotions, infeasible, noRoomAtStart, worst, clamps);
  RecordProperty("report", report);
  fmt::print("{}\n", report);
  EXPECT_LT(noRoomAtStart, kMotions / 4);
  EXPECT_LT(infeasible, kMotions / 2);
}
}  // namespace
}  // namespace swallowclip::bolus
