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
  const double h = k.support_m();
  for (double r = 1e-5; r < 0.9999 * h; r += 1.3e-5) {
    const double at = r * table.nodesPerMetre();
    const int node = static_cast<int>(at);
    const double part = at - node;
    const KernelTable::Pair& p = table.pairs()[node];
    const KernelTable::Wall& w = table.walls()[node];
    EXPECT_NEAR(p.w + part * p.wStep, k.w(r), 4e-6 * k.w(0));
    EXPECT_NEAR(w.w + part * w.wStep, k.w(r), 4e-6 * k.w(0));
    EXPECT_NEAR((p.slope + part * p.slopeStep) * r, k.slope(r), 1e-5 * k.w(0) / h);
  }
  // F meets 1 / (4 pi r^2) at the support
  const KernelTable::Wall& last = table.walls()[KernelTable::kIntervals - 1];
  EXPECT_NEAR((last.f + last.fStep) * h * h * h * 4 * kPi, 1, 1e-4);
  const KernelTable::Pair& end = table.pairs()[KernelTable::kIntervals];
  EXPECT_EQ(end.w + end.slope + end.wStep + end.slopeStep, 0);
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
