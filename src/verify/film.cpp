// SPDX-License-Identifier: MIT
#include "verify/film.h"

#include <algorithm>
#include <cmath>

namespace swallowclip::verify {
namespace {
double capillaryNumber(const CaseDef& def, double speed_ms) {
  return def.fluid.viscosity_Pas * speed_ms / def.fluid.coatingTension_Nm;
}

/// A block on the floor of a box whose wall across x is moved: volume / room = level.
double levelSpeed_ms(const CaseDef& def, double z_m) {
  const FillDef& fill = def.fill.front();
  const double start_m = def.domain.size_m.x();
  const double width_m = start_m * fill.size_m.z() / z_m;
  if (!(z_m > 0 && width_m >= start_m)) return NAN;
  // When was it that wide? Speeds are negative where the wall recedes, so travel falls with time.
  double early = 0, late = def.duration_s;
  if (-def.motion.speed.travel(late) < width_m - start_m) return NAN;
  for (int k = 0; k < 60; ++k) {
    const double middle = (early + late) / 2;
    (-def.motion.speed.travel(middle) < width_m - start_m ? early : late) = middle;
  }
  return -def.motion.speed.speed(late) * z_m / width_m;
}

double plugSpeed_ms(const CaseDef& def, double z_m) {
  const FillDef& fill = def.fill.front();
  const double fallen_m = fill.low_m.z() + fill.size_m.z() - z_m;
  if (!(fallen_m >= 0)) return NAN;
  return std::sqrt(fill.velocity_ms.squaredNorm() + 2 * def.gravity_ms2.norm() * fallen_m);
}
}  // namespace

double contactLineSpeed_ms(const CaseDef& def, double z_m) {
  return def.motion.kind == MotionKind::piston ? levelSpeed_ms(def, z_m) : plugSpeed_ms(def, z_m);
}

double filmOfLevel_m(const CaseDef& def, double z_m) {
  const double capillary_m =
      std::sqrt(def.fluid.coatingTension_Nm / (def.fluid.density_kgm3 * def.gravity_ms2.norm()));
  return 0.944 * capillary_m * std::pow(capillaryNumber(def, levelSpeed_ms(def, z_m)), 2.0 / 3);
}

double filmOfPlug_m(const CaseDef& def, double z_m) {
  const double x = std::pow(capillaryNumber(def, plugSpeed_ms(def, z_m)), 2.0 / 3);
  return def.domain.radius_m * 1.34 * x / (1 + 2.5 * 1.34 * x);
}

double filmExponent(const CaseDef& def, const std::vector<Patch>& patches) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const Patch& p : patches) {
    const double speed_ms = contactLineSpeed_ms(def, p.centre.z());
    if (!(speed_ms > 0 && p.film_m > 0)) continue;
    const double x = std::log(speed_ms), y = std::log(p.film_m);
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return n < 2 ? 0 : (n * sxy - sx * sy) / (n * sxx - sx * sx);
}
}  // namespace swallowclip::verify
