// SPDX-License-Identifier: MIT
// Fixed chunks, so that results never depend on the number of threads: a caller writes either
// per index, or per chunk and reduces the chunks in order. Each thread begins with its own stretch
// of chunks, the same one in every loop over as many, so that what it wrote is still in its cache;
// then it helps others, from the far end of theirs. Workers look for work for some microseconds,
// then sleep.
#pragma once
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace swallowclip {

class ThreadPool {
 public:
  /// `threads` >= 1 counts the calling thread, which works too.
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int threads() const { return static_cast<int>(workers_.size()) + 1; }

  /// Calls body(begin, end, chunkIndex) for [0,n) cut in chunks of `chunk`; returns when all are
  /// done. Chunk boundaries depend on n and chunk only.
  /// Fewer than `alone` items are left to the calling thread: waking others would take longer.
  void forChunks(int n, int chunk, const std::function<void(int, int, int)>& body, int alone = 0);

  /// Sum of term(begin,end) over chunks, added in chunk order.
  double sumChunks(int n, int chunk, const std::function<double(int, int)>& term, int alone = 0);

 private:
  // What is left of a thread's chunks: round number, next and end in one word, so that taking one
  // proves that the round still runs.
  struct alignas(64) Stretch {
    std::atomic<std::uint64_t> left{0};
  };
  static constexpr int kBits = 20;  // of next and end
  static constexpr int kMostChunks = (1 << kBits) - 1;

  void workerLoop(int thread);
  void runChunks(int thread);
  bool take(Stretch& stretch, bool own, int& chunk);

  std::vector<std::thread> workers_;
  std::vector<Stretch> stretches_;
  std::mutex mutex_;
  std::condition_variable wake_, done_;
  std::atomic<const std::function<void(int, int, int)>*> body_{nullptr};
  std::atomic<int> n_{0}, chunk_{1}, count_{0}, asleep_{0};
  alignas(64) std::atomic<int> finished_{0};
  alignas(64) std::atomic<std::uint64_t> round_{0};
  std::atomic<bool> stop_{false}, waiting_{false};
};
}  // namespace swallowclip
