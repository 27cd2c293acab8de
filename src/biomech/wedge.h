// SPDX-License-Identifier: MIT
// One six-node wedge (prism) element: linear in the triangle (r, s), linear across it (z, -1 inside
// to 1 outside), three by two Gauss points.
#pragma once
#include <array>

#include "core/vec.h"

namespace swallowclip::biomech {

/// Nodes 0-2: inner triangle, 3-5: the outer one, both counter-clockwise seen from outside.
using Wedge = std::array<Vec3, 6>;

double wedgeVolume(const Wedge& w);

/// Smallest determinant of dx/d(r,s,z) over the Gauss points and the nodes, in m^3; positive
/// everywhere means that the element is nowhere turned inside out. A right prism of area A and
/// thickness h has A h everywhere.
double wedgeMinJacobian(const Wedge& w);

/// Volume mean over the Gauss points of the Green-Lagrange strain (F'F - I)/2, with F = d now / d
/// rest. Zero for every rigid motion; in the axes of the rest pose.
Mat3 wedgeStrain(const Wedge& rest, const Wedge& now);
}  // namespace swallowclip::biomech
