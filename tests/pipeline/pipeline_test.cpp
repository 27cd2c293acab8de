// SPDX-License-Identifier: MIT
// The whole program on the first instants of a swallow.
#include "pipeline/interrupt.h"
#include "pipeline/scene_loader.h"
#include "pipeline/simulation.h"
#include "run.h"

namespace swallowclip::pipeline {
namespace {
class Pipeline : public test::Run {};

TEST_F(Pipeline, OneAndTwoThreadsGiveTheSameState) {
  shorten(0.5);
  std::vector<std::uint64_t> digests;
  for (int threads : {1, 2}) {
    options.jobs = threads;
    SolverCost cost;
    const auto history = simulateSwallow(options, 0, 30, notes, &cost);
    ASSERT_TRUE(history) << history.error().text();
    EXPECT_EQ(cost.particles, 621u);
    EXPECT_EQ(cost.steps, history->meta.steps);
    EXPECT_GT(cost.eachStep_us(), 0);
    EXPECT_EQ(history->ledger.back().start, 621);  // 5 mL at 2 mm, thesis 4.3
    EXPECT_EQ(history->ledger.back().fluid + history->ledger.back().film, 621);
    EXPECT_EQ(history->ledger.back().escaped, 0);
    digests.push_back(history->digest(history->frames() - 1));
  }
  EXPECT_EQ(digests[0], digests[1]);
}

TEST_F(Pipeline, TheSameCommandTwiceGivesTheSameBytes) {
  shorten(0.5);
  shrink();
  options.bolus = "none";
  options.views = {"si"};
  std::vector<std::string> clips, sides;
  // Half a second shows no swallow: no clip of it may bear the score's name.
  for (int k = 0; k < 2; ++k) {
    const auto done = render(options, notes);
    ASSERT_TRUE(done) << done.error().text();
    clips.push_back(readFile(options.out / "c04/rejected/c04-s0-none-si.mp4").value());
    sides.push_back(readFile(options.out / "c04/rejected/c04-s0-none.json").value());
  }
  EXPECT_TRUE(clips[0] == clips[1]);
  EXPECT_EQ(sides[0], sides[1]);
  EXPECT_EQ(filesIn(options.out),
            (std::vector<std::string>{"c04-s0-none-si.mp4", "c04-s0-none-si.png",
                                      "c04-s0-none-si.vtt", "c04-s0-none.json"}));
}

TEST_F(Pipeline, AnInterruptedRenderLeavesNothingThatLooksFinished) {
  shorten(0.5);
  shrink();
  options.bolus = "none";
  ASSERT_TRUE(prepareFolder(options.out / "c04/rejected"));
  ASSERT_TRUE(
      writeFile(options.out / "c04/rejected/c04-s0-none.json", "{\"of\": \"an earlier run\"}"));

  struct StopWhenDrawing : test::Notes {
    void stage(std::string_view name) override {
      if (name.find("drawing") != name.npos) setInterrupted(true);
    }
  } stopping;
  const auto done = render(options, stopping);
  setInterrupted(false);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().text().find("interrupted"), std::string::npos);
  EXPECT_TRUE(filesIn(options.out).empty()) << filesIn(options.out).front();
}

TEST_F(Pipeline, AnInterruptedSimulationGoesOnFromItsCheckpointToTheSameBytes) {
  shorten(0.6);
  options.bolus = "thin";
  options.history = folder / "whole.h5";
  ASSERT_TRUE(simulate(options, notes));

  options.history = folder / "resumed.h5";
  options.checkpoint = folder / "run.state";
  struct StopHalfWay : test::Notes {
    void update(double share) override {
      if (share > 0.6) setInterrupted(true);
    }
  } stopping;
  ASSERT_FALSE(simulate(options, stopping));
  setInterrupted(false);
  ASSERT_TRUE(std::filesystem::exists(options.checkpoint));
  EXPECT_FALSE(std::filesystem::exists(options.history));
  const auto resumed = simulate(options, notes);
  ASSERT_TRUE(resumed) << resumed.error().text();
  EXPECT_NE(notes.noted.find("going on from"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(options.checkpoint));
  EXPECT_TRUE(readFile(folder / "whole.h5").value() == readFile(folder / "resumed.h5").value());

  // one of another run is refused by name
  ASSERT_FALSE(simulate(options, stopping));
  setInterrupted(false);
  options.bolus = "honey";
  const auto stranger = simulate(options, notes);
  ASSERT_FALSE(stranger);
  EXPECT_NE(stranger.error().text().find("run.state"), std::string::npos);
}

TEST_F(Pipeline, FolderThatIsAFileIsRefusedBeforeAnyWork) {
  std::ofstream(folder / "occupied") << "x";
  options.out = folder / "occupied/out";
  const auto done = render(options, notes);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().text().find("occupied"), std::string::npos) << done.error().text();
}

TEST_F(Pipeline, APartThatFollowsNothingIsRefusedWithTheNearestName) {
  const auto scene = folder / "scene";
  std::filesystem::copy(options.data / "scenes/adult", scene);
  std::string text = readFile(scene / "anatomy.json").value_or(std::string());
  const std::string from = "\"follows\": [\"soft_palate\"]";
  ASSERT_NE(text.find(from), std::string::npos);
  text.replace(text.find(from), from.size(), "\"follows\": [\"soft_palat\"]");
  std::filesystem::permissions(scene / "anatomy.json", std::filesystem::perms::owner_all);
  std::ofstream(scene / "anatomy.json") << text;
  options.scene = scene.string();
  const auto loaded = loadScene(options);
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().kind, ErrorKind::usage);
  EXPECT_NE(loaded.error().text().find("uvula"), std::string::npos);
  EXPECT_NE(loaded.error().text().find("did you mean \"soft_palate\"?"), std::string::npos);
}

TEST_F(Pipeline, ASetThatNamesNoTrackOffersTheNearestOne) {
  options.sets = {{"velm", "onset_s", 0.4}};
  const auto done = render(options, notes);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().text().find("velum"), std::string::npos) << done.error().text();
}
}  // namespace
}  // namespace swallowclip::pipeline
