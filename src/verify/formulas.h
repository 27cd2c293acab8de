// SPDX-License-Identifier: MIT
// The formulas behind references.h, and what each needs of a case.
#pragma once
#include <cmath>
#include <functional>
#include <vector>

#include "verify/analytic.h"
#include "verify/case.h"
#include "verify/domain.h"
#include "verify/fill.h"
#include "verify/references.h"

namespace swallowclip::verify {

/// What formulas ask of a case; kept alive by the closures made from it.
struct Setting {
  CaseDef def;
  Domain domain;
  Start start;  // at time 0
  Vec3 middle_m = Vec3::Zero();
  double level_m = 0;  // of the surface at rest

  const bolus::Fluid& fluid() const { return def.fluid; }
  double nu() const { return def.fluid.viscosity_Pas / def.fluid.density_kgm3; }
  double g() const { return def.gravity_ms2.norm(); }
  double volume() const { return start.volume_m3; }
  Vec3 up() const { return domain.fromWorld(-def.gravity_ms2.normalized()); }
  const Vec3& centre() const { return middle_m; }  // of the fluid at the start
  const Vec3& size() const { return def.domain.size_m; }
  /// Plates of a squeezed gap.
  double height0() const {
    return def.domain.shape == Shape::cylinder ? def.domain.length_m : size().z();
  }
  double plateLow(double t) const {
    const double travel = def.motion.speed.travel(t);
    if (def.motion.kind == MotionKind::close) return travel / 2;
    return def.motion.high ? 0 : travel;
  }
  double gap(double t) const { return height0() - def.motion.speed.travel(t); }
  double stripHalf(double t) const { return volume() / size().y() / gap(t) / 2; }
  double discRadius(double t) const { return std::sqrt(volume() / (kPi * gap(t))); }
  SqueezedEdge stripEdge(double t) const {
    return squeezedEdge_m(stripHalf(0), stripHalf(t), gap(t));
  }
  SqueezedEdge discEdge(double t) const {
    return squeezedEdge_m(discRadius(0), discRadius(t), gap(t));
  }
  double stress() const {  // at the wall of a channel or tube driven along x
    const double force = def.fluid.density_kgm3 * std::abs(def.gravity_ms2.x());
    return def.domain.shape == Shape::tube ? force * def.domain.radius_m / 2
                                           : force * size().z() / 2;
  }
};
/// What a formula needs of the case; each is one sentence of the error message.
struct Need {
  bool (*met)(const CaseDef&);
  const char* text;
};
struct Formula {
  const char* name;
  bool profile;
  std::vector<Need> needs;
  std::function<double(const Setting&, const Probe&)> value;
};
const std::vector<Formula>& formulas();
}  // namespace swallowclip::verify
