// SPDX-License-Identifier: MIT
// What `draw --bench` prints for the tongue views, held to what was promised. Processor time, so
// that a busy machine measures the same; frames per second need a quiet one and are only printed.
#include "run.h"

namespace swallowclip::pipeline {
namespace {

class Cost : public test::Run {
 protected:
  void bench(const std::string& preset) {
    shorten(0.5);
    RunOptions simulation = options;
    simulation.history = folder / "run.h5";
    const auto simulated = simulate(simulation, notes);
    ASSERT_TRUE(simulated) << simulated.error().text();
    options.history = simulation.history;
    options.preset = preset;
    options.bench = true;
    const auto drawn = draw(options, notes);
    ASSERT_TRUE(drawn) << drawn.error().text();
    std::fputs(notes.printed.c_str(), stderr);
  }
  /// The number before (or after) a word, in the line that begins with `line`.
  double before(const std::string& line, const std::string& word) const {
    const std::string& t = notes.printed;
    const auto begin = t.find("\n" + line) + 1, at = t.find(word, begin);
    const auto end = t.find_last_not_of(' ', at - 1), first = t.find_last_of(' ', end);
    return std::stod(t.substr(first, end - first + 1));
  }
};

TEST_F(Cost, ATongueViewOfTheTrainingLookCostsAtMostFourTimesOneLight) {
  bench("training");
  for (const char* view : {"oblique", "ap", "si"}) EXPECT_LE(before(view, "times"), 4) << view;
}

TEST_F(Cost, TheSmallLookDrawsFewTrianglesAndKeepsLittle) {
  bench("small");
  EXPECT_LE(before("mean", "triangles"), 40000);
  EXPECT_LT(before("peak memory", "GB"), 1.5);
}
}  // namespace
}  // namespace swallowclip::pipeline
