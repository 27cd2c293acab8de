// SPDX-License-Identifier: MIT
// What X-rays meet: linear attenuation of tissues, of test substances and of barium suspensions at
// one effective energy. Physics, so it stands here and not in a preset.
//
// kEffectiveEnergy_keV: a swallow study runs at 70..90 kV (peak) and is hardened by filter and neck
// to an effective 50..65 keV (assumed). 60 keV is the nearest energy that NIST tabulates.
#pragma once
#include <string>

#include "core/error.h"

namespace swallowclip::render {

inline constexpr double kEffectiveEnergy_keV = 60;

/// Attenuation mu = massAttenuation * density, 1/m.
struct Substance {
  const char* name;
  double massAttenuation_m2kg;  ///< mu/rho at kEffectiveEnergy_keV; 0.1 m2/kg = 1 cm2/g
  double density_kgm3;

  double attenuation_per_m() const { return massAttenuation_m2kg * density_kgm3; }
};

/// By material name as in scenes (muscle, mucosa, bone, cartilage, enamel), or one of soft-tissue,
/// cortical-bone, water, aluminium. An unknown one is a usage error with the nearest name.
Result<Substance> substance(const std::string& name);

/// Barium sulfate in water: `barium_kgm3` of grains displace their volume of water, 1/m.
double suspension_per_m(double barium_kgm3);

/// Thickness of the dense outer layer of a bone, metres; 0 for everything but bone.
double corticalThickness_m(const std::string& structure, const std::string& material);
}  // namespace swallowclip::render
