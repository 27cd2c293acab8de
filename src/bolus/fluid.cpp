// SPDX-License-Identifier: MIT
#include "bolus/fluid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/vec.h"

namespace swallowclip::bolus {
namespace {
constexpr std::array<const char*, 4> kNames{"newtonian", "power-law", "carreau",
                                            "herschel-bulkley"};
// Below this shear rate the laws are read at it: they diverge at rest. 1e-3 1/s, assumed
// (1e-4 to 1e-2); the clip decides there anyway.
constexpr double kLowestShearRate_s = 1e-3;
constexpr double kHighestShearRate_s = 1e9;  // beyond all that flows
// Water with soap has 0.025, saliva 0.04 to 0.06, water 0.072, mercury 0.49 N/m.
constexpr double kLeastTension_Nm = 1e-3, kMostTension_Nm = 0.5;
}  // namespace

const char* name(RheologyModel model) {
  return kNames[static_cast<int>(model)];
}

Result<RheologyModel> rheologyFromName(std::string_view word) {
  std::vector<std::string> known(kNames.begin(), kNames.end());
  for (int i = 0; i < static_cast<int>(kNames.size()); ++i)
    if (word == kNames[i]) return static_cast<RheologyModel>(i);
  const std::string near = nearestName(word, known);
  return usageError("rheology", fmt::format("no rheology is named '{}'", word),
                    near.empty() ? fmt::format("use one of {}", fmt::join(known, ", "))
                                 : fmt::format("did you mean '{}'?", near));
}

std::string Fluid::validate() const {
  auto bad = [](const char* field, double value, const char* wanted) {
    return fmt::format("{} is {}, expected {}", field, value, wanted);
  };
  if (!(density_kgm3 >= 500 && density_kgm3 <= 5000))
    return bad("density_kgm3", density_kgm3, "500 to 5000");
  if (!(minViscosity_Pas > 0 && minViscosity_Pas <= maxViscosity_Pas && maxViscosity_Pas <= 1e4))
    return bad("minViscosity_Pas", minViscosity_Pas, "0 < min <= max <= 10000");
  if (!(surfaceTension_Nm >= 0 && surfaceTension_Nm <= 1))
    return bad("surfaceTension_Nm", surfaceTension_Nm, "0 to 1");
  if (!(contactAngle_rad >= 0 && contactAngle_rad <= kPi))
    return bad("contactAngle_rad", contactAngle_rad, "0 to pi");
  if (coatingTension_Nm != 0 &&
      !(coatingTension_Nm >= kLeastTension_Nm && coatingTension_Nm <= kMostTension_Nm))
    return bad("coatingTension_Nm", coatingTension_Nm, "0 (no coating), or 0.001 to 0.5");
  if (model == RheologyModel::newtonian && !(viscosity_Pas > 0 && viscosity_Pas <= 1e4))
    return bad("viscosity_Pas", viscosity_Pas, "0 to 10000");
  if (model == RheologyModel::newtonian) return "";
  if (!(index > 0 && index <= 2)) return bad("index", index, "0 to 2");
  if (model == RheologyModel::carreau) {
    if (!(eta0_Pas > 0 && std::isfinite(eta0_Pas))) return bad("eta0_Pas", eta0_Pas, "above 0");
    if (!(etaInf_Pas >= 0 && etaInf_Pas <= eta0_Pas))
      return bad("etaInf_Pas", etaInf_Pas, "0 to eta0_Pas");
    if (!(lambda_s > 0 && std::isfinite(lambda_s))) return bad("lambda_s", lambda_s, "above 0");
    return "";
  }
  if (!(consistency_Pasn > 0 && std::isfinite(consistency_Pasn)))
    return bad("consistency_Pasn", consistency_Pasn, "above 0");
  if (!(yield_Pa >= 0 && std::isfinite(yield_Pa))) return bad("yield_Pa", yield_Pa, "0 or more");
  return "";
}

double apparentViscosity_Pas(const Fluid& f, double shearRate_s) {
  const double rate = std::max(shearRate_s, kLowestShearRate_s);
  double eta = f.viscosity_Pas;
  switch (f.model) {
    case RheologyModel::newtonian:
      return eta;
    case RheologyModel::powerLaw:
      eta = f.consistency_Pasn * std::pow(rate, f.index - 1);
      break;
    case RheologyModel::carreau:
      eta =
          f.etaInf_Pas + (f.eta0_Pas - f.etaInf_Pas) *
                             std::pow(1 + f.lambda_s * rate * f.lambda_s * rate, (f.index - 1) / 2);
      break;
    case RheologyModel::herschelBulkley:
      eta = f.yield_Pa / rate + f.consistency_Pasn * std::pow(rate, f.index - 1);
      break;
  }
  return std::clamp(eta, f.minViscosity_Pas, f.maxViscosity_Pas);
}

double leastViscosity_Pas(const Fluid& f) {  // every law only falls, or only rises
  return std::min(apparentViscosity_Pas(f, 0), apparentViscosity_Pas(f, kHighestShearRate_s));
}
}  // namespace swallowclip::bolus
