// SPDX-License-Identifier: MIT
// What the bolus is made of. Apparent viscosity (Pa.s) as a function of the shear rate (1/s),
// always clipped, so that neither a core at rest nor a sheared wall layer runs away.
#pragma once
#include <string_view>

#include "core/error.h"

namespace swallowclip::bolus {

enum class RheologyModel { newtonian, powerLaw, carreau, herschelBulkley };

const char* name(RheologyModel model);
/// newtonian, power-law, carreau, herschel-bulkley.
Result<RheologyModel> rheologyFromName(std::string_view word);

struct Fluid {
  RheologyModel model = RheologyModel::newtonian;
  double density_kgm3 = 1000;   ///< thesis 4.3
  double viscosity_Pas = 1.0;   ///< Newtonian; thesis 4.3 (honey)
  double consistency_Pasn = 0;  ///< K of power law and Herschel-Bulkley
  double index = 1;             ///< n of power law, Herschel-Bulkley and Carreau
  double yield_Pa = 0;          ///< Herschel-Bulkley
  double eta0_Pas = 0, etaInf_Pas = 0.003, lambda_s = 10;   ///< Carreau (clinical-reference 4)
  double minViscosity_Pas = 0.002, maxViscosity_Pas = 100;  ///< clip (clinical-reference 4)
  double surfaceTension_Nm = 0;                             ///< 0: none, as in the thesis
  /// Between wall and surface, through the fluid. Assumed pi/2 (pi/6 to 2 pi/3): walls that neither
  /// draw the fluid on nor shed it. Of no effect without surface tension.
  double contactAngle_rad = 1.5707963267948966;

  /// Surface tension (N/m) that sets how thick a film it leaves on walls (bolus/coating.h); 0:
  /// none.
  double coatingTension_Nm = 0;

  /// "" when every number is usable, else what is wrong with which field.
  std::string validate() const;

  bool operator==(const Fluid&) const = default;
};

double apparentViscosity_Pas(const Fluid& fluid, double shearRate_s);
/// At whatever rate of shear.
double leastViscosity_Pas(const Fluid& fluid);
}  // namespace swallowclip::bolus
