// SPDX-License-Identifier: MIT
// Every formula against a property that does not come from the formula: its differential equation,
// its limits, or a quadrature.
#include "verify/analytic.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/vec.h"
#include "verify/quantities.h"

using namespace swallowclip;
using namespace swallowclip::verify;

namespace {
constexpr double kL = 0.016, kNu = 1e-3, kForce = 1.5, kWall = 0.05;

bolus::Fluid herschelBulkley() {
  bolus::Fluid f;
  f.model = bolus::RheologyModel::herschelBulkley;
  f.yield_Pa = 3;
  f.consistency_Pasn = 1.7;
  f.index = 0.4;
  return f;
}

/// d2u/dy2 and du/dt by central differences.
template <class U>
void expectDiffusion(U u, double y, double t, double force, bool round) {
  const double dy = 2e-5, dt = 1e-5;
  double bend = (u(y + dy, t) - 2 * u(y, t) + u(y - dy, t)) / (dy * dy);
  if (round) bend += (u(y + dy, t) - u(y - dy, t)) / (2 * dy) / y;
  const double rate = (u(y, t + dt) - u(y, t - dt)) / (2 * dt);
  EXPECT_NEAR(rate, kNu * bend + force, 2e-3 * (std::abs(kNu * bend) + std::abs(force) + 1e-3));
}
}  // namespace

TEST(Analytic, CouetteStartsAtRestEndsStraightAndDiffuses) {
  EXPECT_NEAR(couetteStart_ms(kL / 2, 1e-4, kL, kWall, kNu), 0, 1e-9);
  for (double y : {0.0, 0.3 * kL, kL})
    EXPECT_NEAR(couetteStart_ms(y, 10, kL, kWall, kNu), kWall * y / kL, 1e-15);
  EXPECT_NEAR(couetteStart_ms(kL, 0.01, kL, kWall, kNu), kWall, 1e-12);
  for (double t : {0.01, 0.05})
    expectDiffusion([](double y, double s) { return couetteStart_ms(y, s, kL, kWall, kNu); },
                    0.7 * kL, t, 0, false);
}

TEST(Analytic, PlanePoiseuilleStartsWithItsForceAndDiffuses) {
  EXPECT_NEAR(planePoiseuilleStart_ms(kL / 2, 1e-3, kL, kForce, kNu), kForce * 1e-3, 1e-9);
  EXPECT_NEAR(planePoiseuilleStart_ms(kL / 2, 10, kL, kForce, kNu), kForce * kL * kL / (8 * kNu),
              1e-15);
  EXPECT_NEAR(planePoiseuilleStart_ms(0, 0.02, kL, kForce, kNu), 0, 1e-15);
  expectDiffusion([](double y, double s) { return planePoiseuilleStart_ms(y, s, kL, kForce, kNu); },
                  0.2 * kL, 0.03, kForce, false);
}

TEST(Analytic, PipePoiseuilleStartsWithItsForceAndDiffuses) {
  const double R = kL / 2;
  EXPECT_NEAR(pipePoiseuilleStart_ms(0, 1e-3, R, kForce, kNu), kForce * 1e-3, 1e-8);
  EXPECT_NEAR(pipePoiseuilleStart_ms(0, 10, R, kForce, kNu), kForce * R * R / (4 * kNu), 1e-15);
  EXPECT_NEAR(pipePoiseuilleStart_ms(R, 0.02, R, kForce, kNu), 0, 1e-9);
  expectDiffusion([&](double y, double s) { return pipePoiseuilleStart_ms(y, s, R, kForce, kNu); },
                  0.4 * R, 0.01, kForce, true);
}

TEST(Analytic, SteadyFlowBearsItsStressEverywhere) {
  bolus::Fluid newtonian, carreau;
  newtonian.viscosity_Pas = 0.7;
  carreau.model = bolus::RheologyModel::carreau;
  carreau.eta0_Pas = 12;
  carreau.index = 0.4;
  const double H = 0.008, wall = 20;
  for (const bolus::Fluid& f : {newtonian, herschelBulkley(), carreau})
    for (double share : {0.05, 0.3, 0.6, 0.9}) {
      const double d = 1e-3 * H, y = share * H;
      const double rate =
          (steadyFlow_ms(f, y - d, H, wall) - steadyFlow_ms(f, y + d, H, wall)) / (2 * d);
      const double stress = wall * share;
      EXPECT_NEAR(rate, shearRateAt_s(f, stress), 2e-3 * shearRateAt_s(f, wall));
      if (f.model == bolus::RheologyModel::herschelBulkley && stress <= f.yield_Pa) {
        EXPECT_EQ(rate, 0);
        continue;
      }
      EXPECT_NEAR(bolus::apparentViscosity_Pas(f, rate) * rate, stress, 0.01 * stress);
    }
  EXPECT_EQ(steadyFlow_ms(herschelBulkley(), 0, H, 2.9), 0) << "below its yield nothing moves";
  EXPECT_NEAR(steadyFlow_ms(newtonian, 0, H, wall), wall * H / (2 * 0.7), 1e-12);
}

// Lubrication theory integrated numerically: the wave-frame flow q at which the pressure rise of
// one wave vanishes, and from it the time-mean flow in the frame of the walls.
TEST(Analytic, PeristalticFlowMatchesQuadrature) {
  for (double phi : {0.1, 0.4, 0.6, 0.9}) {
    double h2 = 0, h3 = 0, h4 = 0, area = 0;
    const int n = 20000;
    for (int k = 0; k < n; ++k) {
      const double h = 1 + phi * std::sin(2 * kPi * (k + 0.5) / n);
      h2 += 1 / (h * h) / n;
      h3 += 1 / (h * h * h) / n;
      h4 += 1 / (h * h * h * h) / n;
      area += h * h / n;
    }
    EXPECT_NEAR(shapiroPlane(phi), 1 - h2 / h3, 1e-9);
    EXPECT_NEAR(shapiroTube(phi), area - h2 / h4, 1e-9);
  }
  EXPECT_EQ(shapiroPlane(0), 0);
  EXPECT_NEAR(shapiroPlane(1), 1, 1e-15) << "a wave that shuts carries all that is before it";
  EXPECT_NEAR(shapiroTube(1), 1.5, 1e-15);
}

TEST(Analytic, CapsAreAsSlenderAsTheirSlices) {
  for (const double angle : {0.3, 1.0, kPi / 2, 2.5, 3.1}) {
    double volume = 0, height = 0, square = 0;
    const int n = 20000;
    const double floor = std::cos(angle);
    for (int k = 0; k < n; ++k) {
      const double u = floor + (1 - floor) * (k + 0.5) / n, disc = 1 - u * u;
      volume += disc;
      height += disc * (u - floor);
      square += disc * disc / 2;
    }
    EXPECT_NEAR(capSlenderness(angle), height / volume / std::sqrt(square / volume), 1e-6);
  }
  EXPECT_NEAR(capSlenderness(kPi / 2), 3. / 8 / std::sqrt(2. / 5), 1e-12) << "half a ball";
  EXPECT_LT(capSlenderness(1e-6), capSlenderness(1e-2));
}

// On a lattice that fills a known cap, and a pressure that differs beyond the midst of a ball.
TEST(Quantities, AngleAndPressureOfDropsAreThoseOfTheirShape) {
  CaseDef def;
  for (const double angle : {kPi / 3, kPi / 2, 2.5}) {
    Snapshot s;
    s.def = &def;
    s.spacing_m = 2e-4;
    const double R = 5e-3, floor = R * std::cos(angle);
    for (double z = s.spacing_m / 2; z < R - floor; z += s.spacing_m)
      for (double y = -R; y < R; y += s.spacing_m)
        for (double x = -R; x < R; x += s.spacing_m)
          if (Vec3(x, y, z + floor).norm() < R) s.positions.emplace_back(x + 0.1, y - 0.2, z);
    EXPECT_NEAR(measureSeries({.kind = "contact-angle"}, s), angle, 0.01);
  }
  Snapshot s;
  s.def = &def;
  s.spacing_m = 1e-3;
  s.particleVolume_m3 = 1e-9;
  for (int k = -9; k < 9; ++k)
    for (int j = -9; j < 9; ++j)
      for (int i = -9; i < 9; ++i)
        if (const Vec3 p = 1e-3 * (Vec3(i, j, k) + Vec3::Constant(0.5)); p.norm() < 8e-3) {
          s.positions.push_back(p);
          s.pressure_Pa.push_back(p.norm() < 4.4e-3 ? 20 : 100);
        }
  s.densityRatio.assign(s.positions.size(), 1.0);
  EXPECT_EQ(measureSeries({.kind = "drop-pressure"}, s), 20) << "3.5 spacings deep: 4.5 mm";
}

TEST(Quantities, APlugsEdgeIsFoundBetweenBins) {
  constexpr double kSpacing_m = 1e-3;
  CaseDef def;
  def.domain.shape = Shape::box;
  def.domain.size_m = {4e-3, 4e-3, 16e-3};
  for (const double index : {1.0, 0.6})
    for (const double plug_m : {1.7e-3, 2.3e-3, 3.4e-3}) {
      def.fluid.index = index;
      Snapshot s;
      s.def = &def;
      s.spacing_m = kSpacing_m;
      for (int k = 0; k < 16; ++k) {
        const Vec3 at(2e-3, 2e-3, (k + 0.5) * kSpacing_m);
        const double power = 1 + 1 / index, half_m = 8e-3;
        const double sheared_m = std::max(0.0, std::abs(at.z() - half_m) - plug_m);
        const double lost = std::pow(sheared_m / (half_m - plug_m), power);
        s.positions.push_back(at);
        s.velocities.emplace_back(0.03 * (1 - lost), 0, 0);
      }
      EXPECT_NEAR(measureSeries({.kind = "plug-half-width"}, s), plug_m, 0.02 * plug_m)
          << index << " " << plug_m;
    }
}

// Between closing plates the equation of motion along them is, in z / h and with F = 3 z^2 - 2 z^3
// at rest, F''' = Re (F' + z F'' + c F'^2 - F F'') - K, c = 1 for strips and 1/2 for discs, and F
// and F' are given at both plates: what is not F''' of such a change has no part along z (1 - z).
TEST(Analytic, InertiaOfSqueezedFluidFollowsFromItsEquation) {
  const auto added = [](double c) {
    double sum = 0;
    const int n = 20000;
    for (int k = 0; k < n; ++k) {
      const double z = (k + 0.5) / n, f = 3 * z * z - 2 * z * z * z, f1 = 6 * z * (1 - z),
                   f2 = 6 - 12 * z;
      sum += (f1 + z * f2 + c * f1 * f1 - f * f2) * z * (1 - z) / n;
    }
    return 6 * sum / 12;  // of K = 12, that of Stokes' flow
  };
  EXPECT_NEAR(added(1), kStripInertia, 1e-6);
  EXPECT_NEAR(added(0.5), kDiscInertia, 1e-6);
}

// The profiles of Huppert's similarity solutions hold the volume that they started with.
TEST(Analytic, GravityCurrentHoldsItsVolume) {
  const double g = 9.81, nu = 1e-3, t = 2;
  const double area = 8e-5, x1 = huppertPlane_m(area, t, g, nu);
  // h^3 = (3 nu / 10 g t) (x1^2 - x^2) * 3 ... from h_t = (g / 3 nu) (h^3 h_x)_x
  double sum = 0;
  const int n = 20000;
  for (int k = 0; k < n; ++k) {
    const double x = x1 * (k + 0.5) / n;
    sum += std::cbrt(9 * nu / (10 * g * t) * (x1 * x1 - x * x)) * x1 / n;
  }
  EXPECT_NEAR(sum, area, 2e-3 * area);
  const double volume = 5e-6, r1 = huppertRound_m(volume, t, g, nu);
  sum = 0;
  for (int k = 0; k < n; ++k) {
    const double r = r1 * (k + 0.5) / n;
    sum += 2 * kPi * r * std::cbrt(9 * nu / (16 * g * t) * (r1 * r1 - r * r)) * r1 / n;
  }
  EXPECT_NEAR(sum, volume, 5e-3 * volume);
}
