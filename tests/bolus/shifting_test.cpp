// SPDX-License-Identifier: MIT
// What a step does to places beyond their velocities: pushes that take back the last are held back.
#include "bolus/shifting.h"

#include <gtest/gtest.h>

namespace swallowclip::bolus {
namespace {
constexpr float kHeldBack = 0.25f;

TEST(Shifting, LetsPushesPassThatGoOn) {
  Shifting s;
  s.resize(1);
  const Vec3 push(0.1, 0.02, -0.05);
  for (int step = 0; step < 3; ++step) {
    EXPECT_EQ(s.calm(0, push), push);
    s.accept();
  }
  EXPECT_EQ(s.calm(0, Vec3(0.02, -0.1, 0)), Vec3(0.02, -0.1, 0)) << "across is not back";
}

TEST(Shifting, HoldsPushesBackThatTakeBackTheLast) {
  Shifting s;
  s.resize(2);
  const Vec3 push(0.1, 0, 0);
  EXPECT_EQ(s.calm(0, push), push);
  s.accept();
  EXPECT_EQ(s.calm(0, -push), -kHeldBack * push);
  EXPECT_EQ(s.calm(1, -push), -push) << "each particle for itself";
  s.accept();
  EXPECT_EQ(s.calm(0, push), kHeldBack * push) << "to and fro goes on";
}

TEST(Shifting, ForgetsAStepThatIsTakenAgain) {
  Shifting s;
  s.resize(1);
  const Vec3 push(0.1, 0, 0);
  s.calm(0, -push);  // not accepted
  EXPECT_EQ(s.calm(0, push), push);
  s.accept();
  EXPECT_EQ(s.calm(0, push), push);
}
}  // namespace
}  // namespace swallowclip::bolus
