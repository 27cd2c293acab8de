// SPDX-License-Identifier: MIT
// A run that is stopped and taken up again must not be told from one that was not.
#include <gtest/gtest.h>

#include "bolus/solver.h"
#include "shapes.h"

namespace swallowclip::bolus {
namespace {
BolusDef honey() {
  BolusDef d;
  d.swallowedAt_s_m = 0.08;
  return d;
}

class Checkpoint : public ::testing::TestWithParam<SolverKind> {};
TEST_P(Checkpoint, GoesOnToTheBit) {
  const WallMotion walls = testing::closingTube({});
  BolusDef def = honey();
  def.solver = GetParam();
  Solver whole(def, walls, 1);
  ASSERT_TRUE(whole.seed(0, {0, 0.06}));
  ASSERT_TRUE(whole.relax(0, 0.05));
  ASSERT_TRUE(whole.advanceTo(0.1));
  const std::string saved = whole.save();
  ASSERT_TRUE(whole.advanceTo(0.15));

  Solver resumed(def, walls, 2);
  const auto restored = resumed.restore(saved);
  ASSERT_TRUE(restored) << restored.error().text();
  EXPECT_DOUBLE_EQ(resumed.time_s(), 0.1);
  ASSERT_TRUE(resumed.advanceTo(0.15));
  EXPECT_EQ(resumed.digest(), whole.digest());
  EXPECT_EQ(resumed.stats().steps, whole.stats().steps);
  EXPECT_EQ(resumed.stats().meanDensityError, whole.stats().meanDensityError);
  EXPECT_EQ(resumed.particles().densityRatio, whole.particles().densityRatio);
}

// Many particles are renumbered inside; outside each keeps its number, whatever the threads and
// interruptions.
TEST(ManyParticles, KeepTheirNumbers) {
  const WallMotion walls = testing::still(testing::box({0, 0, 0}, {0.02, 0.02, 0.05}, 3e-3));
  BolusDef def;
  def.spacing_m = 0.5e-3;
  constexpr int kEdge = 21;
  std::vector<Vec3> places;
  for (int i = 0; i < kEdge * kEdge * kEdge; ++i)
    places.push_back(def.spacing_m * Vec3(i % kEdge, i / kEdge % kEdge, i / kEdge / kEdge) +
                     Vec3(5e-3, 5e-3, 0.035));
  def.volume_m3 = static_cast<double>(places.size()) * std::pow(def.spacing_m, 3);
  Solver whole(def, walls, 2);
  ASSERT_TRUE(whole.place(0, places));
  ASSERT_TRUE(whole.advanceTo(0.06));
  ASSERT_GT(whole.stats().steps, 100);  // so that they were renumbered
  const Vec3 fallen = whole.particles().positions[0] - places[0];
  EXPECT_NEAR(fallen.z(), -9.81 * 0.06 * 0.06 / 2, 3e-4);
  for (std::size_t i = 0; i < places.size(); ++i)
    ASSERT_LT((whole.particles().positions[i] - places[i] - fallen).norm(), 1e-6) << i;
  const std::string saved = whole.save();
  ASSERT_TRUE(whole.advanceTo(0.1));  // past the floor

  Solver resumed(def, walls, 1);
  ASSERT_TRUE(resumed.restore(saved));
  ASSERT_TRUE(resumed.advanceTo(0.1));
  EXPECT_EQ(resumed.digest(), whole.digest());
}

TEST(CheckpointFile, RefusesDamageAndStrangers) {
  const WallMotion walls = testing::closingTube({});
  Solver s(honey(), walls, 1);
  ASSERT_TRUE(s.seed(0, {0, 0.06}));
  const std::string saved = s.save();
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{23}, saved.size() / 2, saved.size() - 1})
    EXPECT_FALSE(Solver(honey(), walls, 1).restore(std::string_view(saved).substr(0, length)));
  for (const std::size_t at : {std::size_t{3}, saved.size() / 3, saved.size() - 2}) {
    std::string bad = saved;
    bad[at] = static_cast<char>(bad[at] ^ 0x10);
    EXPECT_FALSE(Solver(honey(), walls, 1).restore(bad)) << at;
  }
  BolusDef other = honey();
  other.fluid.viscosity_Pas = 0.5;
  const auto refused = Solver(other, walls, 1).restore(saved);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().problem.find("another bolus"), std::string::npos);
}
INSTANTIATE_TEST_SUITE_P(Both, Checkpoint, ::testing::Values(SolverKind::dfsph, SolverKind::wcsph),
                         [](const auto& kind) { return std::string(name(kind.param)); });
}  // namespace
}  // namespace swallowclip::bolus
