// SPDX-License-Identifier: MIT
#include "biomech/material.h"

#include <cmath>

namespace swallowclip::biomech {

// Densities: cortical bone 1920, cartilage 1100 and skeletal muscle 1050 kg/m^3 (ICRU Report 46,
// 1992); enamel 2900 assumed (2800-3000); mucosa 1050 assumed (1020-1100).
// Elasticity: muscle and mucosa E = 3 G with G near 2.7 kPa (Cheng et al. 2011, J Biomech 44:450,
// magnetic resonance elastography of tongue and soft palate; published tongue values span
// 3-15 kPa), Poisson ratio 0.49 assumed (0.45-0.499, nearly incompressible). Elastic cartilage 5
// MPa assumed (1-12 MPa), ratio 0.45 assumed (0.3-0.49). Bone 13 GPa assumed (10-20), ratio 0.3
// assumed (0.2-0.35); enamel 80 GPa assumed (70-100), ratio 0.3 assumed (0.25-0.33): these two
// ride as rigid bodies and use their density only.
const std::vector<Material>& standardMaterials() {
  static const std::vector<Material> all = {
      {"bone", 1920, 13e9, 0.3},   {"enamel", 2900, 80e9, 0.3}, {"cartilage", 1100, 5e6, 0.45},
      {"muscle", 1050, 8e3, 0.49}, {"mucosa", 1050, 8e3, 0.49},
  };
  return all;
}

const Material* findMaterial(const std::vector<Material>& materials, const std::string& name) {
  for (const Material& m : materials)
    if (m.name == name) return &m;
  return nullptr;
}

Mat3 hookeStress(const Mat3& strain, const Material& m) {
  const double mu = m.young_Pa / (2 * (1 + m.poisson));
  const double lambda = m.young_Pa * m.poisson / ((1 + m.poisson) * (1 - 2 * m.poisson));
  return 2 * mu * strain + lambda * strain.trace() * Mat3::Identity();
}

namespace {
double deviatorNorm(const Mat3& a) {
  return (a - a.trace() / 3 * Mat3::Identity()).norm();
}
}  // namespace

double vonMises(const Mat3& stress) {
  return std::sqrt(1.5) * deviatorNorm(stress);
}
double equivalentStrain(const Mat3& strain) {
  return std::sqrt(2.0 / 3) * deviatorNorm(strain);
}
}  // namespace swallowclip::biomech
