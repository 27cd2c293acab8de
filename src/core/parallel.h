// SPDX-License-Identifier: MIT
// Fixed chunks, so that results never depend on the number of threads: a caller writes either
// per index, or per chunk and reduces the chunks in order. Workers sleep on a condition variable.
#pragma once
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
  void forChunks(int n, int chunk, const std::function<void(int, int, int)>& body);

  /// Sum of term(begin,end) over chunks, added in chunk order.
  double sumChunks(int n, int chunk, const std::function<double(int, int)>& term);

 private:
  void workerLoop();
  void runChunks();

  std::vector<std::thread> workers_;
  std::mutex mutex_;
  std::condition_variable wake_, done_;
  const std::function<void(int, int, int)>* body_ = nullptr;
  int n_ = 0, chunk_ = 1, nextChunk_ = 0, chunkCount_ = 0, finished_ = 0;
  std::uint64_t generation_ = 0;
  bool stop_ = false;
};
}  // namespace swallowclip
