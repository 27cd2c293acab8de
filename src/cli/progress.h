// SPDX-License-Identifier: MIT
// One redrawn line on standard error, on a terminal only; results on standard output.
#pragma once
#include <chrono>
#include <mutex>
#include <string>

#include "pipeline/progress.h"

namespace swallowclip::cli {

class TerminalProgress : public pipeline::Progress {
 public:
  TerminalProgress();
  ~TerminalProgress() override;
  void stage(std::string_view name) override;
  void update(double share) override;
  void print(std::string_view text) override;
  void note(std::string_view text) override;
  /// Flushes standard output; false when something could not be written (disk full, closed pipe).
  bool finish();

 private:
  using Clock = std::chrono::steady_clock;
  void draw(bool always);
  void erase();

  std::mutex mutex_;
  bool terminal_ = false, drawn_ = false;
  std::string stage_;
  double share_ = 0;
  Clock::time_point stageStart_, lastDraw_;
};

/// The line as drawn: "simulating  42 %, 0:12 left", cut to `columns`.
std::string progressLine(std::string_view stage, double share, double elapsed_s, int columns);
}  // namespace swallowclip::cli
