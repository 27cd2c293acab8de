// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "core/tri_mesh.h"

using namespace swallowclip;

namespace {
/// Octahedron refined `levels` times onto the sphere of radius 1.
TriMesh sphere(int levels) {
  TriMesh m{
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  for (int l = 0; l < levels; ++l) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [at, isNew] = middles.try_emplace(std::minmax(a, b), int(m.positions.size()));
      if (isNew) m.positions.push_back((m.positions[a] + m.positions[b]).normalized());
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : m.triangles) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    m.triangles = finer;
  }
  return m;
}

TriMesh cube() {
  TriMesh m;
  for (int i = 0; i < 8; ++i) m.positions.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
  m.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return m;
}
}  // namespace

TEST(Manifold, ClosedMeshesPass) {
  for (const TriMesh& m : {cube(), sphere(0), sphere(3)}) {
    const auto report = checkManifold(m.triangles, int(m.positions.size()));
    EXPECT_TRUE(report.closed()) << report.text();
  }
}

TEST(Manifold, EveryDefectIsCounted) {
  TriMesh open = cube();
  open.triangles.pop_back();
  EXPECT_EQ(checkManifold(open.triangles, 8).openEdges, 3);

  TriMesh flipped = cube();
  std::swap(flipped.triangles[0][1], flipped.triangles[0][2]);
  EXPECT_EQ(checkManifold(flipped.triangles, 8).flippedEdges, 3);

  TriMesh tripled = cube();
  tripled.positions.emplace_back(0.5, 0.5, 2);
  tripled.triangles.push_back({0, 3, 8});
  EXPECT_GE(checkManifold(tripled.triangles, 9).nonManifoldEdges, 1);

  TriMesh degenerate = cube();
  degenerate.triangles.push_back({1, 1, 2});
  EXPECT_EQ(checkManifold(degenerate.triangles, 8).degenerate, 1);

  TriMesh pinched = cube();  // a second cube hangs on vertex 7
  const TriMesh other = cube();
  for (const Vec3& p : other.positions) pinched.positions.push_back(p + Vec3(1, 1, 1));
  for (Triangle t : other.triangles) {
    for (int& v : t) v = v == 0 ? 7 : v + 8;
    pinched.triangles.push_back(t);
  }
  const auto report = checkManifold(pinched.triangles, 16);
  EXPECT_EQ(report.badVertices, 1) << report.text();
  EXPECT_FALSE(report.closed());
}

TEST(Volume, CubeSphereAndMovedSphere) {
  EXPECT_NEAR(volume(cube()), 1, 1e-14);
  // The inscribed polyhedron's volume error falls with the square of the edge: factor 4 per level.
  const double exact = 4 * kPi / 3;
  const double coarse = exact - volume(sphere(4)), fine = exact - volume(sphere(5));
  EXPECT_GT(coarse, 0);
  EXPECT_NEAR(coarse / fine, 4, 0.05);
  TriMesh moved = sphere(3);
  for (Vec3& p : moved.positions) p += Vec3(100, -50, 30);
  EXPECT_NEAR(volume(moved), volume(sphere(3)), 1e-9);
  TriMesh inside = cube();
  for (Triangle& t : inside.triangles) std::swap(t[1], t[2]);
  EXPECT_NEAR(volume(inside), -1, 1e-14);
}

TEST(Normals, PointAwayFromTheCentreOfASphere) {
  const TriMesh m = sphere(4);
  const auto normals = vertexNormals(m.positions, m.triangles);
  for (std::size_t i = 0; i < normals.size(); ++i)
    EXPECT_GT(normals[i].dot(m.positions[i]), 0.999) << i;
}

/// Slow twin: the closest of many sampled points can only be farther than the exact one.
TEST(ClosestPoint, AgreesWithSampling) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto point = [&] { return Vec3(uniform(random), uniform(random), uniform(random)); };
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 a = point(), b = point(), c = point(), p = 2 * point();
    const Vec3 w = closestBarycentric(p, a, b, c);
    EXPECT_NEAR(w.sum(), 1, 1e-12);
    EXPECT_GE(w.minCoeff(), -1e-12);
    const double exact = (p - (w[0] * a + w[1] * b + w[2] * c)).norm();
    double sampled = 1e9;
    constexpr int kSteps = 60;
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; i + j <= kSteps; ++j) {
        const Vec3 q = a + (b - a) * i / kSteps + (c - a) * j / kSteps;
        sampled = std::min(sampled, (p - q).norm());
      }
    EXPECT_LE(exact, sampled + 1e-12);
    EXPECT_LE(sampled - exact, 3.5 / kSteps) << "trial " << trial;  // spacing of the samples
  }
}

TEST(WindingNumber, InsideOneOutsideZeroAndFractionsOnOpenMeshes) {
  const TriMesh m = sphere(3);
  for (const double r : {0.0, 0.5, 0.9})
    EXPECT_NEAR(windingNumber(Vec3(0.6, 0.8, 0) * r, m.positions, m.triangles), 1, 1e-12);
  for (const double r : {1.1, 2.0, 50.0})
    EXPECT_NEAR(windingNumber(Vec3(0, 0.6, 0.8) * r, m.positions, m.triangles), 0, 1e-12);
  const TriMesh box = cube();
  const std::vector<Triangle> oneFace(box.triangles.begin(), box.triangles.begin() + 2);
  EXPECT_NEAR(windingNumber(Vec3(0.5, 0.5, 0.5), box.positions, oneFace), 1.0 / 6, 1e-12);
}

TEST(Pose, InverseAndProduct) {
  const Pose a{Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())), Vec3(1, -2, 3)};
  const Pose b{Quat(Eigen::AngleAxisd(-1.3, Vec3(0, 1, -1).normalized())), Vec3(0, 5, 1)};
  const Vec3 p(0.3, 0.4, -2);
  EXPECT_NEAR((a.inverse().apply(a.apply(p)) - p).norm(), 0, 1e-14);
  EXPECT_NEAR(((a * b).apply(p) - a.apply(b.apply(p))).norm(), 0, 1e-14);
}
