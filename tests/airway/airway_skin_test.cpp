// SPDX-License-Identifier: MIT
#include "airway/airway_skin.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "airway/interpenetration.h"
#include "mouth.h"

namespace swallowclip::airway {
namespace {

constexpr int kFrames = 24;

struct Mouth {
  biomech::Model model;
  AirwaySkin skin;
};
Mouth mouthOf(const kinematics::MeshSequence& sequence) {
  auto model = biomech::Model::build(sequence);
  EXPECT_TRUE(model.has_value());
  auto skin = attachSkin(test::mouthSkin(), *model, test::mouthWalls());
  EXPECT_TRUE(skin.has_value());
  return {std::move(*model), std::move(*skin)};
}
BakedSkin baked(const Mouth& m, TimeBlend blend, int threads = 1) {
  auto out = m.skin.bake(m.model, {0, blend, threads});
  EXPECT_TRUE(out.has_value());
  return std::move(*out);
}

TEST(BakedSkin, FramesAreTheSkinnedOnes) {
  const Mouth m = mouthOf(test::squeezingMouth(kFrames, 0.0079));
  const BakedSkin skin = baked(m, TimeBlend::pchip);
  EXPECT_EQ(skin.frames(), kFrames);
  std::vector<Vec3> p, v;
  for (int k = 0; k < kFrames; ++k) {
    skin.at(skin.time_s(k), p, v);
    const auto expected = m.skin.deform(m.model, m.model.at(skin.time_s(k)));
    for (size_t i = 0; i < p.size(); ++i) ASSERT_LT((p[i] - expected[i]).norm(), 1e-12);
  }
}

TEST(BakedSkin, VelocityIsTheFiniteDifferenceOfPosition) {
  const Mouth m = mouthOf(test::squeezingMouth(kFrames, 0.0079));
  std::vector<Vec3> p, v, before, after, ignored;
  const double h_s = 1e-6;
  for (TimeBlend blend : {TimeBlend::pchip, TimeBlend::convex}) {
    const BakedSkin skin = baked(m, blend);
    double worst = 0, fastest = 0;
    for (double t = -0.15; t < 0.7; t += 0.0043) {
      skin.at(t, p, v);
      skin.at(t - h_s, before, ignored);
      skin.at(t + h_s, after, ignored);
      for (size_t i = 0; i < p.size(); ++i) {
        worst = std::max(worst, ((after[i] - before[i]) / (2 * h_s) - v[i]).norm());
        fastest = std::max(fastest, v[i].norm());
      }
    }
    EXPECT_GT(fastest, 0.05);
    EXPECT_LT(worst, 1e-4);
  }
}

TEST(BakedSkin, VelocityIsContinuous) {
  const Mouth m = mouthOf(test::squeezingMouth(kFrames, 0.0079));
  std::vector<Vec3> p, before, after;
  for (TimeBlend blend : {TimeBlend::pchip, TimeBlend::convex}) {
    const BakedSkin skin = baked(m, blend);
    for (int half = -2; half < 2 * kFrames + 2; ++half) {
      const double t = skin.start_s() + half / (2 * skin.rate_hz());
      skin.at(t - 1e-9, p, before);
      skin.at(t + 1e-9, p, after);
      for (size_t i = 0; i < p.size(); ++i) ASSERT_LT((after[i] - before[i]).norm(), 1e-5) << half;
    }
  }
}

TEST(BakedSkin, StaysAClosedSurfaceAroundAPositiveRoom) {
  const Mouth m = mouthOf(test::squeezingMouth(kFrames, 0.0079));
  const BakedSkin skin = baked(m, TimeBlend::pchip);
  const bolus::WallMotion wall = skin.wallMotion();
  EXPECT_TRUE(checkManifold(wall.triangles, static_cast<int>(wall.wall.size())).closed());
  ThreadPool pool(2);
  std::vector<Vec3> p, v;
  for (int k = 0; k < kFrames; ++k) {
    wall.at(skin.time_s(k), p, v);
    EXPECT_GT(volume(p, wall.triangles), 0);
    EXPECT_EQ(maxInterpenetration(p, wall.triangles, pool).depth_m, 0) << "frame " << k;
  }
  EXPECT_EQ(wall.s_m.size(), p.size());
  EXPECT_EQ(wall.u.size(), p.size());
  EXPECT_EQ(wall.branch.size(), p.size());
}

TEST(BakedSkin, SameBytesForEveryThreadCount) {
  const Mouth m = mouthOf(test::squeezingMouth(kFrames, 0.0079));
  std::vector<Vec3> one, three, v;
  baked(m, TimeBlend::pchip, 1).at(0.123, one, v);
  baked(m, TimeBlend::pchip, 3).at(0.123, three, v);
  EXPECT_EQ(one, three);
}

TEST(BakedSkin, OutlivesModelAndSkin) {
  bolus::WallMotion wall;
  {
    const Mouth m = mouthOf(test::squeezingMouth(kFrames, 0.004));
    wall = baked(m, TimeBlend::convex).wallMotion();
  }
  std::vector<Vec3> p, v;
  wall.at(0.2, p, v);
  EXPECT_EQ(p.size(), wall.wall.size());
}

TEST(BakedSkin, TakesFramesFromElsewhereAndChecksThem) {
  const auto bind = std::make_shared<const BindSkin>(test::mouthSkin(2));
  std::vector<std::vector<Vec3>> frames(4, bind->mesh.positions);
  for (int k = 0; k < 4; ++k)
    for (Vec3& p : frames[k]) p.x() += 1e-3 * k;
  const auto skin = BakedSkin::fromFrames(bind, 0, 10, frames, TimeBlend::convex);
  ASSERT_TRUE(skin.has_value());
  std::vector<Vec3> p, v;
  skin->at(0.15, p, v);
  EXPECT_LT((v[0] - Vec3(0.01, 0, 0)).norm(), 1e-12);
  EXPECT_NEAR(p[0].x() - bind->mesh.positions[0].x(), 1.5e-3, 1e-12);
  frames[2][5].y() = std::nan("");
  EXPECT_FALSE(BakedSkin::fromFrames(bind, 0, 10, frames, TimeBlend::pchip).has_value());
  frames[2].pop_back();
  EXPECT_FALSE(BakedSkin::fromFrames(bind, 0, 10, frames, TimeBlend::pchip).has_value());
  EXPECT_FALSE(BakedSkin::fromFrames(bind, 0, 10, {}, TimeBlend::pchip).has_value());
}

TEST(BakedSkin, RefusesAnEndlessBake) {
  const Mouth m = mouthOf(test::squeezingMouth(3, 0.004));
  EXPECT_FALSE(m.skin.bake(m.model, {1e12, TimeBlend::pchip, 1}).has_value());
}

// Palate and tongue move together with 0.02 mm between them while one of them comes from rest and
// the other from far away: the shape-preserving cubic lets them cross between two frames, the
// B-spline cannot.
TEST(BakedSkin, ConvexBlendKeepsGapsThatTheCubicDoesNot) {
  const double gap_m = 2e-5;
  const double top[] = {0, 0, 0, 0.004, 0.008, 0.008};
  const double tongue[] = {-0.008, -0.004, 0, 0.004, 0.006, 0.004};
  const auto sequence = test::mouth(
      6,
      [&](int k, std::vector<Vec3> p) {
        for (Vec3& x : p) x.z() += test::kHeight_m - gap_m + tongue[k];
        return p;
      },
      [&](int k) {
        return Pose{Quat::Identity(), Vec3(0, 0, top[k])};
      });
  const Mouth m = mouthOf(sequence);
  const auto leastVolume = [&](TimeBlend blend) {
    const BakedSkin skin = baked(m, blend);
    std::vector<Vec3> p, v;
    double least = 1;
    for (double t = skin.start_s(); t < skin.time_s(5); t += 1e-3) {
      skin.at(t, p, v);
      least = std::min(least, volume(p, skin.bind().mesh.triangles));
    }
    return least;
  };
  EXPECT_LT(leastVolume(TimeBlend::pchip), 0);
  EXPECT_GT(leastVolume(TimeBlend::convex), 0);
}
}  // namespace
}  // namespace swallowclip::airway
