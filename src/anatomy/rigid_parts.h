// SPDX-License-Identifier: MIT
// Half surfaces of bones, cartilages and teeth from their definitions. Metres, frame of core/vec.h.
#pragma once
#include <map>

#include "anatomy/anatomy_def.h"
#include "anatomy/half_surface.h"

namespace swallowclip::anatomy {

/// All sweeps of a part in one half surface: sections interpolated by Catmull-Rom between the
/// stations (mirrored beyond x = 0), rows at most edge_m apart, branches growing out of windows.
Result<HalfSurface> sweepPart(const PartDef& part,
                              const std::map<std::string, std::vector<Vec2>>& profiles);

/// Where a tooth stands: arc length along the lingual plan, direction of the arch, centre of its
/// neck.
struct ToothPlace {
  double s_m = 0;
  Vec3 mesiodistal, cervix;
};
/// Of the left teeth, midline first; neighbours touch at their widest.
Result<std::vector<ToothPlace>> toothPlaces(const DentalArchDef& arch);

/// Crowns of one side of an arch, each a closed solid with a root stub.
Result<HalfSurface> dentalArch(const DentalArchDef& arch);

/// Left half of maxilla and hard palate: sections fanning out from the midline over the arch.
Result<HalfSurface> maxilla(const PalateDef& palate);

/// z of the oral mucosa of the hard palate over (|x|, y): mid - drop (|x|/w)^exponent.
double palateMucosaZ_m(const PalateDef& palate, double x_m, double y_m);
}  // namespace swallowclip::anatomy
