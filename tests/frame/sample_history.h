// SPDX-License-Identifier: MIT
// A small history with every kind of content, and a folder that goes away.
#pragma once
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "frame/history.h"

namespace swallowclip::frame {

/// Two rigid and one soft structure, skin with film, `particles` of bolus, landmarks, events.
/// `grid` x `grid` vertices per surface; numbers come from a fixed pseudo-random sequence.
History sampleHistory(int frames = 5, int grid = 4, int particles = 7);

/// A folder of its own for one test, removed at the end.
class Scratch {
 public:
  Scratch() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() /
            fmt::format("sc-frame-{}-{}", info->name(), ::getpid());
    std::filesystem::create_directories(path_);
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};
}  // namespace swallowclip::frame
