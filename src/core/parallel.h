// SPDX-License-Identifier: MIT
// Fixed chunks, so that results never depend on the number of threads: a caller writes either
// per index, or per chunk and reduces the chunks in order. Workers look for work for some
// microseconds, then sleep.
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
  void workerLoop();
  void runChunks();

  std::vector<std::thread> workers_;
  std::mutex mutex_;
  std::condition_variable wake_, done_;
  static constexpr std::uint64_t kRound = 1ull << 32;
  std::atomic<const std::function<void(int, int, int)>*> body_{nullptr};
  std::atomic<int> n_{0}, chunk_{1}, count_{0}, finished_{0}, asleep_{0};
  std::atomic<std::uint64_t> ticket_{0};  // round number times kRound plus the next chunk
  bool stop_ = false;
};
}  // namespace swallowclip
