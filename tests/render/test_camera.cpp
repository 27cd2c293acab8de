// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "render/camera.h"
#include "shapes.h"

namespace swallowclip::render {
namespace {

Bounds cube(float half) {
  Bounds b;
  b.add(Vec3f::Constant(-half));
  b.add(Vec3f::Constant(half));
  return b;
}

TEST(Camera, LateralViewShowsTheFaceToTheLeft) {
  const ViewDef view = test::flatPreset(64, 64).views["side"];
  const Camera c = makeCamera(view, 200, 100, cube(0.1f));
  const Vec3f posterior = (c.viewProjection * Eigen::Vector4f(0, 0.05f, 0, 1)).head<3>();
  EXPECT_NEAR(posterior.x(), 0.5, 1e-5);  // 50 mm of 100 mm half width, to the right
  const Vec3f top = (c.viewProjection * Eigen::Vector4f(0, 0, 0.05f, 1)).head<3>();
  EXPECT_NEAR(top.y(), 1.0, 1e-5);
}

TEST(Camera, NearAndFarHoldTheScene) {
  ViewDef view;
  view.eye_m = {0.2, -0.3, 0.1};
  view.target_m = {0, 0, 0};
  const Bounds scene = cube(0.08f);
  const Camera c = makeCamera(view, 128, 72, scene);
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector4f q = c.viewProjection * scene.corner(i).homogeneous();
    EXPECT_LT(std::abs(q.z()), q.w()) << "corner " << i;
  }
}

TEST(Camera, ShadowMapHoldsTheScene) {
  const Bounds scene = cube(0.07f);
  float radius = 0;
  const Mat4f m = shadowMatrix(scene, Vec3f(0.3f, -0.2f, 0.9f), &radius);
  for (int i = 0; i < 8; ++i) {
    const Vec3f p = (m * scene.corner(i).homogeneous()).head<3>();
    EXPECT_GE(p.minCoeff(), 0.0f);
    EXPECT_LE(p.maxCoeff(), 1.0f);
  }
}

TEST(RenderPreset, FindsMaterialByStructureThenMaterialThenFallback) {
  RenderPreset p = test::flatPreset(64, 64);
  p.materials["bone"].roughness = 0.1f;
  p.structures["hyoid"].roughness = 0.2f;
  EXPECT_FLOAT_EQ(p.materialFor("hyoid", "bone").roughness, 0.2f);
  EXPECT_FLOAT_EQ(p.materialFor("c2", "bone").roughness, 0.1f);
  EXPECT_FLOAT_EQ(p.materialFor("c2", "cheese").roughness, 1.0f);
}

TEST(RenderPreset, RefusesWhatCannotBeFilmed) {
  RenderPreset p = test::flatPreset(64, 64);
  EXPECT_EQ(p.validate(), "");
  p.width = 63;
  EXPECT_NE(p.validate().find("even"), std::string::npos) << p.validate();
  p.width = 64;
  p.fps = 25;
  EXPECT_NE(p.validate().find("25"), std::string::npos) << p.validate();
  p.fps = 30;
  p.views["side"].up = p.views["side"].eye_m;
  EXPECT_NE(p.validate().find("side"), std::string::npos) << p.validate();
}
}  // namespace
}  // namespace swallowclip::render
