// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "render/draw_list.h"
#include "shapes.h"

namespace swallowclip::render {
namespace {

double fanArea(const std::vector<Vertex>& fan, const Vec3f& normal) {
  double area = 0;
  for (std::size_t i = 0; i < fan.size(); i += 3)
    area +=
        0.5 *
        normal.dot(
            (fan[i + 1].position - fan[i].position).cross(fan[i + 2].position - fan[i].position));
  return area;
}

TEST(Section, FanOfABoxHasItsCrossSection) {
  const auto b = test::box("cube", {-0.02f, -0.03f, -0.01f}, {0.02f, 0.01f, 0.04f});
  const Vec3f n(1, 0, 0);
  const auto segments = sectionSegments(b.triangles, b.rest, n, 0.005f);
  for (const Vec3f& p : segments) EXPECT_NEAR(p.x(), 0.005, 1e-7);
  EXPECT_NEAR(std::abs(fanArea(sectionFan(segments, n), n)), 0.04 * 0.05, 1e-8);
}

TEST(Section, FanOfASphereIsADisc) {
  const auto s = test::ellipsoid("s", "bone", {0, 0, 0}, Vec3f::Constant(0.02f), 48);
  const Vec3f n = Vec3f(1, 2, 3).normalized();
  const auto segments = sectionSegments(s.triangles, s.rest, n, 0.01f);
  const double exact = kPi * (0.02 * 0.02 - 0.01 * 0.01);
  EXPECT_NEAR(std::abs(fanArea(sectionFan(segments, n), n)) / exact, 1.0, 0.01);
}

TEST(DrawMesh, SplitsABoxAtItsEdgesAndASphereNowhere) {
  const auto b = test::box("b", {0, 0, 0}, {1, 1, 1});
  const DrawMesh sharp = buildDrawMesh(b.triangles, b.rest, 0.87);
  EXPECT_EQ(sharp.source.size(), 24u);
  EXPECT_TRUE(sharp.closed);
  for (const Vertex& v : drawVertices(sharp, b.rest))
    EXPECT_NEAR(v.normal.cwiseAbs().maxCoeff(), 1.0, 1e-6);
  const auto s = test::ellipsoid("s", "bone", {0, 0, 0}, Vec3f::Constant(1), 24);
  EXPECT_EQ(buildDrawMesh(s.triangles, s.rest, 0.87).source.size(), s.rest.size());
}

TEST(DrawList, CutsHidesAndGhostsByName) {
  RenderPreset p = test::flatPreset(64, 64);
  ViewDef& v = p.views["side"];
  v.cuts.push_back({.except = {"whole"}});
  v.hidden = {"away"};
  v.ghosted["glass"] = 0.4f;
  const auto ball = [](const char* name, float x) {
    return test::ellipsoid(name, "bone", {x, 0, 0}, Vec3f::Constant(0.01f), 8);
  };
  const frame::History h = test::still(
      {ball("whole", 0), ball("half", 0), ball("gone", 0.02f), ball("away", 0), ball("glass", 0)});
  const Prepared prepared = prepare(h, 0.87, 0);
  const FrameGeometry geometry = frameGeometry(h, 0, prepared, p);
  const DrawList list = buildDrawList(h, 0, geometry, p, v);
  ASSERT_EQ(list.solid.size(), 2u);
  EXPECT_EQ(list.solid[0].name, "whole");
  EXPECT_TRUE(list.solid[0].cuts.empty());
  EXPECT_EQ(list.solid[1].name, "half");
  EXPECT_EQ(list.solid[1].cuts.size(), 1u);
  EXPECT_LT(list.solid[1].mesh.count, list.solid[0].mesh.count);
  ASSERT_EQ(list.ghost.size(), 1u);
  EXPECT_FLOAT_EQ(list.ghost[0].opacity, 0.4f);
}
}  // namespace
}  // namespace swallowclip::render
