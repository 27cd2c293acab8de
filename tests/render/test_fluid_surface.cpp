// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <map>

#include "render/fluid_surface.h"
#include "shapes.h"

namespace swallowclip::render {
namespace {

constexpr float kDx = 2e-3f;

std::vector<FluidParticle> freeParticles(const std::vector<Vec3f>& p) {
  std::vector<FluidParticle> out;
  for (const Vec3f& x : p) out.push_back({x});
  return out;
}

double volumeOf(const FluidSurface& s) {
  std::vector<Vec3> p;
  for (const Vec3f& x : s.positions) p.push_back(x.cast<double>());
  return volume(p, s.triangles);
}

int openEdges(const FluidSurface& s) {
  std::map<std::pair<int, int>, int> walks;  // forwards minus backwards
  for (const Triangle& t : s.triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      walks[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  int open = 0;
  for (const auto& [edge, n] : walks) open += n != 0;
  return open;
}

TEST(FluidSurface, FiveMillilitresKeepTheirVolume) {
  const auto p = test::lattice({0, -0.02f, -0.01f}, {0.0106f, 0.0106f, 0.0106f}, kDx);
  const FluidSurface s = fluidSurface(freeParticles(p), {});
  const double exact = static_cast<double>(p.size()) * kDx * kDx * kDx;
  EXPECT_NEAR(volumeOf(s) / exact, 1.0, 0.05) << p.size() << " particles";
  EXPECT_EQ(openEdges(s), 0);
}

TEST(FluidSurface, NormalsPointOut) {
  const Vec3f centre(0.01f, 0.02f, -0.03f);
  const auto p = test::lattice(centre, Vec3f::Constant(0.01f), kDx);
  const FluidSurface s = fluidSurface(freeParticles(p), {});
  ASSERT_FALSE(s.positions.empty());
  for (std::size_t i = 0; i < s.positions.size(); ++i)
    EXPECT_GT(s.normals[i].dot((s.positions[i] - centre).normalized()), 0.5f);
}

TEST(FluidSurface, ALoneDropDoesNotVanish) {
  const std::vector<FluidParticle> one{{Vec3f(0, 0, 0)}};
  const double ratio = volumeOf(fluidSurface(one, {})) / (kDx * kDx * kDx);
  EXPECT_GT(ratio, 0.5);
  EXPECT_LT(ratio, 2.0);
}

TEST(FluidSurface, FilmLiesFlatOnItsWall) {
  std::vector<FluidParticle> film;
  for (int i = 0; i < 6; ++i)
    for (int k = 0; k < 6; ++k)
      film.push_back(
          {Vec3f(kDx * static_cast<float>(i), kDx * static_cast<float>(k), 0), Vec3f(0, 0, 1)});
  const FluidSurface s = fluidSurface(film, {});
  float thickness = 0;
  for (const Vec3f& x : s.positions) thickness = std::max(thickness, std::abs(x.z()));
  EXPECT_LT(thickness, 0.8f * kDx);
  EXPECT_GT(thickness, 0.2f * kDx);
  EXPECT_EQ(openEdges(s), 0);
}

TEST(FluidSurface, ALoneFilmDiscHasAboutItsParticlesVolume) {
  const std::vector<FluidParticle> one{{Vec3f(0, 0, 0), Vec3f(0, 0, 1)}};
  const double ratio = volumeOf(fluidSurface(one, {})) / (kDx * kDx * kDx);
  EXPECT_GT(ratio, 0.5);
  EXPECT_LT(ratio, 1.5);
}

TEST(KeepWithin, NothingIsDrawnBehindAWall) {
  // a slab of fluid on a floor: its blobs bulge through the plane z = 0 until they are brought back
  FluidSurface s =
      fluidSurface(freeParticles(test::lattice({0, 0, 0.0025f}, {0.01f, 0.01f, 0.0025f}, kDx)), {});
  LumenWall floor;
  for (int i = -20; i < 20; ++i)
    for (int k = -20; k < 20; ++k) {
      floor.positions.push_back(1e-3f * Vec3f(static_cast<float>(i), static_cast<float>(k), 0));
      floor.normals.push_back(Vec3f(0, 0, -1));
    }
  const auto lowest = [&] {
    float z = 1;
    for (const Vec3f& x : s.positions) z = std::min(z, x.z());
    return z;
  };
  EXPECT_LT(lowest(), -0.3e-3f);
  keepWithin(s, floor, 1.5 * kDx);
  EXPECT_GT(lowest(), -1e-6f);
}

// A ball of 5 mL at 2 mm spacing beside the sphere of its particles' volume.
TEST(FluidSurface, ABallIsTheSphereOfItsVolume) {
  const auto p = test::lattice({0, 0, 0}, Vec3f::Constant(0.0106f), kDx);
  const double radius = std::cbrt(3.0 / (4 * kPi) * static_cast<double>(p.size())) * kDx;
  const FluidSurface s = fluidSurface(freeParticles(p), {});
  double square = 0, farthest = 0, tilt = 0;
  for (std::size_t i = 0; i < s.positions.size(); ++i) {
    const double off = s.positions[i].norm() - radius;
    square += off * off / static_cast<double>(s.positions.size());
    farthest = std::max(farthest, std::abs(off));
    tilt += std::acos(std::min(1.0f, s.normals[i].dot(s.positions[i].normalized()))) /
            static_cast<double>(s.positions.size());
  }
  std::fprintf(stderr, "ball of %.1f mm: %.2f mm rms, %.2f mm at most, normals %.1f deg off\n",
               1e3 * radius, 1e3 * std::sqrt(square), 1e3 * farthest, tilt * 180 / kPi);
  EXPECT_LT(std::sqrt(square), 0.15 * kDx);
  EXPECT_LT(farthest, 0.5 * kDx);
  EXPECT_LT(tilt * 180 / kPi, 12);
}

// Two blocks of fluid with flat faces and air between: once the gap is wider than a particle, it is
// seen.
TEST(FluidSurface, AGapWiderThanAParticleStaysOpen) {
  const auto bridged = [](float gap) {  // between outermost particles
    std::vector<FluidParticle> p;
    for (int x = 0; x < 6; ++x)
      for (int y = 0; y < 6; ++y)
        for (int z = 0; z < 4; ++z)
          for (float side : {-1.0f, 1.0f})
            p.push_back(
                {Vec3f(kDx * (static_cast<float>(x) - 2.5f), kDx * (static_cast<float>(y) - 2.5f),
                       side * (0.5f * gap + kDx * static_cast<float>(z)))});
    for (const Vec3f& x : fluidSurface(p, {}).positions)
      if (x.head<2>().cwiseAbs().maxCoeff() < kDx && std::abs(x.z()) < 0.4f * gap) return false;
    return true;  // no face towards the gap
  };
  EXPECT_TRUE(bridged(kDx));          // one fluid
  EXPECT_FALSE(bridged(2.0f * kDx));  // a particle of air between them
}

// A sheet one particle thick beside the film of its volume.
TEST(FluidSurface, AThinSheetIsWholeAndAsThickAsItsVolume) {
  std::vector<Vec3f> p;
  for (int x = -6; x <= 6; ++x)
    for (int y = -6; y <= 6; ++y)
      p.push_back(kDx * Vec3f(static_cast<float>(x), static_cast<float>(y), 0));
  const FluidSurface s = fluidSurface(freeParticles(p), {});
  double mean = 0, least = 1, most = 0;
  int n = 0;
  for (const Vec3f& x : s.positions)
    if (x.head<2>().cwiseAbs().maxCoeff() < 4 * kDx) {
      const double half = std::abs(x.z());
      mean += half;
      least = std::min(least, half);
      most = std::max(most, half);
      ++n;
    }
  ASSERT_GT(n, 100);
  mean *= 2.0 / n;
  std::fprintf(stderr, "sheet of 2 mm: %.2f mm thick, %.2f to %.2f\n", 1e3 * mean, 2e3 * least,
               2e3 * most);
  EXPECT_NEAR(mean / kDx, 1.0, 0.25);
  EXPECT_GT(least, 0.25 * kDx);  // no hole
}

TEST(FluidSurface, NothingFromNothing) {
  EXPECT_TRUE(fluidSurface({}, {}).triangles.empty());
}

TEST(FluidSurface, DoesNotCrawlWithTheGrid) {
  // the same drop half a cell further must keep its volume: no popping while the bolus moves
  const auto volumeAt = [](float shift) {
    return volumeOf(fluidSurface(
        freeParticles(test::lattice({shift, 0, 0}, {0.008f, 0.01f, 0.006f}, kDx)), {}));
  };
  EXPECT_NEAR(volumeAt(0.5e-3f) / volumeAt(0), 1.0, 0.01);
}
}  // namespace
}  // namespace swallowclip::render
