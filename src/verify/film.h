// SPDX-License-Identifier: MIT
// Films that a meniscus leaves behind, as theory has them: how fast a case moves the contact line,
// and how thick the film is then. Written apart from bolus/coating.cpp, which is tested with it.
// Only along z: a level that falls as a side wall of a box recedes, or a plug that falls in a
// cylinder.
#pragma once
#include "verify/case.h"

namespace swallowclip::verify {

/// The fluid on one wall triangle that it has left, in the frame of the walls.
struct Patch {
  Vec3 centre = Vec3::Zero();
  double area_m2 = 0, film_m = 0;
  double speed_ms = 0;  ///< of the contact line, as the solver found it
};

/// Speed of the contact line as it passes a height, by conservation of volume (level) or free fall
/// of the plug's upper end; not a number where it never passes.
double contactLineSpeed_ms(const CaseDef& def, double z_m);

/// Landau & Levich 1942 where gravity, Bretherton 1961 with Aussillous & Quere 2000 where the tube
/// sets the film: level and plug.
double filmOfLevel_m(const CaseDef& def, double z_m);
double filmOfPlug_m(const CaseDef& def, double z_m);

/// d log(film) / d log(speed) over patches, speeds as the case has them.
double filmExponent(const CaseDef& def, const std::vector<Patch>& patches);
}  // namespace swallowclip::verify
