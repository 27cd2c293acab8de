// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "render/colour_vision.h"
#include "render/renderer.h"
#include "shapes.h"

namespace swallowclip::render {
namespace {
namespace fs = std::filesystem;

Image picture(const RenderPreset& preset, const frame::History& h, const std::string& view) {
  auto r = Renderer::create(test::kShaders, preset);
  EXPECT_TRUE(r.has_value()) << r.error().text();
  auto image = r->draw(h, 0, view, {});
  EXPECT_TRUE(image.has_value()) << image.error().text();
  return image ? *image : Image();
}

struct Area {
  int pixels = 0;
  double mean[3] = {0, 0, 0};
};

// Pixels that are not black background, and their mean colour.
Area lit(const Image& image) {
  Area a;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const auto* p = image.row(y) + 4 * x;
      if (p[0] + p[1] + p[2] < 30) continue;
      ++a.pixels;
      for (int k = 0; k < 3; ++k) a.mean[k] += p[k];
    }
  for (double& m : a.mean) m /= std::max(a.pixels, 1);
  return a;
}

TEST(Renderer, FlatLitSphereHasItsColourAndArea) {
  RenderPreset p = test::flatPreset(320, 200);
  p.smoothEdges = false;
  const auto h =
      test::still({test::ellipsoid("ball", "bone", {0, 0, 0}, Vec3f::Constant(0.03f), 64)});
  const Area a = lit(picture(p, h, "side"));
  const double radius_px = 0.03 / 0.1 * 200;
  EXPECT_NEAR(a.pixels / (kPi * radius_px * radius_px), 1.0, 0.01);
  const double expected[3] = {0.8 * 255, 0.4 * 255, 0.2 * 255};
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a.mean[k], expected[k], 2.0) << "channel " << k;
}

TEST(Renderer, LambertSphereHasTheKnownMean) {
  // Light from the viewer: radiance over the disc is cos, whose mean is 2/3 of the albedo.
  RenderPreset p = test::flatPreset(320, 200);
  p.smoothEdges = false;
  p.light.ambientIntensity = 0;
  p.light.key.direction = {0, 0, 1};
  p.light.key.colour_srgb = Colour(1, 1, 1);
  p.light.key.intensity = 1;
  p.fallback.baseColour_srgb = Colour(1, 1, 1);
  const auto h =
      test::still({test::ellipsoid("ball", "bone", {0, 0, 0}, Vec3f::Constant(0.03f), 64)});
  const Image image = picture(p, h, "side");
  double sum = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const double c = image.row(y)[4 * x + 1] / 255.0;
      sum += c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    }
  const double radius_px = 0.03 / 0.1 * 200;
  EXPECT_NEAR(sum / (kPi * radius_px * radius_px), 2.0 / 3.0, 0.01);
}

TEST(Renderer, CappedCutOfACubeIsItsSectionColourOverTheExactArea) {
  for (bool smooth : {false, true}) {
    RenderPreset p = test::flatPreset(200, 200);
    p.smoothEdges = smooth;
    p.views["side"].cuts.push_back({});
    // 40 x 50 mm at 2 px/mm: edges fall on pixel borders
    const auto h =
        test::still({test::box("cube", {-0.02f, -0.02f, -0.03f}, {0.02f, 0.02f, 0.02f})});
    const Area a = lit(picture(p, h, "side"));
    EXPECT_EQ(a.pixels, 80 * 100) << "smooth " << smooth;
    const double expected[3] = {0.2 * 255, 0.6 * 255, 0.3 * 255};
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(a.mean[k], expected[k], 2.0) << "channel " << k;
  }
}

TEST(Renderer, HollowSectionStaysHollow) {
  RenderPreset p = test::flatPreset(200, 200);
  p.smoothEdges = false;
  p.views["side"].cuts.push_back({});
  p.fallback.baseColour_srgb = Colour(0.9f, 0.1f, 0.1f);
  auto shell = test::box("shell", Vec3f::Constant(-0.03f), Vec3f::Constant(0.03f));
  const auto hole = test::box("hole", Vec3f::Constant(-0.01f), Vec3f::Constant(0.01f));
  const int first = static_cast<int>(shell.rest.size());
  shell.rest.insert(shell.rest.end(), hole.rest.begin(), hole.rest.end());
  for (const Triangle& t : hole.triangles)
    shell.triangles.push_back({first + t[0], first + t[2], first + t[1]});
  const Image image = picture(p, test::still({shell}), "side");
  EXPECT_GT(image.row(100)[4 * 100], 200) << "through the hole the inner wall shows";
  EXPECT_LT(image.row(100)[4 * 50], 100) << "the section around it is filled";
}

frame::History busyScene(int n) {
  auto h = test::still(
      {test::ellipsoid("tongue", "muscle", {0, -0.01f, -0.03f}, {0.025f, 0.03f, 0.02f}, n),
       test::ellipsoid("wall", "mucosa", {0, 0.035f, -0.05f}, {0.02f, 0.004f, 0.06f}, n),
       test::ellipsoid("cricoid", "cartilage", {0, 0.02f, -0.1f}, {0.012f, 0.01f, 0.01f}, n),
       test::ellipsoid("mandible", "bone", {0, -0.05f, -0.05f}, {0.01f, 0.01f, 0.02f}, n)});
  h.bolus.particleVolume_m3 = 8e-9;
  h.bolus.positions = {test::lattice({0, -0.01f, -0.008f}, {0.012f, 0.02f, 0.006f}, 2e-3f)};
  h.bolus.state = {std::vector<frame::ParticleState>(h.bolus.positions[0].size())};
  return h;
}

RenderPreset fullPreset(int width, int height) {
  RenderPreset p;
  p.width = width;
  p.height = height;
  p.bolus.baseColour_srgb = Colour(0.07f, 0.4f, 0.85f);
  p.materials["muscle"].mottle = 0.3f;
  p.materials["muscle"].wetness = 0.6f;
  p.views["oblique"].cuts.push_back({.except = {"tongue"}});
  p.views["oblique"].ghosted["cricoid"] = 0.5f;
  return p;
}

TEST(Renderer, SameInputsSameBytes) {
  const auto h = busyScene(24);
  const RenderPreset p = fullPreset(320, 180);
  const Image a = picture(p, h, "oblique"), b = picture(p, h, "oblique");
  EXPECT_EQ(a.rgba, b.rgba);
  auto r = Renderer::create(test::kShaders, p);  // and again after another history was drawn
  ASSERT_TRUE(r.has_value());
  ASSERT_TRUE(r->draw(busyScene(10), 0, "oblique", {}).has_value());
  EXPECT_EQ(r->draw(h, 0, "oblique", {})->rgba, a.rgba);
}

TEST(Renderer, GhostsBlendByDepthWhateverTheirOrder) {
  RenderPreset p = test::flatPreset(100, 100);
  p.smoothEdges = false;
  const Colour red(0.9f, 0.1f, 0.1f), green(0.1f, 0.9f, 0.1f), blue(0.1f, 0.1f, 0.9f);
  for (const auto& [name, colour] : {std::pair("red", red), {"green", green}, {"blue", blue}}) {
    p.materials[name] = p.fallback;
    p.materials[name].baseColour_srgb = colour;
  }
  p.views["side"].ghosted = {{"front", 0.5f}, {"middle", 0.5f}};
  const auto slab = [](const char* name, const char* material, float x) {
    auto s = test::box(name, {x, -0.02f, -0.02f}, {x + 0.005f, 0.02f, 0.02f});
    s.material = material;
    return s;
  };
  const auto front = slab("front", "red", 0.02f), middle = slab("middle", "green", 0);
  const auto back = slab("back", "blue", -0.02f);
  const Image image = picture(p, test::still({front, middle, back}), "side");
  EXPECT_EQ(image.rgba, picture(p, test::still({back, middle, front}), "side").rgba);
  // seen head-on a ghost is 0.55 as opaque as it is called (solid.frag); mixed in square roots
  const float seen = 0.55f * 0.5f;
  const auto root = [](const Colour& c) { return Colour(linear(c).cwiseSqrt()); };
  const Colour mixed =
      seen * root(red) + (1 - seen) * (seen * root(green) + (1 - seen) * root(blue));
  for (int k = 0; k < 3; ++k) {
    const double got = image.row(50)[4 * 50 + k] / 255.0;
    const double gotRoot =
        std::sqrt(got <= 0.04045 ? got / 12.92 : std::pow((got + 0.055) / 1.055, 2.4));
    EXPECT_NEAR(gotRoot, mixed[k], 0.012) << "channel " << k;
  }
}

TEST(Renderer, ANinthGhostIsRefused) {
  RenderPreset p = test::flatPreset(60, 60);
  std::vector<frame::StructureTrack> parts;
  for (int i = 0; i < 9; ++i) {
    parts.push_back(test::box(fmt::format("g{}", i), {0, 0, 0}, {0.01f, 0.01f, 0.01f}));
    p.views["side"].ghosted[parts.back().name] = 0.5f;
  }
  auto r = Renderer::create(test::kShaders, p);
  ASSERT_TRUE(r.has_value());
  const auto image = r->draw(test::still(parts), 0, "side", {});
  ASSERT_FALSE(image.has_value());
  EXPECT_NE(image.error().text().find("ghosted"), std::string::npos);
}

TEST(Renderer, ShowsTheBolus) {
  const auto h = busyScene(24);
  const Image image = picture(fullPreset(320, 180), h, "oblique");
  int blue = 0;
  for (int i = 0; i < image.width * image.height; ++i) {
    const auto* c = &image.rgba[4 * static_cast<std::size_t>(i)];
    blue += c[2] > 120 && c[2] > c[0] + 60;
  }
  EXPECT_GT(blue, 200);
}

TEST(Renderer, EmptyHistoryIsBackground) {
  frame::History h;
  h.time_s = {0};
  const Image image = picture(test::flatPreset(64, 64), h, "side");
  EXPECT_EQ(lit(image).pixels, 0);
}

TEST(Renderer, ErrorsNameThePlaceAndTheRemedy) {
  const RenderPreset p = test::flatPreset(64, 64);
  const auto noFolder = Renderer::create("/nonexistent/shaders", p);
  ASSERT_FALSE(noFolder.has_value());
  EXPECT_NE(noFolder.error().place.find("solid.vert"), std::string::npos);

  auto r = Renderer::create(test::kShaders, p);
  ASSERT_TRUE(r.has_value());
  const auto h = test::still({test::box("b", {0, 0, 0}, {0.01f, 0.01f, 0.01f})});
  const auto badView = r->draw(h, 0, "sied", {});
  ASSERT_FALSE(badView.has_value());
  EXPECT_NE(badView.error().remedy.find("'side'"), std::string::npos) << badView.error().text();
  EXPECT_FALSE(r->draw(h, 1, "side", {}).has_value());
  frame::History torn = h;
  torn.structures[0].triangles[0][0] = 99;
  const auto badMesh = r->draw(torn, 0, "side", {});
  ASSERT_FALSE(badMesh.has_value());
  EXPECT_NE(badMesh.error().problem.find("99"), std::string::npos) << badMesh.error().text();

  RenderPreset odd = p;
  odd.height = 63;
  const auto badSize = Renderer::create(test::kShaders, odd);
  ASSERT_FALSE(badSize.has_value());
  EXPECT_EQ(badSize.error().kind, ErrorKind::usage);
}

TEST(Shaders, EachMissingFileIsNamed) {
  const fs::path copy = fs::path(testing::TempDir()) / "swallowclip_shaders_missing";
  for (const auto& file : fs::directory_iterator(test::kShaders)) {
    fs::remove_all(copy);
    fs::copy(test::kShaders, copy);
    fs::remove(copy / file.path().filename());
    const auto r = Renderer::create(copy, test::flatPreset(64, 64));
    ASSERT_FALSE(r.has_value()) << file.path().filename();
    EXPECT_NE(r.error().place.find(file.path().filename().string()), std::string::npos)
        << r.error().text();
  }
  fs::remove_all(copy);
}

TEST(Shaders, AnErrorCarriesTheCompilersWords) {
  const fs::path copy = fs::path(testing::TempDir()) / "swallowclip_shaders_broken";
  fs::remove_all(copy);
  fs::copy(test::kShaders, copy);
  std::ofstream(copy / "ao.frag") << "#version 450 core\nvoid main() { nonsense }\n";
  const auto r = Renderer::create(copy, test::flatPreset(64, 64));
  ASSERT_FALSE(r.has_value());
  EXPECT_TRUE(r.error().place.ends_with("ao.frag:2")) << r.error().place;
  fs::remove_all(copy);
}
}  // namespace
}  // namespace swallowclip::render
