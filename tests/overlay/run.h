// SPDX-License-Identifier: MIT
// What the tests of the whole command share: a progress that remembers, options for small clips.
#pragma once
#include <gtest/gtest.h>

#include <mutex>
#include <string>

#include "overlay/overlay.h"
#include "scratch.h"

namespace swallowclip::overlay {

class Said : public pipeline::Progress {
 public:
  void stage(std::string_view name) override { add(name); }
  void update(double) override {}
  void print(std::string_view text) override { add(text); }
  void note(std::string_view text) override { add(text); }
  std::string lines;

 private:
  void add(std::string_view line) {
    const std::lock_guard lock(mutex_);
    lines.append(line).append("\n");
  }
  std::mutex mutex_;
};

inline pipeline::RunOptions options(const test::Scratch& scratch) {
  pipeline::RunOptions o;
  o.data = SWALLOWCLIP_SOURCE_DIR;
  o.bolus = "none";
  o.preset = "small";
  o.jobs = 2;
  o.overlay.out = scratch / "clip.mp4";
  return o;
}
}  // namespace swallowclip::overlay
