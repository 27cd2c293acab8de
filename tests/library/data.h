// SPDX-License-Identifier: MIT
// A data folder that a test may change, and a spec for it.
#pragma once
#include <gtest/gtest.h>

#include <fstream>

#include "core/file.h"
#include "library/plan.h"
#include "pipeline/progress.h"
#include "scratch.h"

namespace swallowclip::library::test {
namespace fs = std::filesystem;

class Silent : public pipeline::Progress {
 public:
  void stage(std::string_view) override {}
  void update(double) override {}
  void print(std::string_view text) override { printed += text; }
  void note(std::string_view text) override { noted += std::string(text) + "\n"; }
  std::string printed, noted;
};

class Library : public testing::Test {
 protected:
  Library() {
    fs::create_directories(folder / "data");
    for (const char* part : {"scenes", "render_presets", "shaders", "report"})
      fs::copy(fs::path(SWALLOWCLIP_SOURCE_DIR) / part, folder / "data" / part,
               fs::copy_options::recursive);
    options.data = folder / "data";
    options.library.out = folder / "out";
  }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name) << text;
    return folder / name;
  }
  /// Replaces the first `from` in a file of the data folder.
  void change(const std::string& name, const std::string& from, const std::string& to) const {
    const fs::path file = folder / "data" / name;
    std::string text = readFile(file).value_or("");
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << name << " lacks " << from;
    std::ofstream(file) << text.replace(at, from.size(), to);
  }
  Plan plan(const std::string& specText) const {
    auto spec = loadSpec(write("spec.json", specText), options);
    if (!spec) throw std::runtime_error(spec.error().text());
    auto made = makePlan(*spec, options);
    if (!made) throw std::runtime_error(made.error().text());
    return std::move(*made);
  }

  swallowclip::test::Scratch folder;
  pipeline::RunOptions options;
};

/// Two scores, two boluses, two views: 26 jobs.
inline constexpr const char* kSpec =
    "{\"boluses\": [\"thin\", \"honey\"], \"views\": [\"oblique\", \"si\"], "
    "\"presets\": [\"small\"], \"swallows\": [{\"component\": 4, \"scores\": [0, 1]}]}";
}  // namespace swallowclip::library::test
