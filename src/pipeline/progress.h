// SPDX-License-Identifier: MIT
// How the pipeline speaks to whoever started it. The cli room draws on a terminal, tests collect.
// Implementations may be called from several threads.
#pragma once
#include <string_view>

namespace swallowclip::pipeline {

class Progress {
 public:
  virtual ~Progress() = default;
  /// A step begins, e.g. "c04-s3-honey: simulating".
  virtual void stage(std::string_view name) = 0;
  /// Share of the current step that is done, 0 to 1.
  virtual void update(double share) = 0;
  /// A result the person asked for (standard output), whole lines.
  virtual void print(std::string_view text) = 0;
  /// A diagnostic worth keeping (standard error), one line.
  virtual void note(std::string_view text) = 0;
};
}  // namespace swallowclip::pipeline
