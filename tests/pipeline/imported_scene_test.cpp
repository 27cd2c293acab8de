// SPDX-License-Identifier: MIT
// Real meshes through the whole program: imported, driven by a swallow file, drawn in four views.
#include "pipeline/simulation.h"
#include "reference.h"
#include "run.h"
#include "video/video_reader.h"

namespace swallowclip::pipeline {
namespace {
class ImportedScene : public test::Run {};

TEST_F(ImportedScene, BonesFollowTheSwallowAndAreDrawnInFourViews) {
  const auto meshes = swallowclip::test::referenceFolder() / "meshes";
  if (!std::filesystem::exists(meshes)) GTEST_SKIP() << "no folder " << meshes;
  RunOptions import = options;
  import.input = meshes;
  import.map = SWALLOWCLIP_SOURCE_DIR "/tests/fixtures/reference_mapping.json";
  import.out = folder / "scene";
  const auto imported = importMeshes(import, notes);
  ASSERT_TRUE(imported) << imported.error().text();

  options.scene = import.out;
  options.bolus = "none";
  const auto history = simulateSwallow(options, 0, 5, notes);
  ASSERT_TRUE(history) << history.error().text();
  for (const auto& [name, least_m] :
       {std::pair{"hyoid", 10e-3}, std::pair{"thyroid", 15e-3}, std::pair{"mandible", 0.0}}) {
    const auto* track = history->find(name);
    ASSERT_NE(track, nullptr) << name;
    double farthest = 0;
    for (int k = 0; k < history->frames(); ++k)
      farthest = std::max(farthest, track->poses[k].t.norm());
    EXPECT_GE(farthest, least_m) << name;
  }

  shorten(0.5);
  shrink();
  options.views = {"oblique", "ap", "si", "lateral"};
  const auto drawn = render(options, notes);
  ASSERT_TRUE(drawn) << drawn.error().text();
  for (const std::string& view : options.views) {
    auto clip =
        video::VideoReader::open(options.out / ("c04/rejected/c04-s0-none-" + view + ".mp4"));
    ASSERT_TRUE(clip) << clip.error().text();
    auto frame = (*clip)->next();
    ASSERT_TRUE(frame && *frame) << view;
    int bright = 0;  // the background is dark
    for (std::size_t i = 0; i < (*frame)->image.rgba.size(); i += 4)
      bright += (*frame)->image.rgba[i] > 110;
    EXPECT_GT(bright, 1000) << view;
  }
}
}  // namespace
}  // namespace swallowclip::pipeline
