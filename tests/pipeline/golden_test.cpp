// SPDX-License-Identifier: MIT
// Every view of the real scene at rest, with its bolus, beside the picture kept in golden/. After
// an intended change of looks: SWALLOWCLIP_BLESS=1 build/tests/pipeline/test_pipeline
// --gtest_filter='Golden*', and look at what has changed before keeping it.
#include <cstdlib>

#include "pipeline/simulation.h"
#include "render/renderer.h"
#include "run.h"
#include "scene/preset_file.h"
#include "video/png.h"

namespace swallowclip::pipeline {
namespace {

const std::filesystem::path kGolden = SWALLOWCLIP_SOURCE_DIR "/tests/pipeline/golden";
// Other processors round otherwise: some levels along edges, nothing that a person sees.
constexpr double kMeanLevels = 0.5;    // of 255, mean of all channels
constexpr int kClearLevels = 32;       // a change that is seen ...
constexpr double kClearShare = 0.002;  // ... in this share of the pixels at most

struct Difference {
  double meanLevels = 0, clearShare = 0;
};

Difference between(const Image& a, const Image& b) {
  Difference d;
  const double pixels = static_cast<double>(a.rgba.size()) / 4;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4) {
    int worst = 0;
    for (std::size_t k = i; k < i + 3; ++k) {
      const int step = std::abs(a.rgba[k] - b.rgba[k]);
      d.meanLevels += step / (3 * pixels);
      worst = std::max(worst, step);
    }
    d.clearShare += (worst > kClearLevels) / pixels;
  }
  return d;
}

class Golden : public test::Run {};

TEST_F(Golden, EveryViewLooksAsItDidAndShowsWhatItPromises) {
  shorten(0.5);
  const auto history = simulateSwallow(options, 0, 30, notes);
  ASSERT_TRUE(history) << history.error().text();
  auto preset = scene::loadPreset(options.presetsFolder(), "training");
  ASSERT_TRUE(preset) << preset.error().text();
  preset->width = 320;
  preset->height = 180;
  preset->caption.on = false;
  preset->fluoro.quanta_per_m2 = 0;  // the noise is tested by itself
  auto renderer = render::Renderer::create(options.data / "shaders", *preset);
  ASSERT_TRUE(renderer) << renderer.error().text();
  for (const auto& [view, def] : preset->views) {
    const auto image = renderer->draw(*history, 0, view, {});
    ASSERT_TRUE(image) << image.error().text();
    const auto lost = renderer->lost(*history, 0, view);
    ASSERT_TRUE(lost) << lost.error().text();
    for (const render::Loss& l : *lost)
      ADD_FAILURE() << view << " loses " << l.structure << ": " << l.pixels << " pixels, "
                    << l.expected << " expected";
    const std::filesystem::path kept = kGolden / (view + ".png");
    if (std::getenv("SWALLOWCLIP_BLESS")) {
      ASSERT_TRUE(video::writePng(*image, kept)) << kept;
    }
    const auto golden = video::readPng(kept);
    ASSERT_TRUE(golden) << golden.error().text();
    ASSERT_EQ(golden->rgba.size(), image->rgba.size()) << view;
    const Difference d = between(*image, *golden);
    const bool same = d.meanLevels <= kMeanLevels && d.clearShare <= kClearShare;
    if (!same)
      (void)video::writePng(*image, std::filesystem::path(testing::TempDir()) / (view + ".png"));
    EXPECT_TRUE(same) << view << ": mean " << d.meanLevels << " levels (at most " << kMeanLevels
                      << "), clearly changed " << 100 * d.clearShare << " % of the pixels (at most "
                      << 100 * kClearShare << " %); the new picture lies in " << testing::TempDir();
  }
}
}  // namespace
}  // namespace swallowclip::pipeline
