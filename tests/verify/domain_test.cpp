// SPDX-License-Identifier: MIT
// Walls of cases: closed, of the right volume, moving as they say; fluid of the right volume
// inside.
#include "verify/domain.h"

#include <gtest/gtest.h>

#include <cmath>

#include "verify/fill.h"

using namespace swallowclip;
using namespace swallowclip::verify;

namespace {
CaseDef room(Shape shape) {
  CaseDef def;
  def.domain.shape = shape;
  def.domain.size_m = {0.02, 0.005, 0.016};
  def.domain.radius_m = 0.008;
  def.domain.length_m = 0.02;
  def.domain.periodic[0] = shape == Shape::tube;
  def.fill.push_back({});
  return def;
}

void expectClosedAndTrueToItsVelocity(const CaseDef& def) {
  const auto domain = Domain::build(def, 1e-3);
  ASSERT_TRUE(domain);
  const bolus::WallMotion& w = domain->walls();
  std::vector<Vec3> x, v, later, earlier, unused;
  for (double t : {0.0, 0.05, 0.2}) {
    w.at(t, x, v);
    ASSERT_TRUE(checkManifold(w.triangles, static_cast<int>(x.size())).closed());
    EXPECT_GT(volume(x, w.triangles), 0);
    if (def.motion.kind == MotionKind::slide) continue;  // slides in itself
    const double dt = 1e-6;
    w.at(t + dt, later, unused);
    w.at(t + 2 * dt, earlier, unused);
    for (std::size_t k = 0; k < x.size(); ++k) {
      const Vec3 moved = (4 * later[k] - 3 * x[k] - earlier[k]) / (2 * dt);
      // side walls of a piston get shorter without sliding
      if (def.motion.kind == MotionKind::piston || def.motion.kind == MotionKind::close) {
        EXPECT_TRUE(v[k].norm() == 0 || (moved - v[k]).norm() < 1e-6);
      } else {
        EXPECT_NEAR((moved - v[k]).norm(), 0, 1e-5);
      }
    }
  }
}
}  // namespace

TEST(Domain, VolumesAreExact) {
  for (Shape shape : {Shape::box, Shape::cylinder}) {
    const CaseDef def = room(shape);
    const auto domain = Domain::build(def, 1e-3);
    std::vector<Vec3> x, v;
    domain->walls().at(0, x, v);
    EXPECT_NEAR(volume(x, domain->walls().triangles), domain->volume_m3(),
                1e-9 * domain->volume_m3());
  }
}

TEST(Domain, EveryMotionKeepsWallsClosed) {
  for (MotionKind kind : {MotionKind::still, MotionKind::slide, MotionKind::piston,
                          MotionKind::close, MotionKind::rotate, MotionKind::peristalsis}) {
    const bool round = kind == MotionKind::rotate;
    CaseDef def = room(round ? Shape::cylinder : Shape::box);
    if (kind == MotionKind::peristalsis) def.domain.periodic = {true, true, false};
    def.motion.kind = kind;
    def.motion.velocity_ms = {0.05, 0, 0};
    def.motion.speed.points = {{0.0, 0.0}, {0.1, round ? 20.0 : 0.02}};
    def.motion.occlusion = 0.5;
    expectClosedAndTrueToItsVelocity(def);
    if (kind != MotionKind::peristalsis) continue;
    def.domain.shape = Shape::tube;
    expectClosedAndTrueToItsVelocity(def);
  }
}

TEST(Domain, SpeedProfileIntegratesItself) {
  const SpeedProfile p{{{0.1, 0.0}, {0.3, 2.0}, {0.4, -1.0}}};
  double sum = 0;
  const int n = 100000;
  for (int k = 0; k < n; ++k) sum += p.speed(0.6 * (k + 0.5) / n) * 0.6 / n;
  EXPECT_NEAR(p.travel(0.6), sum, 1e-9);
  EXPECT_EQ(SpeedProfile{}.travel(1), 0);
}

TEST(Domain, FluidHasItsVolumeAndLiesInside) {
  for (Shape shape : {Shape::box, Shape::cylinder, Shape::tube}) {
    const CaseDef def = room(shape);
    const auto domain = Domain::build(def, 1e-3);
    const auto start = fillDomain(def, *domain, 1e-3);
    ASSERT_TRUE(start) << start.error().text();
    const double whole =
        static_cast<double>(start->positions.size()) * std::pow(start->spacing_m, 3);
    EXPECT_NEAR(whole, domain->volume_m3(), 1e-9 * whole);
    EXPECT_NEAR(start->spacing_m, 1e-3, 1e-5);
  }
}

TEST(Domain, LevelOfATiltedBoxHoldsTheVolume) {
  CaseDef def = room(Shape::box);
  def.domain.size_m = {0.02, 0.02, 0.04};
  const Vec3 up(std::sin(0.4), 0, std::cos(0.4));
  const auto domain = Domain::build(def, 1e-3);
  // while the surface meets both side walls, the centre of the box's surface stays where it is
  const double height = 0.02, wanted = height * up.z() + 0.01 * up.x();
  EXPECT_NEAR(domain->level_m(0.02 * 0.02 * height, up), wanted, 2e-5);
  EXPECT_NEAR(domain->level_m(0.02 * 0.02 * height, Vec3::UnitZ()), height, 3e-5);
}
