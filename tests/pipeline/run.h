// SPDX-License-Identifier: MIT
// What the pipeline's tests share: a folder of their own, a progress that remembers, small files.
#pragma once
#include <gtest/gtest.h>

#include <fstream>

#include "core/file.h"
#include "pipeline/pipeline.h"
#include "scratch.h"

namespace swallowclip::pipeline::test {

class Notes : public Progress {
 public:
  void stage(std::string_view) override {}
  void update(double) override {}
  void print(std::string_view text) override { printed += text; }
  void note(std::string_view text) override { noted += std::string(text) + "\n"; }
  std::string printed, noted;
};

class Run : public testing::Test {
 protected:
  Run() {
    options.data = SWALLOWCLIP_SOURCE_DIR;
    options.component = 4;
    options.scores = {0};
    options.out = folder / "out";
    options.commandLine = "swallowclip (test)";
  }

  /// The normal swallow cut off after `duration_s`.
  void shorten(double duration_s) {
    options.swallow = folder / "short.json";
    std::ofstream(options.swallow) << "{\"base\": \"" << SWALLOWCLIP_SOURCE_DIR
                                   << "/scenes/swallows/normal.json\", \"title\": \"Short\", "
                                      "\"component\": 4, \"score\": 0, \"duration_s\": "
                                   << duration_s << "}";
  }
  /// The small preset at a thumbnail's size.
  void shrink() {
    std::string text = readFile(options.data / "render_presets/small.json").value_or(std::string());
    for (const auto& [from, to] : {std::pair{"\"width_px\": 854", "\"width_px\": 192"},
                                   std::pair{"\"height_px\": 480", "\"height_px\": 108"}}) {
      const auto at = text.find(from);
      ASSERT_NE(at, std::string::npos) << from;
      text.replace(at, std::string_view(from).size(), to);
    }
    options.preset = folder / "tiny.json";
    std::ofstream(options.preset) << text;
  }
  std::vector<std::string> filesIn(const std::filesystem::path& where) const {
    std::vector<std::string> names;
    std::error_code ec;
    for (const auto& e : std::filesystem::recursive_directory_iterator(where, ec))
      if (e.is_regular_file()) names.push_back(e.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }

  swallowclip::test::Scratch folder;
  RunOptions options;
  Notes notes;
};
}  // namespace swallowclip::pipeline::test
