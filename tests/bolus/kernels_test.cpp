// SPDX-License-Identifier: MIT
#include "bolus/kernels.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/vec.h"

namespace swallowclip::bolus {
namespace {
class EveryKernel : public ::testing::TestWithParam<KernelKind> {};

TEST_P(EveryKernel, IntegratesToOne) {
  const Kernel k(GetParam(), 4e-3);
  double sum = 0;
  const int n = 20000;
  const double dr = k.support_m() / n;
  for (int i = 0; i < n; ++i) {
    const double r = (i + 0.5) * dr;
    sum += 4 * kPi * r * r * k.w(r) * dr;
  }
  EXPECT_NEAR(sum, 1, 1e-6);
  EXPECT_EQ(k.w(k.support_m()), 0);
}

TEST_P(EveryKernel, SlopeIsTheDerivative) {
  const Kernel k(GetParam(), 4e-3);
  for (double r = 1e-4; r < 3.9e-3; r += 7.7e-5) {
    const double step = 1e-8;
    const double difference = (k.w(r + step) - k.w(r - step)) / (2 * step);
    EXPECT_NEAR(k.slope(r), difference, 1e-6 * k.w(0) / k.support_m()) << "r = " << r;
    EXPECT_LE(k.slope(r), 0);
  }
}

TEST_P(EveryKernel, TableAgrees) {
  const Kernel k(GetParam(), 4e-3);
  const KernelTable table(k);
  for (double r = 1e-5; r < 3.99e-3; r += 1.3e-5) EXPECT_NEAR(table.at(r).w, k.w(r), 2e-6 * k.w(0));
  // F meets 1 / (4 pi r^2) at the support
  const double h = k.support_m();
  EXPECT_NEAR(table.at(h * 0.999999).f, 1 / (4 * kPi * h * h), 1e-5 / (h * h));
  EXPECT_DOUBLE_EQ(table.at(2 * h).f, 1 / (16 * kPi * h * h));
}

TEST_P(EveryKernel, NameRoundTrip) {
  EXPECT_EQ(kernelFromName(name(GetParam())).value(), GetParam());
}

TEST_P(EveryKernel, LatticeIsNearlyRestDensity) {
  const double dx = 2e-3;
  EXPECT_NEAR(Kernel(GetParam(), supportPerSpacing(GetParam()) * dx).latticeSum(dx), 1, 0.05);
}

INSTANTIATE_TEST_SUITE_P(All, EveryKernel,
                         ::testing::Values(KernelKind::lucy, KernelKind::gaussian,
                                           KernelKind::cubicSpline, KernelKind::quarticSpline,
                                           KernelKind::wendlandC2));

TEST(Kernels, UnknownNameOffersTheNearest) {
  const auto got = kernelFromName("cubic-splin");
  ASSERT_FALSE(got);
  EXPECT_NE(got.error().remedy.find("cubic-spline"), std::string::npos);
}
TEST(Kernels, CubicSplineLatticeSumsToOne) {
  EXPECT_NEAR(Kernel(KernelKind::cubicSpline, 4e-3).latticeSum(2e-3), 1, 2e-4);
}
}  // namespace
}  // namespace swallowclip::bolus
