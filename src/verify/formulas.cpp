// SPDX-License-Identifier: MIT
#include "verify/formulas.h"

#include <algorithm>
#include <cmath>

#include "verify/analytic.h"
#include "verify/film.h"

namespace swallowclip::verify {
namespace {
// Pressure is measured 3.5 spacings deep (quantities.cpp): less than 1.5 beyond leaves a handful of
// particles. Assumed (4.5 to 6).
constexpr double kLeastBall = 5;

using S = Setting;

constexpr Need kNewtonian{
    [](const CaseDef& d) { return d.fluid.model == bolus::RheologyModel::newtonian; },
    "a Newtonian fluid"};
constexpr Need kChannel{[](const CaseDef& d) {
                          return d.domain.shape == Shape::box && d.domain.periodic[0] &&
                                 d.domain.periodic[1] && !d.domain.periodic[2];
                        },
                        "a box periodic along x and y"};
constexpr Need kTube{[](const CaseDef& d) { return d.domain.shape == Shape::tube; }, "a tube"};
constexpr Need kForceX{[](const CaseDef& d) { return d.gravity_ms2.x() != 0; },
                       "gravity_ms2 along x, the driving force"};
constexpr Need kGravity{[](const CaseDef& d) { return d.gravity_ms2.norm() > 0; }, "gravity"};
constexpr Need kSlide{[](const CaseDef& d) { return d.motion.kind == MotionKind::slide; },
                      "a sliding wall"};
constexpr Need kPlates{[](const CaseDef& d) {
                         return d.motion.axis == 2 && (d.motion.kind == MotionKind::close ||
                                                       d.motion.kind == MotionKind::piston);
                       },
                       "plates that close along z"};
constexpr Need kThin{
    [](const CaseDef& d) { return d.domain.shape == Shape::box && d.domain.periodic[1]; },
    "a box periodic along y"};
constexpr Need kRound{[](const CaseDef& d) { return d.domain.shape == Shape::cylinder; },
                      "a cylinder"};
constexpr Need kWave{[](const CaseDef& d) { return d.motion.kind == MotionKind::peristalsis; },
                     "a peristaltic wave"};
constexpr Need kVortices{[](const CaseDef& d) { return d.start == StartKind::taylorGreen; },
                         "start \"taylor-green\""};
constexpr Need kRotates{[](const CaseDef& d) { return d.motion.kind == MotionKind::rotate; },
                        "walls that rotate"};
constexpr Need kSidePiston{[](const CaseDef& d) {
                             return d.motion.kind == MotionKind::piston && d.motion.axis < 2 &&
                                    d.domain.shape == Shape::box && d.gravity_ms2.z() < 0;
                           },
                           "a piston along x or y, and gravity along -z"};
constexpr Need kTension{[](const CaseDef& d) { return d.fluid.surfaceTension_Nm > 0; },
                        "surface_tension_Nm above 0"};
constexpr Need kBall{[](const CaseDef& d) {
                       return d.fill.size() == 1 && d.fill[0].kind == FillKind::sphere &&
                              d.fill[0].radius_m >= kLeastBall * d.spacing_m;
                     },
                     "one sphere of 5 spacings' radius at least"};
constexpr Need kWeightless{[](const CaseDef& d) { return d.gravity_ms2.norm() == 0; },
                           "gravity_ms2 [0, 0, 0]"};
constexpr Need kFloor{[](const CaseDef& d) {
                        return d.domain.shape == Shape::cylinder ||
                               (d.domain.shape == Shape::box && !d.domain.periodic[2]);
                      },
                      "a floor at z = 0"};
constexpr Need kYield{[](const CaseDef& d) { return d.fluid.yield_Pa > 0; }, "yield_Pa above 0"};
constexpr Need kCoats{[](const CaseDef& d) {
                        return d.fluid.coatingTension_Nm > 0 &&
                               d.fluid.model == bolus::RheologyModel::newtonian;
                      },
                      "a Newtonian fluid with \"coating\""};
constexpr Need kRecedes{[](const CaseDef& d) {
                          return d.motion.kind == MotionKind::piston && d.motion.axis == 0 &&
                                 d.fill[0].kind == FillKind::block && d.gravity_ms2.z() < 0;
                        },
                        "a block of fluid, a piston along x and gravity along -z"};
constexpr Need kPlug{[](const CaseDef& d) {
                       return d.domain.shape == Shape::cylinder &&
                              d.fill[0].kind == FillKind::cylinder;
                     },
                     "a cylinder of fluid in a cylinder"};

double squeezeParabola(double share) {  // mean 1 across the gap
  return 6 * share * (1 - share);
}
double squeezeInertia(const S& s, double t, double share) {
  return 1 + share * s.def.motion.speed.speed(t) * s.gap(t) / s.nu();
}
double signOf(double x) {
  return x < 0 ? -1 : 1;
}
double pistonHeight(const S& s, double t) {
  Vec3 size = s.size();
  size[s.def.motion.axis] -= s.def.motion.speed.travel(t);
  return s.volume() / (size.x() * size.y());
}
/// Weight, and what rises against its viscosity as the piston shortens the room: the free surface
/// bears no stress, -p + 2 eta v / L = 0.
double pistonPressure_Pa(const S& s, double t) {
  const double weight = s.fluid().density_kgm3 * s.g() * pistonHeight(s, t) / 2;
  if (s.fluid().model != bolus::RheologyModel::newtonian) return weight;
  const auto& motion = s.def.motion;
  const double length_m = s.size()[motion.axis] - motion.speed.travel(t);
  return weight + 2 * s.fluid().viscosity_Pas * motion.speed.speed(t) / length_m;
}
double vortexDecay(const S& s, double t) {
  const double kx = 2 * kPi / s.size().x(), ky = 2 * kPi / s.size().y();
  return std::exp(-s.nu() * (kx * kx + ky * ky) * t);
}

}  // namespace

const std::vector<Formula>& formulas() {
  static const std::vector<Formula> table{
      // Profiles: functions of place and time.
      {"couette-startup",
       true,
       {kNewtonian, kChannel, kSlide},
       [](const S& s, const Probe& p) {
         const double L = s.size().z(), y = s.def.motion.high ? p.at.z() : L - p.at.z();
         return couetteStart_ms(y, p.time_s, L, s.def.motion.velocity_ms.x(), s.nu());
       }},
      {"plane-poiseuille-startup",
       true,
       {kNewtonian, kChannel, kForceX},
       [](const S& s, const Probe& p) {
         return planePoiseuilleStart_ms(p.at.z(), p.time_s, s.size().z(), s.def.gravity_ms2.x(),
                                        s.nu());
       }},
      {"pipe-poiseuille-startup",
       true,
       {kNewtonian, kTube, kForceX},
       [](const S& s, const Probe& p) {
         return pipePoiseuilleStart_ms(p.at.tail<2>().norm(), p.time_s, s.def.domain.radius_m,
                                       s.def.gravity_ms2.x(), s.nu());
       }},
      {"plane-steady",
       true,
       {kChannel, kForceX},
       [](const S& s, const Probe& p) {
         const double H = s.size().z() / 2;
         return signOf(s.def.gravity_ms2.x()) *
                steadyFlow_ms(s.fluid(), std::abs(p.at.z() - H), H, s.stress());
       }},
      {"pipe-steady",
       true,
       {kTube, kForceX},
       [](const S& s, const Probe& p) {
         return signOf(s.def.gravity_ms2.x()) *
                steadyFlow_ms(s.fluid(), p.at.tail<2>().norm(), s.def.domain.radius_m, s.stress());
       }},
      {"hydrostatic",
       true,
       {kGravity},
       [](const S& s, const Probe& p) {
         return s.fluid().density_kgm3 * s.g() * std::max(0.0, s.level_m - p.at.dot(s.up()));
       }},
      {"taylor-green",
       true,
       {kNewtonian, kVortices},
       [](const S& s, const Probe& p) {
         const double kx = 2 * kPi / s.size().x(), ky = 2 * kPi / s.size().y();
         return s.def.startRate * std::sin(kx * p.at.x()) * std::cos(ky * p.at.y()) *
                vortexDecay(s, p.time_s);
       }},
      {"rigid-rotation",
       true,
       {kRotates},
       [](const S& s, const Probe& p) {
         return s.def.motion.speed.final() * p.at.head<2>().norm();
       }},
      {"squeeze-plane-pressure",
       true,
       {kNewtonian, kPlates, kThin},
       [](const S& s, const Probe& p) {
         const double L = s.stripEdge(p.time_s).zero, h = s.gap(p.time_s);
         const double x = p.at.x() - s.centre().x();
         return 6 * s.fluid().viscosity_Pas * s.def.motion.speed.speed(p.time_s) *
                squeezeInertia(s, p.time_s, kStripInertia) * std::max(0.0, L * L - x * x) /
                (h * h * h);
       }},
      {"squeeze-disc-pressure",
       true,
       {kNewtonian, kPlates, kRound},
       [](const S& s, const Probe& p) {
         const double R = s.discEdge(p.time_s).zero, h = s.gap(p.time_s);
         return 3 * s.fluid().viscosity_Pas * s.def.motion.speed.speed(p.time_s) *
                squeezeInertia(s, p.time_s, kDiscInertia) *
                std::max(0.0, R * R - p.at.head<2>().squaredNorm()) / (h * h * h);
       }},
      {"squeeze-plane-velocity",
       true,
       {kNewtonian, kPlates, kThin},
       [](const S& s, const Probe& p) {
         const double h = s.gap(p.time_s), share = (p.at.z() - s.plateLow(p.time_s)) / h;
         return s.def.motion.speed.speed(p.time_s) * (p.at.x() - s.centre().x()) / h *
                squeezeParabola(share);
       }},
      {"squeeze-disc-velocity",
       true,
       {kNewtonian, kPlates, kRound},
       [](const S& s, const Probe& p) {
         const double h = s.gap(p.time_s), share = (p.at.z() - s.plateLow(p.time_s)) / h;
         return s.def.motion.speed.speed(p.time_s) * p.at.head<2>().norm() / (2 * h) *
                squeezeParabola(share);
       }},
      {"level-film",
       true,
       {kCoats, kRecedes},
       [](const S& s, const Probe& p) { return filmOfLevel_m(s.def, p.at.z()); }},
      {"plug-film",
       true,
       {kCoats, kPlug},
       [](const S& s, const Probe& p) { return filmOfPlug_m(s.def, p.at.z()); }},
      {"level-speed",
       true,
       {kRecedes},
       [](const S& s, const Probe& p) { return contactLineSpeed_ms(s.def, p.at.z()); }},
      {"plug-speed",
       true,
       {kPlug},
       [](const S& s, const Probe& p) { return contactLineSpeed_ms(s.def, p.at.z()); }},
      // Series: functions of time.
      {"free-fall-height",
       false,
       {kGravity},
       [](const S& s, const Probe& p) {
         return s.centre().z() + s.def.fill[0].velocity_ms.z() * p.time_s +
                0.5 * s.def.gravity_ms2.z() * p.time_s * p.time_s;
       }},
      {"free-fall-speed",
       false,
       {kGravity},
       [](const S& s, const Probe& p) {
         return s.def.fill[0].velocity_ms.z() + s.def.gravity_ms2.z() * p.time_s;
       }},
      {"taylor-green-energy",
       false,
       {kNewtonian, kVortices},
       [](const S& s, const Probe& p) {
         const double ratio = s.size().y() / s.size().x(), U = s.def.startRate;  // kx / ky
         return s.fluid().density_kgm3 * s.volume() * U * U / 8 * (1 + ratio * ratio) *
                std::pow(vortexDecay(s, p.time_s), 2);
       }},
      {"piston-height",
       false,
       {kSidePiston},
       [](const S& s, const Probe& p) { return pistonHeight(s, p.time_s); }},
      {"piston-pressure",
       false,
       {kSidePiston},
       [](const S& s, const Probe& p) { return pistonPressure_Pa(s, p.time_s); }},
      {"squeeze-plane-mean-pressure",
       false,
       {kNewtonian, kPlates, kThin},
       [](const S& s, const Probe& p) {
         const double L = s.stripHalf(p.time_s), h = s.gap(p.time_s);
         const auto [c, zero] = s.stripEdge(p.time_s);
         return 6 * s.fluid().viscosity_Pas * s.def.motion.speed.speed(p.time_s) *
                squeezeInertia(s, p.time_s, kStripInertia) * (zero * zero * c - c * c * c / 3) /
                (h * h * h * L);
       }},
      {"squeeze-disc-mean-pressure",
       false,
       {kNewtonian, kPlates, kRound},
       [](const S& s, const Probe& p) {
         const double R = s.discRadius(p.time_s), h = s.gap(p.time_s);
         const auto [c, zero] = s.discEdge(p.time_s);
         return 3 * s.fluid().viscosity_Pas * s.def.motion.speed.speed(p.time_s) *
                squeezeInertia(s, p.time_s, kDiscInertia) * c * c * (zero * zero - c * c / 2) /
                (h * h * h * R * R);
       }},
      {"shapiro-plane",
       false,
       {kNewtonian, kWave, kChannel},
       [](const S& s, const Probe&) {
         return shapiroPlane(s.def.motion.occlusion) * s.size().z() * s.size().y() *
                s.def.motion.speed.final();
       }},
      {"shapiro-tube",
       false,
       {kNewtonian, kWave, kTube},
       [](const S& s, const Probe&) {
         return shapiroTube(s.def.motion.occlusion) * kPi * std::pow(s.def.domain.radius_m, 2) *
                s.def.motion.speed.final();
       }},
      {"huppert-plane",
       false,
       {kNewtonian, kGravity, kThin},
       [](const S& s, const Probe& p) {
         return huppertPlane_m(s.volume() / s.size().y() / 2, p.time_s, s.g(), s.nu());
       }},
      {"huppert-round",
       false,
       {kNewtonian, kGravity},
       [](const S& s, const Probe& p) {
         return huppertRound_m(s.volume(), p.time_s, s.g(), s.nu());
       }},
      {"rotating-centre",
       false,
       {kRotates, kGravity, kRound},
       [](const S& s, const Probe&) {
         const double R = s.def.domain.radius_m, h = s.volume() / (kPi * R * R);
         const double bend = std::pow(s.def.motion.speed.final(), 2) / (2 * s.g());  // 1/m
         return h / 2 + bend * bend * std::pow(R, 4) / (24 * h);
       }},
      {"laplace-pressure",
       false,
       {kTension, kBall, kWeightless},
       [](const S& s, const Probe&) {
         return 2 * s.fluid().surfaceTension_Nm / s.def.fill[0].radius_m;
       }},
      {"young-angle",
       false,
       {kTension, kFloor, kWeightless},
       [](const S& s, const Probe&) { return s.fluid().contactAngle_rad; }},
      {"plug-half-width",
       false,
       {kYield, kForceX},
       [](const S& s, const Probe&) {
         const double H =
             s.def.domain.shape == Shape::tube ? s.def.domain.radius_m : s.size().z() / 2;
         return H * std::min(1.0, s.fluid().yield_Pa / s.stress());
       }},
  };
  return table;
}

}  // namespace swallowclip::verify
