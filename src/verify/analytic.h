// SPDX-License-Identifier: MIT
// The formulas themselves, free of case files. SI units.
#pragma once
#include "bolus/fluid.h"

namespace swallowclip::verify {

/// Morris, Fox & Zhu 1997, eq. 20 and 22: walls at y = 0 and L, kinematic viscosity nu (m2/s).
double couetteStart_ms(double y, double t, double L, double wall_ms, double nu);
double planePoiseuilleStart_ms(double y, double t, double L, double force_ms2, double nu);
/// Szymanski 1932: the same in a pipe of radius R.
double pipePoiseuilleStart_ms(double r, double t, double R, double force_ms2, double nu);

/// Steady flow at a distance from the middle of a plane channel (half width H) or from the axis of
/// a pipe (radius H) whose wall stress is `wallStress_Pa`; any rheology that fluid.h knows, without
/// its clips. Bird, Armstrong & Hassager 1987, ch. 4.
double steadyFlow_ms(const bolus::Fluid& fluid, double distance, double H, double wallStress_Pa);

/// Shear rate at which the fluid bears a stress.
double shearRateAt_s(const bolus::Fluid& fluid, double stress_Pa);

/// Shapiro, Jaffrin & Weinberg 1969: time-mean flow at zero pressure rise, in units of
/// (half width x wave speed) per half channel and unit depth, or of (pi a2 c).
double shapiroPlane(double occlusion);
double shapiroTube(double occlusion);

/// Huppert 1982: front of a viscous gravity current of given area (per unit width, m2, on one side
/// of its plane of symmetry) or volume (m3, round).
double huppertPlane_m(double area_m2, double t, double g_ms2, double nu);
double huppertRound_m(double volume_m3, double t, double g_ms2, double nu);

/// Free edge of fluid between plates that close, lengths (m) from the middle. It sticks to them and
/// bulges, until the bulge is half round and rolls.
struct SqueezedEdge {
  double contact;  ///< where the plates' wet part ends
  double zero;     ///< where the parabola of pressure far from the edge would be zero
};
/// From the half length `start` before they close, and the mean one `mean` at a gap `gap`. How the
/// pressure meets the edge is a fit (within 0.02 gaps for mean / gap from 4 to 9) to solutions of
/// Stokes' equations of strips, tests/verify/squeezed_edge_test.cpp; a disc's rim is taken to be
/// like them.
SqueezedEdge squeezedEdge_m(double start, double mean, double gap);

/// What inertia adds to the pressure between plates that close at constant speed V, times rho V h /
/// eta, to first order: Jackson 1963, Appl. Sci. Res. A 11, for discs; for strips the same
/// expansion of u = V x / h F'(z / h).
inline constexpr double kStripInertia = 17.0 / 70, kDiscInertia = 5.0 / 28;

/// Of a spherical cap that meets its floor under an angle (rad): mean height over the floor divided
/// by the radius of gyration about the axis. Grows with the angle, from 0 at 0.
double capSlenderness(double angle_rad);

}  // namespace swallowclip::verify
