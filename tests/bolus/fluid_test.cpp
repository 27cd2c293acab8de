// SPDX-License-Identifier: MIT
#include "bolus/fluid.h"

#include <gtest/gtest.h>

namespace swallowclip::bolus {
namespace {
TEST(Fluid, NewtonianIgnoresShear) {
  Fluid f;
  f.viscosity_Pas = 0.004;
  EXPECT_EQ(apparentViscosity_Pas(f, 0), 0.004);
  EXPECT_EQ(apparentViscosity_Pas(f, 1e4), 0.004);
  EXPECT_EQ(leastViscosity_Pas(f), 0.004);
}
TEST(Fluid, PowerLawMeetsItsViscosityAtFifty) {
  // L2 xanthan, clinical-reference 4: 0.126 Pa.s at 50 1/s, n = 0.30, K = 1.95
  Fluid f{.model = RheologyModel::powerLaw, .consistency_Pasn = 1.95, .index = 0.30};
  EXPECT_NEAR(apparentViscosity_Pas(f, 50), 0.126, 0.001);
  EXPECT_EQ(apparentViscosity_Pas(f, 0), 100);      // clipped at rest
  EXPECT_EQ(apparentViscosity_Pas(f, 1e6), 0.002);  // clipped when sheared
  EXPECT_EQ(leastViscosity_Pas(f), 0.002);
}
TEST(Fluid, HerschelBulkleyMeetsItsViscosityAtFifty) {
  // honey barium: 3.0 Pa.s at 50 1/s, yield 5 Pa, n = 0.30
  Fluid f{.model = RheologyModel::herschelBulkley, .index = 0.30, .yield_Pa = 5};
  f.consistency_Pasn = (50 * 3.0 - 5) / std::pow(50, 0.30);
  EXPECT_NEAR(apparentViscosity_Pas(f, 50), 3.0, 1e-9);
}
TEST(Fluid, CarreauHasTwoPlateaus) {
  Fluid f{.model = RheologyModel::carreau, .index = 0.3, .eta0_Pas = 2};
  EXPECT_NEAR(apparentViscosity_Pas(f, 1e-3), 2, 1e-3);
  EXPECT_NEAR(apparentViscosity_Pas(f, 1e9), 0.003, 1e-4);
}
TEST(Fluid, ValidateNamesTheField) {
  Fluid f;
  EXPECT_EQ(f.validate(), "");
  f.density_kgm3 = -1;
  EXPECT_NE(f.validate().find("density_kgm3"), std::string::npos);
}
}  // namespace
}  // namespace swallowclip::bolus
