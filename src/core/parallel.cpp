// SPDX-License-Identifier: MIT
#include "core/parallel.h"

#include <algorithm>

namespace swallowclip {

ThreadPool::ThreadPool(int threads) {
  for (int i = 1; i < threads; ++i) workers_.emplace_back([this] { workerLoop(); });
}

ThreadPool::~ThreadPool() {
  {
    std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  for (std::thread& t : workers_) t.join();
}

void ThreadPool::runChunks() {
  std::unique_lock lock(mutex_);
  while (nextChunk_ < chunkCount_) {
    const int c = nextChunk_++;
    const int n = n_, chunk = chunk_;
    const auto* body = body_;
    lock.unlock();
    (*body)(c * chunk, std::min(n, (c + 1) * chunk), c);
    lock.lock();
    if (++finished_ == chunkCount_) done_.notify_all();
  }
}

void ThreadPool::workerLoop() {
  std::uint64_t seen = 0;
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return stop_ || generation_ != seen; });
      if (stop_) return;
      seen = generation_;
    }
    runChunks();
  }
}

void ThreadPool::forChunks(int n, int chunk, const std::function<void(int, int, int)>& body) {
  if (n <= 0) return;
  const int count = (n + chunk - 1) / chunk;
  if (workers_.empty() || count == 1) {
    for (int c = 0; c < count; ++c) body(c * chunk, std::min(n, (c + 1) * chunk), c);
    return;
  }
  {
    std::lock_guard lock(mutex_);
    body_ = &body;
    n_ = n;
    chunk_ = chunk;
    nextChunk_ = 0;
    chunkCount_ = count;
    finished_ = 0;
    ++generation_;
  }
  wake_.notify_all();
  runChunks();
  std::unique_lock lock(mutex_);
  done_.wait(lock, [&] { return finished_ == chunkCount_; });
}

double ThreadPool::sumChunks(int n, int chunk, const std::function<double(int, int)>& term) {
  std::vector<double> part((n + chunk - 1) / std::max(chunk, 1));
  forChunks(n, chunk, [&](int b, int e, int c) { part[c] = term(b, e); });
  double sum = 0;
  for (double p : part) sum += p;
  return sum;
}
}  // namespace swallowclip
