// SPDX-License-Identifier: MIT
#include "render/xray.h"

namespace swallowclip::render {
namespace {
// mu/rho at 60 keV: NIST XCOM (Berger 2010) and Hubbell & Seltzer 1995, tables 3 and 4, for the
// compositions and densities of ICRU report 44 (tissues) and 46 (cartilage, whole teeth).
constexpr Substance kSubstances[] = {
    {"muscle", 0.02048, 1050},         // skeletal muscle
    {"mucosa", 0.02048, 1060},         // soft tissue
    {"soft-tissue", 0.02048, 1060},    //
    {"bone", 0.02381, 1180},           // spongiosa; the dense layer comes from corticalThickness_m
    {"cortical-bone", 0.03148, 1920},  //
    {"cartilage", 0.02083, 1100},      //
    {"enamel", 0.03492, 2750},         // whole tooth, for crowns are drawn as one body
    {"water", 0.02059, 1000},          //
    {"aluminium", 0.02778, 2699},      //
};
constexpr double kBariumSulfate_m2kg = 0.5116;  // XCOM, Ba 8.511, S 0.4053, O 0.1907 cm2/g
constexpr double kGrain_kgm3 = 4500;            // barite, CRC handbook
}  // namespace

Result<Substance> substance(const std::string& name) {
  std::vector<std::string> known;
  for (const Substance& s : kSubstances) {
    if (s.name == name) return s;
    known.emplace_back(s.name);
  }
  const std::string near = nearestName(name, known);
  return usageError("material '" + name + "'", "its X-ray attenuation is not known",
                    near.empty() ? fmt::format("Known: {}.", fmt::join(known, ", "))
                                 : "Did you mean '" + near + "'?");
}

double suspension_per_m(double barium_kgm3) {
  const double water = substance("water")->attenuation_per_m();
  return barium_kgm3 * kBariumSulfate_m2kg + (1 - barium_kgm3 / kGrain_kgm3) * water;
}

double corticalThickness_m(const std::string& structure, const std::string& material) {
  if (material != "bone") return 0;
  // mandible 2..3 mm (CT of dentate adults), hard palate about 1 mm, vertebrae 0.3 (body) to 1.5 mm
  // (arch), hyoid about 0.8 mm: assumed within these ranges
  if (structure == "mandible") return 2.2e-3;
  if (structure == "maxilla") return 1.0e-3;
  if (structure == "hyoid") return 0.8e-3;
  return 0.8e-3;
}
}  // namespace swallowclip::render
