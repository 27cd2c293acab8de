// SPDX-License-Identifier: MIT
#include "core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstring>

using namespace swallowclip;

namespace {
/// Sum whose value depends on the order of addition.
double trickySum(int threads, int n, int chunk) {
  ThreadPool pool(threads);
  return pool.sumChunks(n, chunk, [](int begin, int end) {
    double sum = 0;
    for (int i = begin; i < end; ++i) sum += std::sin(i) * std::pow(10, i % 17 - 8);
    return sum;
  });
}
}  // namespace

TEST(Parallel, SameBitsForOneTwoThreeThreads) {
  for (const int n : {0, 1, 63, 64, 65, 10007}) {
    const double one = trickySum(1, n, 64);
    for (const int threads : {2, 3, 8}) {
      const double other = trickySum(threads, n, 64);
      EXPECT_EQ(std::memcmp(&one, &other, sizeof one), 0)
          << n << " items, " << threads << " threads: " << one << " vs " << other;
    }
  }
}

TEST(Parallel, EveryIndexOnceInFixedChunks) {
  ThreadPool pool(3);
  for (const int n : {1, 7, 8, 100}) {
    std::vector<std::atomic<int>> seen(n);
    pool.forChunks(n, 8, [&](int begin, int end, int chunk) {
      EXPECT_EQ(begin, chunk * 8);
      EXPECT_EQ(end, std::min(n, begin + 8));
      for (int i = begin; i < end; ++i) ++seen[i];
    });
    for (const auto& count : seen) EXPECT_EQ(count, 1);
  }
}

TEST(Parallel, NoChunkOutsideTheLoopWhileRoundsChange) {
  ThreadPool pool(2);
  std::atomic<int> bad = 0, total = 0;
  for (int round = 0; round < 200'000; ++round) {
    const int count = 2 + round % 3;
    pool.forChunks(count, 1, [&](int begin, int end, int chunk) {
      bad += chunk < 0 || chunk >= count || begin != chunk || end != chunk + 1;
      ++total;
    });
  }
  EXPECT_EQ(bad, 0);
  EXPECT_EQ(total, 200'000 * 3 - 1);  // 2 + 3 + 4 in turn, the last turn two short
}

TEST(Parallel, ManyShortLoopsEndProperly) {
  ThreadPool pool(4);
  std::atomic<int> total = 0;
  for (int round = 0; round < 5000; ++round) pool.forChunks(5, 1, [&](int, int, int) { ++total; });
  EXPECT_EQ(total, 25000);
  EXPECT_EQ(pool.threads(), 4);
}
