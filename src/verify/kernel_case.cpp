// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "verify/run_case.h"

namespace swallowclip::verify {
namespace {
using bolus::Kernel;
using bolus::KernelKind;

/// Integral over the ball by the midpoint rule in r, of a function of (r, w, slope).
template <class F>
double overBall(const Kernel& kernel, F f) {
  constexpr int kSteps = 200'000;  // error of the midpoint rule far below 1e-8
  const double H = kernel.support_m();
  double sum = 0;
  for (int k = 0; k < kSteps; ++k) {
    const double r = H * (k + 0.5) / kSteps;
    sum += 4 * kPi * r * r * f(r) * H / kSteps;
  }
  return sum;
}

CheckResult check(const std::string& title, double measured, double reference, double tolerance) {
  CheckResult c{.title = title, .unit = std::string(1, '-')};
  c.measured = measured;
  c.reference = reference;
  c.error = std::abs(measured - reference) / std::max(std::abs(reference), 1e-300);
  c.tolerance = tolerance;
  c.pass = c.error <= tolerance;
  return c;
}
}  // namespace

CaseResult runKernelCase(const CaseDef& def) {
  CaseResult result;
  result.name = def.name;
  result.description = def.description;
  result.source = def.source;
  for (KernelKind kind : {KernelKind::lucy, KernelKind::gaussian, KernelKind::cubicSpline,
                          KernelKind::quarticSpline, KernelKind::wendlandC2}) {
    const Kernel kernel(kind, 2.3e-3);  // any support: the integrals do not depend on it
    const double H = kernel.support_m();
    const std::string name = bolus::name(kind);
    const double whole = overBall(kernel, [&](double r) { return kernel.w(r); });
    result.checks.push_back(
        check(fmt::format("{}: integral of W", name), whole, 1, def.kernelTolerance));
    // by parts: -1, plus what a kernel cut off before it reaches zero has on its rim
    const double moment = overBall(kernel, [&](double r) { return r * kernel.slope(r) / 3; });
    const double rim = 4 * kPi / 3 * H * H * H * kernel.w(H * (1 - 1e-12));
    result.checks.push_back(
        check(fmt::format("{}: integral of x dW/dx", name), moment, -1 + rim, def.kernelTolerance));
    CheckResult slope =
        check(fmt::format("{}: slope, differences of W", name), 0, 1, def.kernelTolerance);
    double steepest = 0, worst = -1;
    for (int k = 1; k < 400; ++k)
      steepest = std::max(steepest, std::abs(kernel.slope(H * k / 400)));
    for (int k = 1; k < 400; ++k) {
      const double r = H * (k + 0.37) / 400.5, step = 1e-5 * H;
      const double wanted = (kernel.w(r + step) - kernel.w(r - step)) / (2 * step);
      const double error = std::abs(kernel.slope(r) - wanted) / steepest;
      if (error <= worst) continue;
      worst = error;
      slope.measured = kernel.slope(r) / steepest;
      slope.reference = wanted / steepest;
    }
    slope.error = worst;
    slope.pass = worst <= def.kernelTolerance;
    Curve curve;
    for (int k = 0; k <= 100; ++k) {
      const double r = H * k / 100, w0 = kernel.w(0);
      curve.points.push_back({k / 100.0, kernel.w(r) / w0, kernel.w(r) / w0});
    }
    slope.xLabel = std::string("r / H");
    slope.curves.push_back(curve);
    result.checks.push_back(slope);
  }
  result.pass = std::ranges::all_of(result.checks, [](const CheckResult& c) { return c.pass; });
  return result;
}
}  // namespace swallowclip::verify
