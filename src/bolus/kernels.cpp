// SPDX-License-Identifier: MIT
#include "bolus/kernels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/vec.h"

namespace swallowclip::bolus {
namespace {
struct Named {
  KernelKind kind;
  const char* name;
  double supportPerSpacing;  // assumed, 2-2.5: about 32-65 neighbours
  double supportPerH;        // support in the kernel's own smoothing lengths
};
constexpr std::array<Named, 5> kKernels{{
    {KernelKind::lucy, "lucy", 2.0, 1.0},                     // Lucy 1977
    {KernelKind::gaussian, "gaussian", 2.5, 3.0},             // Gingold & Monaghan 1977, cut at 3 h
    {KernelKind::cubicSpline, "cubic-spline", 2.0, 2.0},      // Monaghan & Lattanzio 1985
    {KernelKind::quarticSpline, "quartic-spline", 2.5, 2.5},  // Morris 1996
    {KernelKind::wendlandC2, "wendland-c2", 2.0, 2.0},        // Wendland 1995
}};
const Named& entry(KernelKind kind) {
  return *std::find_if(kKernels.begin(), kKernels.end(),
                       [&](const Named& k) { return k.kind == kind; });
}
// Integral of exp(-q^2) over the ball q < 3, so that the cut Gaussian still sums to one.
double cutGaussianIntegral() {
  return 4 * kPi * (std::sqrt(kPi) / 4 * std::erf(3.0) - 1.5 * std::exp(-9.0));
}
double unitScale(KernelKind kind) {
  switch (kind) {
    case KernelKind::lucy:
      return 105 / (16 * kPi);
    case KernelKind::gaussian:
      return 1 / cutGaussianIntegral();
    case KernelKind::cubicSpline:
      return 1 / kPi;
    case KernelKind::quarticSpline:
      return 1 / (20 * kPi);
    case KernelKind::wendlandC2:
      return 21 / (16 * kPi);
  }
  return 0;
}
double pow3(double x) {
  return x * x * x;
}
double positive(double x) {
  return x > 0 ? x : 0;
}

double shape(KernelKind kind, double q) {
  switch (kind) {
    case KernelKind::lucy:
      return (1 + 3 * q) * pow3(1 - q);
    case KernelKind::gaussian:
      return std::exp(-q * q);
    case KernelKind::cubicSpline:
      return q < 1 ? 1 - 1.5 * q * q + 0.75 * pow3(q) : 0.25 * pow3(2 - q);
    case KernelKind::quarticSpline:
      return pow3(2.5 - q) * (2.5 - q) - 5 * pow3(positive(1.5 - q)) * positive(1.5 - q) +
             10 * pow3(positive(0.5 - q)) * positive(0.5 - q);
    case KernelKind::wendlandC2:
      return pow3(1 - q / 2) * (1 - q / 2) * (1 + 2 * q);
  }
  return 0;
}
double shapeSlope(KernelKind kind, double q) {
  switch (kind) {
    case KernelKind::lucy:
      return -12 * q * (1 - q) * (1 - q);
    case KernelKind::gaussian:
      return -2 * q * std::exp(-q * q);
    case KernelKind::cubicSpline:
      return q < 1 ? -3 * q + 2.25 * q * q : -0.75 * (2 - q) * (2 - q);
    case KernelKind::quarticSpline:
      return -4 * pow3(2.5 - q) + 20 * pow3(positive(1.5 - q)) - 40 * pow3(positive(0.5 - q));
    case KernelKind::wendlandC2:
      return -5 * q * pow3(1 - q / 2);
  }
  return 0;
}
}  // namespace

const char* name(KernelKind kind) {
  return entry(kind).name;
}

Result<KernelKind> kernelFromName(std::string_view word) {
  std::vector<std::string> known;
  for (const Named& k : kKernels) {
    if (word == k.name) return k.kind;
    known.push_back(k.name);
  }
  const std::string near = nearestName(std::string(word), known);
  return usageError("kernel", fmt::format("no kernel is named '{}'", word),
                    near.empty() ? fmt::format("use one of {}", fmt::join(known, ", "))
                                 : fmt::format("did you mean '{}'?", near));
}

double supportPerSpacing(KernelKind kind) {
  return entry(kind).supportPerSpacing;
}

Kernel::Kernel(KernelKind kind, double support_m)
    : kind_(kind),
      support_m_(support_m),
      h_m_(support_m / entry(kind).supportPerH),
      scale_(unitScale(kind) / pow3(h_m_)) {}

double Kernel::w(double r_m) const {
  return r_m < support_m_ ? scale_ * shape(kind_, r_m / h_m_) : 0;
}

double Kernel::slope(double r_m) const {
  return r_m < support_m_ ? scale_ / h_m_ * shapeSlope(kind_, r_m / h_m_) : 0;
}

double Kernel::latticeSum(double spacing_m) const {
  const int n = static_cast<int>(std::ceil(support_m_ / spacing_m));
  double sum = 0;
  for (int x = -n; x <= n; ++x)
    for (int y = -n; y <= n; ++y)
      for (int z = -n; z <= n; ++z)
        sum += w(spacing_m * std::sqrt(static_cast<double>(x * x + y * y + z * z)));
  return sum * pow3(spacing_m);
}

KernelTable::KernelTable(const Kernel& kernel)
    : support_m_(kernel.support_m()),
      selfW_(kernel.w(0)),
      cubicSpline_(kernel.kind() == KernelKind::cubicSpline),
      pairs_(kIntervals + 1),
      walls_(kIntervals + 1) {
  const double step = support_m_ / kIntervals;
  auto integrand = [&](double r) { return kernel.w(r) * r * r; };
  std::vector<double> upTo(kIntervals + 1, 0.0);  // int_0^r W s^2 ds by Simpson's rule
  for (int i = 0; i < kIntervals; ++i) {
    const double a = i * step;
    // just inside the support at the last node: the cut Gaussian jumps to zero there
    const double b = std::min(a + step, support_m_ * (1 - 1e-15));
    upTo[i + 1] = upTo[i] + step / 6 * (integrand(a) + 4 * integrand(a + step / 2) + integrand(b));
  }
  const double exact = 1 / (4 * kPi) / upTo[kIntervals];
  const auto inside = [&](int i) { return std::min(i * step, support_m_ * (1 - 1e-15)); };
  const auto w = [&](int i) { return kernel.w(inside(i)); };
  // slope / r has a limit at 0, reached within a node
  const auto slope = [&](int i) {
    const double r = std::max(inside(i), 1e-3 * step);
    return kernel.slope(r) / r;
  };
  const auto f = [&](int i) {
    return i == 0 ? kernel.w(0) / 3 : upTo[i] * exact / std::pow(i * step, 3);
  };
  for (int i = 0; i < kIntervals; ++i) {
    const auto to = [](double x) { return static_cast<float>(x); };
    pairs_[i] = {to(w(i)), to(w(i + 1) - w(i)), to(slope(i)), to(slope(i + 1) - slope(i))};
    walls_[i] = {to(w(i)), to(w(i + 1) - w(i)), to(f(i)), to(f(i + 1) - f(i))};
  }
}
}  // namespace swallowclip::bolus
