// SPDX-License-Identifier: MIT
// Real meshes, where a reference pack lies beside the repository; skipped elsewhere.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "reference.h"
#include "render/renderer.h"
#include "shapes.h"

namespace swallowclip::render {
namespace {

frame::StructureTrack readObj(const std::filesystem::path& file, const std::string& name) {
  frame::StructureTrack s;
  s.name = name;
  s.poses.assign(1, Pose{});
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      Vec3f p;
      words >> p.x() >> p.y() >> p.z();
      s.rest.push_back(p * 1e-3f);
    } else if (kind == "f") {
      std::vector<int> corner;
      for (std::string w; words >> w;) corner.push_back(std::stoi(w) - 1);
      for (std::size_t k = 2; k < corner.size(); ++k)
        s.triangles.push_back({corner[0], corner[k - 1], corner[k]});
    }
  }
  return s;
}

TEST(ReferenceAnatomy, TongueSectionFillsItsArea) {
  const auto folder = swallowclip::test::referenceFolder();
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no folder " << folder;
  const auto tongue = readObj(folder / "meshes/ql2_tongue.obj", "tongue");
  ASSERT_GT(tongue.triangles.size(), 100u);
  RenderPreset p = test::flatPreset(320, 240);
  p.views["side"].target_m = {0, -0.01, -0.035};
  p.views["side"].eye_m = {0.3, -0.01, -0.035};
  p.views["side"].cuts.push_back({});
  auto r = Renderer::create(test::kShaders, p);
  ASSERT_TRUE(r.has_value()) << r.error().text();
  const auto image = r->draw(test::still({tongue}), 0, "side", {});
  ASSERT_TRUE(image.has_value()) << image.error().text();
  int section = 0, surface = 0;
  for (std::size_t i = 0; i < image->rgba.size(); i += 4) {
    section += image->rgba[i + 1] > image->rgba[i] + 40;
    surface += image->rgba[i] > image->rgba[i + 1] + 40;
  }
  EXPECT_GT(section, 10000);        // about 30 cm^2 at 5.8 pixels per mm^2
  EXPECT_GT(section, 3 * surface);  // little of the far side stands out behind it
}
}  // namespace
}  // namespace swallowclip::render
