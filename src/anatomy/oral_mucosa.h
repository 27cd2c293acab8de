// SPDX-License-Identifier: MIT
// Mucosa on the bones of the mouth: hard palate with raphe and rugae, gums around the teeth.
// Half surfaces in metres, frame of core/vec.h.
#pragma once
#include "anatomy/anatomy_def.h"
#include "anatomy/half_surface.h"

namespace swallowclip::anatomy {

/// How far the mucosa of the hard palate stands back from the smooth vault (palateMucosaZ_m) at
/// (x, y), m: crests of the rugae touch the vault, so that the tongue closes against them.
double palateRecess_m(const PalateDef& palate, double x_m, double y_m);

/// Left half of the palatal mucosa: the oral face, and a back inside the bone.
Result<HalfSurface> palateMucosa(const PalateDef& palate);

/// Left half of the gum of an arch: a band over the necks of its teeth, scalloped between them.
Result<HalfSurface> gum(const DentalArchDef& arch);
}  // namespace swallowclip::anatomy
