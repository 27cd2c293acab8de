// SPDX-License-Identifier: MIT
// Fluoroscopy in numbers: known bodies against Beer-Lambert's law, noise against its own
// statistics.
#include <gtest/gtest.h>

#include <cmath>

#include "render/renderer.h"
#include "render/xray.h"
#include "shapes.h"

namespace swallowclip::render {
namespace {
constexpr int kSize = 200;
constexpr double kPixel_m = 0.1 / kSize;  // flatPreset's side view is 100 mm high, seen along x

RenderPreset machine() {
  RenderPreset p = test::flatPreset(kSize, kSize);
  p.views["side"].style = Style::fluoro;
  p.fluoro.body = false;
  p.fluoro.quanta_per_m2 = p.fluoro.scatterToPrimary = p.fluoro.blur_m = 0;
  p.fluoro.fieldWidth_m = 0;
  return p;
}

FloatImage signal(const RenderPreset& preset, const frame::History& h, int frame = 0) {
  auto r = Renderer::create(test::kShaders, preset);
  EXPECT_TRUE(r.has_value()) << r.error().text();
  auto s = r->signal(h, frame, "side");
  EXPECT_TRUE(s.has_value()) << s.error().text();
  return s ? *s : FloatImage();
}

double mu(const std::string& name) {
  return substance(name)->attenuation_per_m();
}
double y_m(int x) {
  return (x + 0.5 - kSize / 2) * kPixel_m;
}  // posterior lies right

/// A closed prism along z, +-`half_m`, over a loop that runs anticlockwise seen from above.
frame::StructureTrack prism(const std::string& material, const std::vector<Vec2>& loop,
                            double half_m) {
  frame::StructureTrack s;
  s.name = "prism";
  s.material = material;
  s.poses.assign(1, Pose{});
  const int n = static_cast<int>(loop.size());
  for (double z : {-half_m, half_m})
    for (const Vec2& p : loop) s.rest.push_back(Vec3(p.x(), p.y(), z).cast<float>());
  for (int k = 0; k < n; ++k) {
    const int l = (k + 1) % n;
    s.triangles.push_back({k, l, n + l});
    s.triangles.push_back({k, n + l, n + k});
  }
  for (int k = 1; k + 1 < n; ++k) {
    s.triangles.push_back({0, k + 1, k});
    s.triangles.push_back({n, n + k, n + k + 1});
  }
  return s;
}

TEST(Fluoroscopy, WaterCylinderFollowsBeerAndLambert) {
  const double radius = 0.03;
  std::vector<Vec2> circle;
  for (int k = 0; k < 720; ++k)
    circle.emplace_back(radius * std::cos(kPi * k / 360), radius * std::sin(kPi * k / 360));
  const auto s = signal(machine(), test::still({prism("water", circle, 0.04)}));
  for (int x = 0; x < kSize; ++x) {
    const double y = std::abs(y_m(x));
    if (std::abs(y - radius) < 1e-3) continue;  // the limb, a pixel wide
    const double chord = y < radius ? 2 * std::sqrt(radius * radius - y * y) : 0;
    const double expected = std::exp(-20.59 * chord);  // NIST: 0.2059 cm2/g, 1 g/cm3
    EXPECT_NEAR(s.at(x, kSize / 2) / expected, 1, 0.01) << "column " << x;
  }
}

TEST(Fluoroscopy, AluminiumWedgeFollowsBeerAndLambert) {
  // from 0 to 20 mm over 60 mm
  const auto wedge = prism("aluminium", {{-0.01, 0.03}, {0, -0.03}, {0.01, 0.03}}, 0.03);
  const auto s = signal(machine(), test::still({wedge}));
  for (int x = 45; x < 155; ++x) {
    const double thick = 0.02 * (y_m(x) + 0.03) / 0.06;
    EXPECT_NEAR(s.at(x, kSize / 2) / std::exp(-27.78 * 2.699 * thick), 1, 0.01) << "column " << x;
  }
}

TEST(Fluoroscopy, RayLengthsThroughSphereAndCube) {
  const double r = 0.03;
  const auto ball = signal(
      machine(),
      test::still({test::ellipsoid("b", "water", {0.02f, 0, 0}, Vec3f::Constant(0.03f), 160)}));
  for (int x = 42; x < 158; ++x) {
    const double y = y_m(x), z = 0.5 * kPixel_m;
    const double length = -std::log(ball.at(x, kSize / 2)) / mu("water");
    EXPECT_NEAR(length / (2 * std::sqrt(r * r - y * y - z * z)), 1, 0.005) << "column " << x;
  }
  frame::StructureTrack cube = test::box("c", Vec3f::Constant(-0.02f), Vec3f::Constant(0.02f));
  cube.material = "water";
  const auto c = signal(machine(), test::still({cube}));
  for (int x = 61; x < 139; ++x)
    EXPECT_NEAR(-std::log(c.at(x, kSize / 2)) / mu("water") / 0.04, 1, 0.005);
  // two bodies on one ray add
  frame::StructureTrack other = test::box("d", {0.03f, -0.02f, -0.02f}, {0.05f, 0.02f, 0.02f});
  other.material = "aluminium";
  const auto both = signal(machine(), test::still({cube, other}));
  EXPECT_NEAR(-std::log(both.at(100, 100)), 0.04 * mu("water") + 0.02 * mu("aluminium"), 0.005);
}

TEST(Fluoroscopy, TwiceTheBariumIsTwiceTheContrast) {
  frame::History h = test::still({});
  h.bolus.particleVolume_m3 = 8e-9;
  h.bolus.positions = {test::lattice({0, 0, 0}, {0.004f, 0.02f, 0.01f}, 2e-3f)};
  h.bolus.state = {std::vector<frame::ParticleState>(h.bolus.positions[0].size())};
  const auto depths = [&](double barium_kgm3) {
    h.meta.bariumSulfate_kgm3 = barium_kgm3;
    std::vector<double> d;
    for (float s : signal(machine(), h).values) d.push_back(-std::log(s));
    return d;
  };
  const auto none = depths(0), one = depths(200), two = depths(400);
  int inside = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    if (none[i] < 0.02) continue;
    ++inside;
    EXPECT_NEAR((two[i] - none[i]) / (one[i] - none[i]), 2, 0.01);
  }
  EXPECT_GT(inside, 1000);
  // 40 % w/v: XCOM 5.116 cm2/g of barium sulfate, and the water that its grains leave
  EXPECT_NEAR(suspension_per_m(400), 0.4 * 511.6 + (1 - 0.4 / 4.5) * 20.59, 0.05);
}

TEST(Fluoroscopy, QuantumNoiseHasThePoissonVarianceAndItsOwnFrame) {
  RenderPreset p = machine();
  p.fluoro.quanta_per_m2 = 400e6f;
  frame::History h = test::still({});
  h.time_s = {0, 1};
  const auto a = signal(p, h), again = signal(p, h), b = signal(p, h, 1);
  EXPECT_EQ(a.values, again.values);
  double mean = 0, square = 0, product = 0;
  const double n = static_cast<double>(a.values.size());
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    mean += a.values[i] / n;
    square += (a.values[i] - 1.0) * (a.values[i] - 1.0) / n;
    product += (a.values[i] - 1.0) * (b.values[i] - 1.0) / n;
  }
  const double quanta = 400e6 * std::exp(2.5) * kPixel_m * kPixel_m;
  EXPECT_NEAR(mean, 1, 4 / std::sqrt(quanta * n));
  EXPECT_NEAR(square * quanta, 1, 0.03);   // 40 000 pixels: standard error 0.7 %
  EXPECT_NEAR(product * quanta, 0, 0.03);  // frames are independent
}

TEST(Fluoroscopy, ScatterVeilsAndBladesShut) {
  RenderPreset p = machine();
  p.fluoro.scatterToPrimary = 0.4f;
  frame::StructureTrack slab = test::box("s", {-0.06f, -0.2f, -0.2f}, {0.06f, 0.2f, 0.2f});
  slab.material = "water";  // wide and even: 0.12 m, optical depth 2.47
  const double depth = 0.12 * mu("water");
  const auto s = signal(p, test::still({slab}));
  EXPECT_NEAR(s.at(100, 100) / std::exp(-depth), 1 + 0.4 * depth / 2.5, 0.005);
  p.fluoro.fieldWidth_m = p.fluoro.fieldHeight_m = 0.05f;
  const auto shut = signal(p, test::still({slab}));
  EXPECT_NEAR(shut.at(100, 100), s.at(100, 100), 1e-6);
  EXPECT_EQ(shut.at(20, 100), 0);
  EXPECT_EQ(shut.at(100, 180), 0);
}

TEST(Fluoroscopy, LumenIsAirWithinTheBody) {
  RenderPreset p = machine();
  p.fluoro.body = true;
  frame::History h = test::still({});
  const auto whole = signal(p, h);
  const auto lumen = test::box("", {-0.01f, -0.01f, -0.01f}, {0.01f, 0.01f, 0.01f});
  h.skin.triangles = lumen.triangles;
  h.skin.positions = {lumen.rest};
  const auto hollow = signal(p, h);
  EXPECT_NEAR(std::log(hollow.at(100, 100) / whole.at(100, 100)), 0.02 * mu("soft-tissue"), 1e-3);
  EXPECT_EQ(hollow.at(20, 100), whole.at(20, 100));
  EXPECT_NEAR(-std::log(whole.at(100, 100)) / mu("soft-tissue"), 0.13, 0.01);  // head 130 mm broad
}

TEST(Fluoroscopy, BonesHaveADenseLayerAtRightAngles) {
  const auto cube = test::box("hyoid", Vec3f::Constant(-0.02f), Vec3f::Constant(0.02f));
  const auto s = signal(machine(), test::still({cube}));
  const double layer = 2 * corticalThickness_m("hyoid", "bone");
  EXPECT_NEAR(-std::log(s.at(100, 100)), mu("bone") * (0.04 - layer) + mu("cortical-bone") * layer,
              0.005);
}

TEST(Fluoroscopy, AnUnknownMaterialGetsTheNearest) {
  auto body = test::box("b", Vec3f::Constant(-0.02f), Vec3f::Constant(0.02f));
  body.material = "cartilege";
  auto r = Renderer::create(test::kShaders, machine());
  ASSERT_TRUE(r.has_value());
  const auto s = r->signal(test::still({body}), 0, "side");
  ASSERT_FALSE(s.has_value());
  EXPECT_NE(s.error().text().find("'cartilage'"), std::string::npos) << s.error().text();
}
}  // namespace
}  // namespace swallowclip::render
