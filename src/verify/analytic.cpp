// SPDX-License-Identifier: MIT
#include "verify/analytic.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/vec.h"

namespace swallowclip::verify {
namespace {
constexpr int kTerms = 400;      // of a series; its terms fall with n^-1 at worst, exp(-n2 t) soon
constexpr double kTiny = 1e-14;  // where the exponential has ended the series

/// Zeros of J0 (McMahon's expansion, Newton steps with J0' = -J1).
const std::array<double, kTerms>& besselZeros() {
  static const std::array<double, kTerms> zeros = [] {
    std::array<double, kTerms> z{};
    for (int n = 0; n < kTerms; ++n) {
      const double b = (n + 0.75) * kPi;
      double x = b + 1 / (8 * b);
      for (int k = 0; k < 8; ++k) x += std::cyl_bessel_j(0, x) / std::cyl_bessel_j(1, x);
      z[n] = x;
    }
    return z;
  }();
  return zeros;
}

/// Bisection of a rising function.
template <class F>
double solveRising(F f, double low, double high) {
  for (int k = 0; k < 200; ++k) {
    const double middle = (low + high) / 2;
    (f(middle) < 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

double couetteStart_ms(double y, double t, double L, double wall, double nu) {
  double u = wall * y / L;
  for (int n = 1; n <= kTerms; ++n) {
    const double decay = std::exp(-nu * n * n * kPi * kPi / (L * L) * t);
    if (decay < kTiny) break;
    u += 2 * wall / (n * kPi) * (n % 2 ? -1 : 1) * std::sin(n * kPi * y / L) * decay;
  }
  return u;
}

double planePoiseuilleStart_ms(double y, double t, double L, double force, double nu) {
  double u = force / (2 * nu) * y * (L - y);
  for (int k = 0; k < kTerms; ++k) {
    const int n = 2 * k + 1;
    const double decay = std::exp(-nu * n * n * kPi * kPi / (L * L) * t);
    if (decay < kTiny) break;
    u -= 4 * force * L * L / (nu * std::pow(kPi * n, 3)) * std::sin(kPi * n * y / L) * decay;
  }
  return u;
}

double pipePoiseuilleStart_ms(double r, double t, double R, double force, double nu) {
  double u = force / (4 * nu) * (R * R - r * r);
  for (double b : besselZeros()) {
    const double decay = std::exp(-nu * b * b / (R * R) * t);
    if (decay < kTiny) break;
    u -= 2 * force * R * R / (nu * b * b * b * std::cyl_bessel_j(1, b)) *
         std::cyl_bessel_j(0, b * std::min(1.0, r / R)) * decay;
  }
  return u;
}

double shearRateAt_s(const bolus::Fluid& f, double stress) {
  using bolus::RheologyModel;
  switch (f.model) {
    case RheologyModel::newtonian:
      return stress / f.viscosity_Pas;
    case RheologyModel::powerLaw:
      return std::pow(stress / f.consistency_Pasn, 1 / f.index);
    case RheologyModel::herschelBulkley:
      return stress <= f.yield_Pa
                 ? 0
                 : std::pow((stress - f.yield_Pa) / f.consistency_Pasn, 1 / f.index);
    case RheologyModel::carreau:
      break;
  }
  const auto excess = [&](double rate) {
    const double x = f.lambda_s * rate;
    return rate * (f.etaInf_Pas +
                   (f.eta0_Pas - f.etaInf_Pas) * std::pow(1 + x * x, (f.index - 1) / 2)) -
           stress;
  };
  double high = 1;
  while (excess(high) < 0 && high < 1e12) high *= 2;
  return solveRising(excess, 0, high);
}

double steadyFlow_ms(const bolus::Fluid& f, double distance, double H, double wallStress) {
  using bolus::RheologyModel;
  const double x = std::clamp(distance, 0.0, H);
  if (f.model != RheologyModel::carreau) {
    const bool newtonian = f.model == RheologyModel::newtonian;
    const double K = newtonian ? f.viscosity_Pas : f.consistency_Pasn;
    const double m = newtonian ? 1 : 1 / f.index;
    const double yield = f.model == RheologyModel::herschelBulkley ? f.yield_Pa : 0;
    if (wallStress <= yield) return 0;
    const double plug = yield / wallStress * H, slope = wallStress / H;  // Pa/m
    return std::pow(slope / K, m) / (m + 1) *
           (std::pow(H - plug, m + 1) - std::pow(std::max(0.0, x - plug), m + 1));
  }
  constexpr int kSteps = 2000;  // midpoint rule from the wall in
  double u = 0;
  for (int k = 0; k < kSteps; ++k) {
    const double at = x + (H - x) * (k + 0.5) / kSteps;
    u += shearRateAt_s(f, wallStress * at / H) * (H - x) / kSteps;
  }
  return u;
}

double shapiroPlane(double p) {
  return 3 * p * p / (2 + p * p);
}
double shapiroTube(double p) {
  return p * p * (16 - p * p) / (2 * (2 + 3 * p * p));
}

double huppertPlane_m(double area, double t, double g, double nu) {
  return 1.411 * std::pow(g * area * area * area * t / (3 * nu), 0.2);
}
double huppertRound_m(double volume, double t, double g, double nu) {
  return 0.894 * std::pow(g * volume * volume * volume * t / (3 * nu), 0.125);
}

SqueezedEdge squeezedEdge_m(double start, double mean, double gap) {
  const double bulge = std::clamp((mean - start) / gap, 0.0, kPi / 8);  // its area, in squared gaps
  const double contact = mean - bulge * gap;
  return {contact, contact + gap * (-0.05 + 0.4 * bulge + 0.2 * gap / mean)};
}

// Of a unit sphere, u its height over the centre, the cap is u > cos(angle): discs of pi (1 - u^2).
double capSlenderness(double angle) {
  const double c = std::cos(angle);
  const auto volume = [](double u) { return u - u * u * u / 3; };
  const auto height = [&](double u) { return u * u / 2 - std::pow(u, 4) / 4 - c * volume(u); };
  const auto square = [](double u) {  // half the squared radius of each disc
    return (u - 2 * u * u * u / 3 + std::pow(u, 5) / 5) / 2;
  };
  const double v = volume(1) - volume(c);
  const double mean = (height(1) - height(c)) / v, gyration2 = (square(1) - square(c)) / v;
  // at small angles, where differences lose their digits: a paraboloid's h / 3 and a / sqrt(3)
  return v > 1e-12 ? mean / std::sqrt(gyration2) : angle / std::sqrt(12.0);
}
}  // namespace swallowclip::verify
