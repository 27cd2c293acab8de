// SPDX-License-Identifier: MIT
// Causes, not tricks: what is taken from the motion is missed by the bolus, whatever a file says it
// shows. Minutes long: ctest -L slow.
#include <numeric>

#include "pipeline/confirm.h"
#include "pipeline/simulation.h"
#include "run.h"

namespace swallowclip::pipeline {
namespace {
class Causes : public test::Run {
 protected:
  frame::History swallow(const std::string& bolus, std::vector<TrackSetting> sets = {}) {
    options.bolus = bolus;
    options.jobs = 2;
    options.sets = std::move(sets);
    auto history = simulateSwallow(options, 0, 30, notes);
    EXPECT_TRUE(history) << history.error().text();
    return history ? std::move(*history) : frame::History{};
  }
  /// A swallow of its own: the normal one, changed by these members.
  void change(const std::string& members) {
    options.swallow = folder / "changed.json";
    std::ofstream(options.swallow)
        << fmt::format(R"({{"base": "{}/scenes/swallows/normal.json", "title": "Changed", {}}})",
                       SWALLOWCLIP_SOURCE_DIR, members);
  }
};

/// Share of the bolus for which `is(s_m, region)` holds at a frame.
template <typename Predicate>
double share(const frame::History& h, std::size_t frame, Predicate is) {
  int count = 0;
  const auto& region = h.bolus.region.at(frame);
  for (std::size_t i = 0; i < region.size(); ++i)
    count += is(h.bolus.s_m[frame][i], region[i]) ? 1 : 0;
  return static_cast<double>(count) / static_cast<double>(region.size());
}

TEST_F(Causes, WithAFrozenPharynxNothingPasses) {
  std::string tracks;
  for (const char* name :
       {"hyoid_superior", "hyoid_anterior", "larynx_superior", "larynx_anterior", "arytenoid",
        "epiglottis", "shortening", "ppw_bulge", "ues", "tongue_base", "wall_left", "wall_right"})
    tracks += fmt::format("{}\"{}\": {{\"amplitude\": 0}}", tracks.empty() ? "" : ", ", name);
  change(R"("front_s_mm": [[-0.62, -16], [-0.28, 0], [0.08, 50], [0.24, 66]], "tracks": {)" +
         tracks + "}");
  const frame::History h = swallow("thin");
  EXPECT_EQ(h.ledger.back().swallowed, 0);
  EXPECT_EQ(h.ledger.back().escaped, 0);
  // It is the pharynx that stands still, not the mouth.
  EXPECT_LT(share(h, h.bolus.region.size() - 1,
                  [](double, frame::Region r) { return r == frame::Region::oral; }),
            0.2);
}

TEST_F(Causes, WithoutGravityMostStillPasses) {
  change(R"("gravity_ms2": [0, 0, 0])");
  for (const char* bolus : {"thin", "honey"}) {
    const frame::LedgerRow end = swallow(bolus).ledger.back();
    EXPECT_GE(end.swallowed, 0.8 * end.start) << bolus;
  }
}

// A vestibule that closes on what has got in does not shut altogether: to the end, it would seal a
// pocket smaller than the honey in it, and the solver would say so and stop.
TEST_F(Causes, ALateLarynxLetsThinInAndHoneyLess) {
  const auto airway = [&](const char* bolus, std::vector<TrackSetting> sets) {
    auto metrics = measureHistory(options.scenesFolder(), swallow(bolus, std::move(sets)));
    EXPECT_TRUE(metrics) << metrics.error().text();
    const auto value = [&](const char* name) { return metrics->quantity(name)->value.value(); };
    return std::pair(value("pas"), value("airway_most"));
  };
  const std::vector<TrackSetting> late{{"arytenoid", "delay_s", 0.6},
                                       {"vocal_folds", "delay_s", 0.6},
                                       {"arytenoid", "amplitude", 0.85}};
  for (const char* bolus : {"thin", "honey"}) EXPECT_EQ(airway(bolus, {}).first, 1) << bolus;
  const auto [thin, thin_mL] = airway("thin", late);
  const auto [honey, honey_mL] = airway("honey", late);
  EXPECT_GT(thin, 1);
  EXPECT_LT(honey, thin);
  EXPECT_LT(honey_mL, 0.7 * thin_mL);
}

TEST_F(Causes, HalfTheTongueBaseLeavesMoreInTheValleculae) {
  const auto inValleculae = [](const frame::History& h) {
    return share(h, h.bolus.region.size() - 1, [](double s_m, frame::Region r) {
      return r == frame::Region::oropharynx && s_m > 0.099 && s_m < 0.110;
    });
  };
  const double normal = inValleculae(swallow("honey"));
  const double half = inValleculae(swallow("honey", {{"tongue_base", "amplitude", 0.5}}));
  EXPECT_LE(normal, 0.01);
  EXPECT_GT(half, normal + 0.05);
}
}  // namespace
}  // namespace swallowclip::pipeline
