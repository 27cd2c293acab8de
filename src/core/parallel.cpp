// SPDX-License-Identifier: MIT
#include "core/parallel.h"

#include <algorithm>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace swallowclip {
namespace {
// Loops of a solver follow each other within microseconds, waking a sleeper takes ten or more. So a
// waiting thread looks this many times before it sleeps: about 0.1 ms (assumed, 0.05 to 0.3 ms),
// which is nothing to a machine that has other work for the core.
constexpr int kLooks = 2000;

void pause() {
#if defined(__x86_64__)
  _mm_pause();
#endif
}
}  // namespace

ThreadPool::ThreadPool(int threads) : stretches_(std::max(1, threads)) {
  for (int i = 1; i < threads; ++i) workers_.emplace_back([this, i] { workerLoop(i); });
}

ThreadPool::~ThreadPool() {
  {
    std::lock_guard lock(mutex_);
    stop_ = true;
    round_.fetch_add(1);
  }
  wake_.notify_all();
  for (std::thread& t : workers_) t.join();
}

// From the front of one's own stretch, from the back of another's.
bool ThreadPool::take(Stretch& s, bool own, int& chunk) {
  constexpr std::uint64_t kMask = (1ull << kBits) - 1;
  std::uint64_t left = s.left.load(std::memory_order_acquire);
  for (;;) {
    const std::uint64_t end = left & kMask, next = left >> kBits & kMask;
    if (next >= end) return false;
    const std::uint64_t less = own ? left + (1ull << kBits) : left - 1;
    chunk = static_cast<int>(own ? next : end - 1);
    if (s.left.compare_exchange_weak(left, less, std::memory_order_acq_rel,
                                     std::memory_order_acquire))
      return true;
  }
}

// A round runs until every chunk that was taken of it is done, and the next one is written only
// then: what is read of it after a chunk was taken belongs to that chunk.
void ThreadPool::runChunks(int thread) {
  const int threads = static_cast<int>(stretches_.size());
  int done = 0, count = 0;
  for (int k = 0; k < threads; ++k)
    for (int c; take(stretches_[(thread + k) % threads], k == 0, c); ++done) {
      const int n = n_.load(std::memory_order_relaxed);
      const int chunk = chunk_.load(std::memory_order_relaxed);
      count = count_.load(std::memory_order_relaxed);
      (*body_.load(std::memory_order_relaxed))(c * chunk, std::min(n, (c + 1) * chunk), c);
    }
  if (done > 0 && finished_.fetch_add(done) + done == count && waiting_) {
    std::lock_guard lock(mutex_);
    done_.notify_all();
  }
}

void ThreadPool::workerLoop(int thread) {
  std::uint64_t seen = 0;
  const auto round = [&] { return round_.load(std::memory_order_acquire); };
  for (;;) {
    for (int look = 0; look < kLooks && round() == seen; ++look) pause();
    if (round() == seen) {
      std::unique_lock lock(mutex_);
      ++asleep_;
      wake_.wait(lock, [&] { return round() != seen; });
      --asleep_;
    }
    seen = round();
    if (stop_) return;
    runChunks(thread);
  }
}

void ThreadPool::forChunks(int n, int chunk, const std::function<void(int, int, int)>& body,
                           int alone) {
  if (n <= 0) return;
  const int count = (n + chunk - 1) / chunk;
  if (workers_.empty() || count == 1 || count > kMostChunks || n < alone) {
    for (int c = 0; c < count; ++c) body(c * chunk, std::min(n, (c + 1) * chunk), c);
    return;
  }
  body_.store(&body, std::memory_order_relaxed);
  n_.store(n, std::memory_order_relaxed);
  chunk_.store(chunk, std::memory_order_relaxed);
  count_.store(count, std::memory_order_relaxed);
  finished_.store(0, std::memory_order_relaxed);
  const std::uint64_t round = round_.load(std::memory_order_relaxed) + 1;
  const std::int64_t threads = this->threads();
  for (std::int64_t t = 0; t < threads; ++t)
    stretches_[t].left.store(round << (2 * kBits) |
                                 static_cast<std::uint64_t>(t * count / threads) << kBits |
                                 static_cast<std::uint64_t>((t + 1) * count / threads),
                             std::memory_order_release);
  // Either a worker on its way to sleep sees the new round, or this thread sees that it sleeps.
  round_.store(round);
  if (asleep_ > 0) {
    std::lock_guard lock(mutex_);
    wake_.notify_all();
  }
  runChunks(0);
  const auto done = [&] { return finished_.load() == count; };
  for (int look = 0; look < kLooks && !done(); ++look) pause();
  if (done()) return;
  std::unique_lock lock(mutex_);
  waiting_ = true;
  done_.wait(lock, done);
  waiting_ = false;
}

double ThreadPool::sumChunks(int n, int chunk, const std::function<double(int, int)>& term,
                             int alone) {
  std::vector<double> part((n + chunk - 1) / std::max(chunk, 1));
  forChunks(
      n, chunk, [&](int b, int e, int c) { part[c] = term(b, e); }, alone);
  double sum = 0;
  for (double p : part) sum += p;
  return sum;
}
}  // namespace swallowclip
