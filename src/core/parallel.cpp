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

ThreadPool::ThreadPool(int threads) {
  for (int i = 1; i < threads; ++i) workers_.emplace_back([this] { workerLoop(); });
}

ThreadPool::~ThreadPool() {
  {
    std::lock_guard lock(mutex_);
    stop_ = true;
    ticket_.fetch_add(kRound);
  }
  wake_.notify_all();
  for (std::thread& t : workers_) t.join();
}

// A ticket names a round and its next chunk. Taking one proves that the round still runs, and a
// round runs until its last taken chunk is done, so that what was read of it before is still true.
void ThreadPool::runChunks() {
  for (;;) {
    std::uint64_t ticket = ticket_.load(std::memory_order_acquire);
    const auto* body = body_.load(std::memory_order_relaxed);
    const int n = n_.load(std::memory_order_relaxed),
              chunk = chunk_.load(std::memory_order_relaxed);
    const int count = count_.load(std::memory_order_relaxed);
    const int c = static_cast<int>(ticket % kRound);
    if (c >= count) return;
    if (!ticket_.compare_exchange_weak(ticket, ticket + 1, std::memory_order_acq_rel)) continue;
    (*body)(c * chunk, std::min(n, (c + 1) * chunk), c);
    if (finished_.fetch_add(1, std::memory_order_acq_rel) + 1 == count) {
      std::lock_guard lock(mutex_);
      done_.notify_all();
    }
  }
}

void ThreadPool::workerLoop() {
  std::uint64_t seen = 0;
  const auto round = [&] { return ticket_.load(std::memory_order_acquire) / kRound; };
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
    runChunks();
  }
}

void ThreadPool::forChunks(int n, int chunk, const std::function<void(int, int, int)>& body,
                           int alone) {
  if (n <= 0) return;
  const int count = (n + chunk - 1) / chunk;
  if (workers_.empty() || count == 1 || n < alone) {
    for (int c = 0; c < count; ++c) body(c * chunk, std::min(n, (c + 1) * chunk), c);
    return;
  }
  {
    std::lock_guard lock(mutex_);
    // no ticket of the last round can be taken any more: all of its chunks are
    body_.store(&body, std::memory_order_relaxed);
    n_.store(n, std::memory_order_relaxed);
    chunk_.store(chunk, std::memory_order_relaxed);
    finished_.store(0, std::memory_order_relaxed);
    const std::uint64_t round = ticket_.load(std::memory_order_relaxed) / kRound + 1;
    ticket_.store(round * kRound + kRound / 4, std::memory_order_release);  // nothing to take yet
    count_.store(count, std::memory_order_relaxed);
    ticket_.store(round * kRound, std::memory_order_release);
  }
  if (asleep_ > 0) wake_.notify_all();
  runChunks();
  const auto done = [&] { return finished_.load(std::memory_order_acquire) == count; };
  for (int look = 0; look < kLooks && !done(); ++look) pause();
  if (done()) return;
  std::unique_lock lock(mutex_);
  done_.wait(lock, done);
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
