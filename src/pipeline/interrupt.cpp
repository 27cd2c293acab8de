// SPDX-License-Identifier: MIT
#include "pipeline/interrupt.h"

#include <atomic>
#include <csignal>

namespace swallowclip::pipeline {
namespace {
// The one global of the program: a signal handler has nowhere else to write.
std::atomic<bool> interruptFlag{false};
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void onSignal(int) {
  interruptFlag.store(true);
}
}  // namespace

void catchInterrupts() {
  struct sigaction action {};
  action.sa_handler = onSignal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // the second signal ends the process
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
}

bool interrupted() {
  return interruptFlag.load(std::memory_order_relaxed);
}

Error interruptedError() {
  return {ErrorKind::failed, "", "interrupted", "What was finished before is kept."};
}

void setInterrupted(bool value) {
  interruptFlag.store(value);
}
}  // namespace swallowclip::pipeline
