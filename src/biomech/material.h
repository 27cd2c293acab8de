// SPDX-License-Identifier: MIT
// Tissue constants: density for the rigid bodies, small-strain isotropic elasticity for the
// hollow FEM. SI units.
#pragma once
#include <string>
#include <vector>

#include "core/vec.h"

namespace swallowclip::biomech {

struct Material {
  std::string name;
  double density_kgm3 = 1050;
  double young_Pa = 8e3;
  double poisson = 0.49;
};

/// Bone, enamel, cartilage, muscle and mucosa; sources in material.cpp.
const std::vector<Material>& standardMaterials();

/// The named one, or nullptr.
const Material* findMaterial(const std::vector<Material>& materials, const std::string& name);

/// Hooke: stress = 2 mu E + lambda tr(E) I.
Mat3 hookeStress(const Mat3& strain, const Material& material);

/// sqrt(3/2 s:s) of the stress deviator s.
double vonMises(const Mat3& stress);

/// Same norm of the strain deviator times 2/3: the equivalent strain of an incompressible body.
double equivalentStrain(const Mat3& strain);
}  // namespace swallowclip::biomech
