// SPDX-License-Identifier: MIT
// The grid against its slow twin: every pair.
#include "bolus/neighbours.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace swallowclip::bolus {
namespace {
constexpr double kVolume_m3 = 8e-9;

/// Every pair, images included, as sets: the lists' order is that of the cells. With a skin they
/// are built where the points are just under half of it away, and then follow them.
void expectEveryPair(const std::vector<Vec3>& points, const std::vector<std::uint8_t>& take,
                     const Vec3& period_m, double skin_m = 0) {
  const Kernel kernel(KernelKind::cubicSpline, 4e-3);
  ThreadPool pool(2);
  Neighbours nb;
  const KernelTable table(kernel);
  std::mt19937 random(3);
  std::normal_distribution<double> any;
  std::vector<Vec3> before = points;
  for (Vec3& p : before)
    p += 0.499 * skin_m * Vec3(any(random), any(random), any(random)).normalized();
  nb.build(before, take, table, kVolume_m3, period_m, skin_m, pool);
  ASSERT_EQ(nb.follow(points, take, table, kVolume_m3, pool), skin_m > 0);
  const double unit = kVolume_m3 * kernel.w(0);
  int pairs = 0;
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    const int slot = nb.slot[i];
    ASSERT_EQ(slot >= 0, take[i] != 0);
    if (slot < 0) continue;
    EXPECT_EQ(nb.id[slot], i);
    std::multimap<int, Vec3> found;
    for (int k = nb.start[slot]; k < nb.stop[slot]; ++k) {
      const Vec3 g(nb.gx[k], nb.gy[k], nb.gz[k]);
      if (nb.index[k] == nb.count)
        EXPECT_EQ(g.norm(), 0);
      else
        found.emplace(nb.id[nb.index[k]], g);
    }
    double sum = kernel.w(0);
    std::size_t expectedPairs = 0;
    for (int j = 0; j < static_cast<int>(points.size()); ++j) {
      if (i == j || !take[j]) continue;
      Vec3 d = points[i] - points[j];
      for (int a = 0; a < 3; ++a)
        if (period_m[a] > 0) d[a] -= period_m[a] * std::round(d[a] / period_m[a]);
      const double r = d.norm();
      if (r >= kernel.support_m() * (1 - 1e-5)) continue;
      const Vec3 expected = r > 0 ? Vec3(kVolume_m3 * kernel.slope(r) / r * d) : Vec3::Zero();
      ASSERT_EQ(found.count(j), 1u) << i << " " << j;
      EXPECT_LT((found.find(j)->second - expected).norm(), 2e-5 * unit / 4e-3);
      sum += kernel.w(r);
      ++expectedPairs;
      ++pairs;
    }
    EXPECT_LE(found.size() - expectedPairs, 1u) << "only a pair at the very edge may differ";
    EXPECT_NEAR(nb.sumW[slot], kVolume_m3 * sum, 1e-5 * unit);
  }
  EXPECT_GT(pairs, 4000);
}

std::vector<Vec3> scattered(double size_m) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> along(0, size_m);
  std::vector<Vec3> points(700);
  for (Vec3& p : points) p = {along(random), 0.4 * along(random), 0.3 * along(random)};
  points[11] = points[12];  // two at one place
  return points;
}

TEST(Neighbours, AgreeWithEveryPair) {
  std::vector<std::uint8_t> take(700);
  for (std::size_t i = 0; i < take.size(); ++i) take[i] = i % 5 != 0;
  expectEveryPair(scattered(0.05), take, Vec3::Zero());
}

TEST(Neighbours, FollowPointsWithinTheSkin) {
  const std::vector<std::uint8_t> all(700, 1);
  expectEveryPair(scattered(0.05), all, Vec3::Zero(), 1e-3);
  expectEveryPair(scattered(0.05), all, {0.05, 0.02, 0.015}, 1e-3);
}

TEST(Neighbours, DoNotFollowFartherOrOthers) {
  std::vector<Vec3> points = scattered(0.05);
  std::vector<std::uint8_t> take(700, 1);
  const KernelTable table(Kernel(KernelKind::cubicSpline, 4e-3));
  ThreadPool pool(1);
  Neighbours nb;
  nb.build(points, take, table, kVolume_m3, Vec3::Zero(), 1e-3, pool);
  points[5].x() += 0.6e-3;
  EXPECT_FALSE(nb.follow(points, take, table, kVolume_m3, pool));
  points[5].x() -= 0.2e-3;
  EXPECT_TRUE(nb.follow(points, take, table, kVolume_m3, pool));
  take[9] = 0;
  EXPECT_FALSE(nb.follow(points, take, table, kVolume_m3, pool));
}

TEST(Neighbours, ImagesOfAPeriodicDomain) {
  expectEveryPair(scattered(0.05), std::vector<std::uint8_t>(700, 1), {0.05, 0.02, 0.015});
}

TEST(Neighbours, GradientsAreAntisymmetricToTheBit) {
  const std::vector<Vec3> points = scattered(0.05);
  ThreadPool pool(1);
  Neighbours nb;
  nb.build(points, {}, KernelTable(Kernel(KernelKind::cubicSpline, 4e-3)), kVolume_m3, Vec3::Zero(),
           0, pool);
  for (int i = 0; i < nb.count; ++i)
    for (int k = nb.start[i]; k < nb.stop[i]; ++k) {
      const int j = nb.index[k];
      if (j == nb.count) continue;
      int back = nb.start[j];
      while (back < nb.stop[j] && nb.index[back] != i) ++back;
      ASSERT_LT(back, nb.stop[j]);
      EXPECT_EQ(nb.gx[k], -nb.gx[back]);
      EXPECT_EQ(nb.gz[k], -nb.gz[back]);
    }
}

// Candidates with a skin, from where the points were before, against the lists of just now.
TEST(Neighbours, SweepsThroughPlacesAgreeWithThoseThroughLists) {
  const Kernel kernel(KernelKind::cubicSpline, 4e-3);
  const KernelTable table(kernel);
  const std::vector<Vec3> points = scattered(0.05);
  ThreadPool pool(1);
  for (const Vec3& period_m : {Vec3(0, 0, 0), Vec3(0.05, 0.02, 0.015)}) {
    std::vector<Vec3> before = points;
    for (std::size_t i = 0; i < before.size(); ++i) before[i].y() += i % 2 == 0 ? 3e-4 : -3e-4;
    Neighbours lists, places;
    lists.build(points, {}, table, kVolume_m3, period_m, 0, pool);
    places.collect(before, {}, kernel.support_m(), 1e-3, period_m, pool);
    ASSERT_TRUE(places.carry(points, {}, pool));
    std::vector<float> half(lists.count + 1, 0.5f), stress(lists.count), twin(lists.count);
    std::vector<double> out(3 * lists.count), twinOut(3 * lists.count);
    GradientSweep{lists.lists(), half.data(), out.data(), lists.r.data(), stress.data()}.run(
        0, lists.count);
    const double perHalf = 2 / kernel.support_m();
    AttractionSweep{places.candidates(), static_cast<float>(perHalf),
                    static_cast<float>(kVolume_m3 * kernel.w(0) * perHalf * perHalf),
                    twinOut.data(), twin.data()}
        .run(0, places.count);
    const double unit = kVolume_m3 * kernel.w(0) / 4e-3;
    for (std::size_t p = 0; p < points.size(); ++p) {
      const int a = lists.slot[p], b = places.slot[p];
      EXPECT_LT((Vec3(&out[3 * a]) - Vec3(&twinOut[3 * b])).norm(), 5e-5 * unit);
      EXPECT_NEAR(stress[a], twin[b], 1e-5 * kVolume_m3 * kernel.w(0));
    }
    places.forget();
    EXPECT_FALSE(places.carry(points, {}, pool));
  }
}

TEST(Neighbours, StrayParticleCostsNoMemory) {
  std::vector<Vec3> points{{0, 0, 0}, {1e-3, 0, 0}, {500, -800, 1000}};
  ThreadPool pool(1);
  Neighbours nb;
  nb.build(points, {}, KernelTable(Kernel(KernelKind::cubicSpline, 4e-3)), kVolume_m3, Vec3::Zero(),
           0, pool);
  EXPECT_EQ(nb.count, 3);
  EXPECT_EQ(nb.index.size(), 2u * 8);
}
}  // namespace
}  // namespace swallowclip::bolus
