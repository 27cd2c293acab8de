// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "fake_swallow.h"
#include "scoring/lumen.h"

namespace swallowclip::scoring {
namespace {
using namespace testing;

TEST(Lumen, GapOfTheChannelIsExactEverywhere) {
  FakeSwallow f;
  f.duration_s = 0.1;
  f.gap_m = [](double s, double t) { return 2 * kMm + 0.02 * s + 0.01 * t; };
  const auto h = makeHistory(f);
  const auto lumen = midlineGaps(h.skin);
  ASSERT_TRUE(lumen.has_value()) << lumen.error().text();
  ASSERT_EQ(lumen->stations.size(), 131u);
  for (int fr = 0; fr < h.frames(); ++fr)
    for (double s : {0.0, 0.030, 0.0725, 0.120, 0.1501, 0.180, 0.195})
      EXPECT_NEAR(lumen->gapAt(fr, s), f.gap_m(s, h.time_s[fr]), 2e-8) << "s " << s;
}

TEST(Lumen, StationsLieOnTheLowerSheetInTheEsophagusToo) {
  FakeSwallow f;
  f.duration_s = 0.05;
  const auto h = makeHistory(f);
  const auto lumen = midlineGaps(h.skin).value();
  for (const Station& st : lumen.stations) {
    EXPECT_EQ(st.wall, lowerWall(st.s_m));
    EXPECT_LT(st.vertex, static_cast<int>(h.skin.wall.size() / 2));
  }
}

/// Nearest point by looking at every triangle, and at points spread over each of them.
double sampledDistance(const Vec3& p, const frame::SkinTrack& skin, int frame, int steps) {
  double best = std::numeric_limits<double>::infinity();
  const auto& x = skin.positions[frame];
  const int half = static_cast<int>(skin.wall.size() / 2);
  for (const Triangle& t : skin.triangles) {
    bool use = false;
    for (int v : t) use |= std::abs(skin.u[v]) < 1e-6;
    for (int v : t) use &= v >= half;
    if (!use) continue;
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; i + j <= steps; ++j) {
        const double a = static_cast<double>(i) / steps, b = static_cast<double>(j) / steps;
        const Vec3 q = (1 - a - b) * x[t[0]].cast<double>() + a * x[t[1]].cast<double>() +
                       b * x[t[2]].cast<double>();
        best = std::min(best, (p - q).norm());
      }
  }
  return best;
}

TEST(Lumen, AgreesWithTheBruteForceTwinOnBumpySheets) {
  FakeSwallow f;
  f.duration_s = 0.1;
  f.length_m = 0.060;
  f.particles = 0;
  auto h = makeHistory(f);
  std::mt19937 rng(7);
  std::uniform_real_distribution<float> bump(-1.5e-3f, 1.5e-3f);
  for (auto& x : h.skin.positions)
    for (auto& p : x) p += Vec3f(bump(rng) * 0.3f, bump(rng), bump(rng));
  const auto lumen = midlineGaps(h.skin).value();
  for (int fr = 0; fr < h.frames(); ++fr)
    for (std::size_t k = 0; k < lumen.stations.size(); ++k) {
      const Vec3 p = h.skin.positions[fr][lumen.stations[k].vertex].cast<double>();
      const double twin = sampledDistance(p, h.skin, fr, 40);
      // The twin can only be too far, by at most the half-spacing of its samples (gap >= 3 mm).
      EXPECT_LE(lumen.gap_m[fr][k], twin + 1e-9);
      EXPECT_GE(lumen.gap_m[fr][k], twin - 1e-5);
    }
}

TEST(Lumen, AreaOfAStraightChannelIsLengthTimesGap) {
  FakeSwallow f;
  f.duration_s = 0.05;
  const auto h = makeHistory(f);
  const auto lumen = midlineGaps(h.skin).value();
  EXPECT_NEAR(midlineArea_m2(lumen, h.skin, 0, 0.090, 0.150), 8e-3 * 0.060, 1e-9);
}

/// A tube off the floor at s 108 and 132 mm, five rings deep, with a bottom whose u is 0 too.
struct Branch {
  std::vector<int> front, back;
  int bottom = -1;
};
Branch addLaryngealBranch(frame::History& h) {
  auto& skin = h.skin;
  const auto rim = [&](double s_m) {
    for (int v = 0; v < static_cast<int>(skin.wall.size() / 2); ++v)
      if (skin.u[v] == 0 && std::abs(skin.s_m[v] - s_m) < 0.8e-3) return v;
    return -1;
  };
  const int rims[2] = {rim(0.1080), rim(0.1320)};
  const float s[2] = {skin.s_m[rims[0]], skin.s_m[rims[1]]};
  const auto add = [&](float s_m, float u, float y, float z) {
    skin.s_m.push_back(s_m), skin.u.push_back(u), skin.wall.push_back(frame::Wall::larynx);
    for (std::size_t f = 0; f < skin.positions.size(); ++f) {
      // The front side comes back to 0.2 mm from the arytenoids in the last frame.
      const bool moves = y == s[0] && f + 1 == skin.positions.size();
      skin.positions[f].push_back(Vec3f(5e-3f * u, moves ? s[1] - 0.2e-3f : y, z));
    }
    return static_cast<int>(skin.u.size()) - 1;
  };
  Branch b;
  int above[2] = {rims[0], rims[1]};
  for (int d = 1; d <= 5; ++d) {
    const float z = -8e-3f - 3e-3f * d;
    const int f = add(s[0], 0, s[0], z), k = add(s[1], 0, s[1], z), side = add(0.12f, 1, s[1], z);
    skin.triangles.push_back({above[0], f, side});
    skin.triangles.push_back({above[1], side, k});
    above[0] = f, above[1] = k;
    b.front.push_back(f), b.back.push_back(k);
  }
  b.bottom = add(0.12f, 0, 0.12f, -25e-3f);
  skin.triangles.push_back({above[0], above[1], b.bottom});
  return b;
}

TEST(Lumen, BranchIsNoPartOfThePathAndTheVestibuleIsMeasured) {
  FakeSwallow f;
  f.duration_s = 0.1;
  f.particles = 0;
  auto h = makeHistory(f);
  const auto before = midlineGaps(h.skin).value();
  EXPECT_TRUE(before.vestibule_m.empty());
  const Branch b = addLaryngealBranch(h);
  const MidlineColumns mid = findMidline(h.skin);
  EXPECT_EQ(mid.vestibuleFront, b.front);
  EXPECT_EQ(mid.vestibuleBack, b.back);
  const auto after = midlineGaps(h.skin).value();
  EXPECT_EQ(after.stations.size(), before.stations.size());
  EXPECT_EQ(after.gap_m, before.gap_m);
  ASSERT_EQ(after.vestibule_m.size(), h.skin.positions.size());
  EXPECT_NEAR(after.vestibule_m.front(), 0.024, 1e-6);
  EXPECT_NEAR(after.vestibule_m.back(), 0.2e-3, 1e-6);
}

TEST(Lumen, RefusesSkinsItCannotMeasure) {
  EXPECT_FALSE(midlineGaps({}).has_value());
  FakeSwallow f;
  f.duration_s = 0.05;
  auto h = makeHistory(f);
  auto noMidline = h.skin;
  for (float& u : noMidline.u) u += 0.1f;
  EXPECT_FALSE(midlineGaps(noMidline).has_value());
  auto short1 = h.skin;
  short1.positions[1].pop_back();
  EXPECT_FALSE(midlineGaps(short1).has_value());
  auto wild = h.skin;
  wild.triangles.push_back({0, 1, 1 << 30});
  const auto r = midlineGaps(wild);
  ASSERT_FALSE(r.has_value());
  EXPECT_NE(r.error().problem.find("1073741824"), std::string::npos);
}
}  // namespace
}  // namespace swallowclip::scoring
