// SPDX-License-Identifier: MIT
// What a view shows, counted; and that nothing moves when nothing moves.
#include <gtest/gtest.h>

#include "render/renderer.h"
#include "shapes.h"

namespace swallowclip::render {
namespace {

// 2 pixels per mm, seen along x from the left.
RenderPreset preset() {
  return test::flatPreset(200, 200);
}
frame::StructureTrack slab(const std::string& name, float x, float halfY) {
  return test::box(name, {x, -halfY, -0.02f}, {x + 0.005f, halfY, 0.02f});
}

TEST(Visibility, CountsTheNearestOfEveryPixel) {
  auto r = Renderer::create(test::kShaders, preset());
  ASSERT_TRUE(r.has_value());
  const auto h = test::still(
      {slab("front", 0.02f, 0.01f), slab("back", 0, 0.02f), slab("hidden", -0.02f, 0.005f)});
  auto seen = r->visiblePixels(h, 0, "side");
  ASSERT_TRUE(seen.has_value()) << seen.error().text();
  EXPECT_EQ((*seen)["front"], 40 * 80);
  EXPECT_EQ((*seen)["back"], 40 * 80);
  EXPECT_EQ((*seen)["hidden"], 0);
}

TEST(Visibility, CutsCapsAndGhostsCount) {
  RenderPreset p = preset();
  p.views["side"].cuts.push_back({.only = {"cut"}});  // keeps x < 0
  p.views["side"].ghosted["ghost"] = 0.5f;
  auto r = Renderer::create(test::kShaders, p);
  ASSERT_TRUE(r.has_value());
  const auto h = test::still({test::box("cut", {-0.02f, -0.02f, -0.02f}, {0.02f, 0.02f, 0.02f}),
                              slab("ghost", 0.01f, 0.01f)});
  auto seen = r->visiblePixels(h, 0, "side");
  ASSERT_TRUE(seen.has_value()) << seen.error().text();
  EXPECT_EQ((*seen)["cut"], 80 * 80);  // its section, whole behind the ghost
  EXPECT_EQ((*seen)["ghost"], 40 * 80);
}

TEST(Visibility, ABrokenPromiseIsReported) {
  RenderPreset p = preset();
  const int lines720 = 720 * 720 / (200 * 200);
  p.views["side"].shows = {{"front", 3000 * lines720}, {"hidden", 10 * lines720}, {"bolus", 1000}};
  auto r = Renderer::create(test::kShaders, p);
  ASSERT_TRUE(r.has_value());
  const auto h = test::still({slab("front", 0.02f, 0.01f), slab("hidden", -0.02f, 0.005f)});
  const auto lost = r->lost(h, 0, "side");
  ASSERT_TRUE(lost.has_value()) << lost.error().text();
  ASSERT_EQ(lost->size(), 1u);  // without a bolus none is missed
  EXPECT_EQ(lost->front().structure, "hidden");
  EXPECT_EQ(lost->front().pixels, 0);
}

TEST(Visibility, FluoroscopyCountsContrastWithinTheBlades) {
  RenderPreset p = preset();
  p.views["side"].style = Style::fluoro;
  p.fluoro.fieldWidth_m = p.fluoro.fieldHeight_m = 0.05f;
  p.views["side"].shows = {{"bone", 1}, {"flesh", 1}};
  auto r = Renderer::create(test::kShaders, p);
  ASSERT_TRUE(r.has_value());
  auto bone = test::box("bone", {-0.02f, 0, -0.02f}, {0.02f, 0.04f, 0.02f});
  auto flesh = test::box("flesh", {-0.02f, -0.02f, -0.02f}, {0.02f, 0, 0.02f});
  flesh.material = "muscle";  // as dense as what is around
  auto seen = r->visiblePixels(test::still({bone, flesh}), 0, "side");
  ASSERT_TRUE(seen.has_value()) << seen.error().text();
  EXPECT_EQ((*seen)["bone"], 50 * 80);  // 25 of 40 mm within the field
  EXPECT_EQ((*seen)["flesh"], 0);
}

TEST(Flicker, StandingStillIsExactlyStill) {
  auto ball = test::ellipsoid("tongue", "muscle", {0, 0, 0}, {0.02f, 0.03f, 0.02f}, 24, 3);
  auto other = test::ellipsoid("thyroid", "cartilage", {0.02f, 0, 0}, {0.01f, 0.02f, 0.02f}, 24, 3);
  frame::History h = test::still({ball, other});
  h.time_s = {0, 0.03, 0.07};
  h.bolus.particleVolume_m3 = 8e-9;
  h.bolus.positions.assign(3, test::lattice({0, 0, 0.025f}, {0.01f, 0.01f, 0.006f}, 2e-3f));
  h.meta.bariumSulfate_kgm3 = 400;
  RenderPreset p;
  p.width = 320;
  p.height = 180;
  p.materials["muscle"].mottle = p.materials["muscle"].relief = 0.5f;
  p.views["still"] = {};
  p.views["still"].ghosted["thyroid"] = 0.5f;
  p.views["rays"] = p.views["still"];
  p.views["rays"].style = Style::fluoro;
  for (const float quanta : {0.0f, p.fluoro.quanta_per_m2}) {
    p.fluoro.quanta_per_m2 = quanta;
    auto r = Renderer::create(test::kShaders, p);
    ASSERT_TRUE(r.has_value());
    for (const char* view : {"still", "rays"}) {
      const auto first = r->draw(h, 0, view, {});
      for (int k : {1, 2}) {
        const bool same = r->draw(h, k, view, {})->rgba == first->rgba;
        EXPECT_EQ(same, quanta == 0 || std::string(view) == "still") << view << " " << k;
      }
    }
  }
}
}  // namespace
}  // namespace swallowclip::render
