// SPDX-License-Identifier: MIT
// A straight round lumen between two soft half shells that bend together: by Pappus' theorem the
// lumen's volume stays pi r^2 L however far its middle line is bent.
#include <gtest/gtest.h>

#include "../biomech/shapes.h"
#include "airway/airway_skin.h"
#include "airway/interpenetration.h"

namespace swallowclip::airway {
namespace {

constexpr double kRadius_m = 0.008, kShell_m = 0.003, kLength_m = 0.06;
constexpr int kAround = 32, kAlong = 30, kFrames = 12;

Vec3 onTube(double radius_m, int around, int along) {
  const double a = 2 * kPi * around / kAround;
  return {radius_m * std::cos(a), kLength_m * along / kAlong, radius_m * std::sin(a)};
}

// Faces out of a grid whose rows run along the tube.
void addStrip(std::vector<Triangle>& out, const std::vector<int>& a, const std::vector<int>& b) {
  for (size_t k = 0; k + 1 < a.size(); ++k)
    out.insert(out.end(), {{a[k], a[k + 1], b[k]}, {b[k], a[k + 1], b[k + 1]}});
}

// Capped cylinder; its side vertices come first, row by row around.
BindSkin tubeSkin() {
  BindSkin skin;
  auto& m = skin.mesh;
  std::vector<std::vector<int>> rows(kAround + 1);
  for (int i = 0; i < kAround; ++i)
    for (int j = 0; j <= kAlong; ++j) {
      rows[i].push_back(static_cast<int>(m.positions.size()));
      m.positions.push_back(onTube(kRadius_m, i, j));
    }
  rows[kAround] = rows[0];
  const int front = static_cast<int>(m.positions.size());
  m.positions.push_back({0, 0, 0});
  m.positions.push_back({0, kLength_m, 0});
  for (int i = 0; i < kAround; ++i) {
    addStrip(m.triangles, rows[i + 1], rows[i]);
    m.triangles.push_back({front, rows[i + 1].front(), rows[i].front()});
    m.triangles.push_back({front + 1, rows[i].back(), rows[i + 1].back()});
  }
  if (volume(m) < 0)
    for (Triangle& t : m.triangles) std::swap(t[0], t[1]);
  for (const Vec3& p : m.positions) skin.wall.push_back(p.z() > 1e-9 ? 0 : 1);
  return skin;
}

// Half of a thick pipe, closed; its inner face shares the skin's vertices.
TriMesh halfShell(int firstRow) {
  TriMesh m;
  std::vector<std::vector<int>> in, out;
  for (int i = firstRow; i <= firstRow + kAround / 2; ++i)
    for (auto* side : {&in, &out}) {
      side->emplace_back();
      for (int j = 0; j <= kAlong; ++j) {
        side->back().push_back(static_cast<int>(m.positions.size()));
        m.positions.push_back(onTube(kRadius_m + (side == &out ? kShell_m : 0), i, j));
      }
    }
  const size_t rows = in.size();
  for (size_t i = 0; i + 1 < rows; ++i) {
    addStrip(m.triangles, in[i], in[i + 1]);
    addStrip(m.triangles, out[i + 1], out[i]);
    const auto cap = [&](size_t j, bool flip) {
      Triangle a{in[i][j], in[i + 1][j], out[i][j]}, b{out[i][j], in[i + 1][j], out[i + 1][j]};
      if (flip) std::swap(a[0], a[1]), std::swap(b[0], b[1]);
      m.triangles.insert(m.triangles.end(), {a, b});
    };
    cap(0, false);
    cap(kAlong, true);
  }
  addStrip(m.triangles, out.front(), in.front());
  addStrip(m.triangles, in.back(), out.back());
  if (volume(m) < 0)
    for (Triangle& t : m.triangles) std::swap(t[0], t[1]);
  return m;
}

// The middle line becomes an arc of this curvature in the y-z plane.
Vec3 bent(const Vec3& p, double curvature_1m) {
  if (curvature_1m == 0) return p;
  const double r = 1 / curvature_1m, a = p.y() * curvature_1m;
  return {p.x(), (r - p.z()) * std::sin(a), r - (r - p.z()) * std::cos(a)};
}
double curvature(int frame) {
  return 25.0 * frame / (kFrames - 1);
}  // radius 40 mm at the end

struct Tube {
  biomech::Model model;
  AirwaySkin skin;
};
Tube bendingTube() {
  kinematics::MeshSequence s;
  const auto bend = [](int k, std::vector<Vec3> p) {
    for (Vec3& x : p) x = bent(x, curvature(k));
    return p;
  };
  s.structures.push_back(test::sequenceOf("upper", false, halfShell(0), kFrames, bend));
  s.structures.push_back(test::sequenceOf("lower", false, halfShell(kAround / 2), kFrames, bend));
  auto model = biomech::Model::build(s);
  EXPECT_TRUE(model.has_value()) << (model ? "" : model.error().text());
  SkinningDef def;
  def.walls = {{0, {"upper"}}, {1, {"lower"}}};
  auto skin = attachSkin(tubeSkin(), *model, def);
  EXPECT_TRUE(skin.has_value()) << (skin ? "" : skin.error().text());
  return {std::move(*model), std::move(*skin)};
}

TEST(BendingTube, ShellsAreClosedAndUnstrainedAtRest) {
  const Tube tube = bendingTube();
  ThreadPool pool(1);
  for (int i = 0; i < 2; ++i) {
    const biomech::ModelStructure& s = tube.model.structures()[i];
    EXPECT_TRUE(
        checkManifold(s.rest.triangles, static_cast<int>(s.rest.positions.size())).closed());
    EXPECT_EQ(s.wedges->skippedTriangles(), 0);
    const auto field = tube.model.strain(tube.model.at(tube.model.start_s()), i, pool);
    EXPECT_LT(*std::max_element(field.equivalentStrain.begin(), field.equivalentStrain.end()),
              1e-9);
  }
}

TEST(BendingTube, SkinIsTheBentTubeAndKeepsItsVolume) {
  const Tube tube = bendingTube();
  const BindSkin& bind = tube.skin.bind();
  ThreadPool pool(1);
  const double before = volume(bind.mesh);
  EXPECT_NEAR(before, kPi * kRadius_m * kRadius_m * kLength_m, 0.01 * before);
  for (int k = 0; k < kFrames; ++k) {
    const auto p = tube.skin.deform(tube.model, tube.model.at(tube.model.start_s() + k / 34.0));
    for (size_t v = 0; v + 2 < p.size(); ++v)  // all but the two cap centres
      ASSERT_LT((p[v] - bent(bind.mesh.positions[v], curvature(k))).norm(), 1e-12);
    EXPECT_NEAR(volume(p, bind.mesh.triangles) / before, 1, 0.01);
    EXPECT_EQ(maxInterpenetration(p, bind.mesh.triangles, pool).depth_m, 0);
  }
}

TEST(BendingTube, ElementsStretchOutsideAndShortenInside) {
  const Tube tube = bendingTube();
  ThreadPool pool(2);
  // longitudinal Green-Lagrange strain at radius z from the middle line: ((1 - z k)^2 - 1)/2
  const double k = curvature(kFrames - 1);
  const auto state = tube.model.at(tube.model.end_s());
  const auto& upper = tube.model.structures()[0];
  const auto field = tube.model.strain(state, 0, pool);
  int seen = 0;
  for (int e = 0; e < upper.wedges->elements(); ++e) {
    Vec3 centre = Vec3::Zero();
    for (int node : upper.wedges->connectivity()[e]) centre += upper.wedges->restNodes()[node] / 6;
    if (std::abs(centre.x()) > 0.002 || centre.y() < 0.01 || centre.y() > 0.05) continue;
    EXPECT_NEAR(field.strain[e](1, 1), (std::pow(1 - centre.z() * k, 2) - 1) / 2, 0.02);
    ++seen;
  }
  EXPECT_GT(seen, 100);
  EXPECT_EQ(field.foldedElements, 0) << field.minJacobianRatio;
}
}  // namespace
}  // namespace swallowclip::airway
