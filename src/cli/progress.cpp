// SPDX-License-Identifier: MIT
#include "cli/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace swallowclip::cli {
namespace {
constexpr auto kRedraw = std::chrono::milliseconds(100);  // fast enough to look alive
constexpr double kSurely_s = 2;                           // before that the time left is a guess

int terminalColumns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}
}  // namespace

std::string progressLine(std::string_view stage, double share, double elapsed_s, int columns) {
  share = std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 0;
  std::string tail = fmt::format("  {:3.0f} %", std::floor(share * 100));
  if (elapsed_s > kSurely_s && share > 0 && share < 1) {
    const long left_s = std::lround(elapsed_s * (1 - share) / share);
    tail += fmt::format(", {}:{:02} left", left_s / 60, left_s % 60);
  }
  const std::size_t room = std::max<int>(0, columns - 1 - static_cast<int>(tail.size()));
  std::size_t end = std::min(stage.size(), room);
  while (end < stage.size() && end > 0 && (stage[end] & 0xC0) == 0x80) --end;  // whole letters
  std::string line = fmt::format("{}{}", stage.substr(0, end), tail);
  return line.substr(0, std::max(0, columns - 1));
}

TerminalProgress::TerminalProgress() : stageStart_(Clock::now()), lastDraw_(stageStart_) {
  const char* term = std::getenv("TERM");
  terminal_ = isatty(STDERR_FILENO) && term && std::string_view(term) != "dumb";
}

TerminalProgress::~TerminalProgress() {
  erase();
}

void TerminalProgress::stage(std::string_view name) {
  const std::lock_guard lock(mutex_);
  stage_ = name;
  share_ = 0;
  stageStart_ = Clock::now();
  draw(true);
}

void TerminalProgress::update(double share) {
  const std::lock_guard lock(mutex_);
  share_ = share;
  draw(false);
}

void TerminalProgress::draw(bool always) {
  const auto now = Clock::now();
  if (!terminal_ || (!always && now - lastDraw_ < kRedraw)) return;
  lastDraw_ = now;
  const double elapsed_s = std::chrono::duration<double>(now - stageStart_).count();
  fmt::print(stderr, "\r\033[K{}", progressLine(stage_, share_, elapsed_s, terminalColumns()));
  std::fflush(stderr);
  drawn_ = true;
}

void TerminalProgress::erase() {
  if (!drawn_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  drawn_ = false;
}

void TerminalProgress::print(std::string_view text) {
  const std::lock_guard lock(mutex_);
  erase();
  std::fwrite(text.data(), 1, text.size(), stdout);
}

void TerminalProgress::note(std::string_view text) {
  const std::lock_guard lock(mutex_);
  erase();
  fmt::print(stderr, "{}\n", text);
}

bool TerminalProgress::finish() {
  const std::lock_guard lock(mutex_);
  erase();
  return std::fflush(stdout) == 0 && !std::ferror(stdout);
}
}  // namespace swallowclip::cli
