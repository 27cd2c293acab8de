// SPDX-License-Identifier: MIT
// What keeps a sparse free surface inside: speculative contact on velocities, an inward projection
// on positions. Both keep min(0.4 dx, 0.45 gap) from the walls (DESIGN 5).
#pragma once
#include <vector>

#include "bolus/wall_field.h"

namespace swallowclip::bolus {

/// Search radius for contacts in spacings: a rest distance, plus a step of at most half a spacing.
inline constexpr double kContactReach = 0.9;

/// Width of the lumen where the particle is: nearest wall plus the one that faces it; infinite
/// when no wall within reach faces it.
double localGap_m(const std::vector<Contact>& contacts);

/// Index of the contact facing the nearest one, or -1.
int facingContact(const std::vector<Contact>& contacts);

/// Changes v so that the position after dt keeps its distance; never pushes, only stops. `gap_m` is
/// localGap_m of the contacts.
void clampVelocity(const std::vector<Contact>& contacts, double gap_m, double spacing_m,
                   double dt_s, Vec3& v);

/// Moves x away from the walls that it is nearer to than it may be.
void keepDistance(const std::vector<Contact>& contacts, double spacing_m, Vec3& x);

/// Distances from the same wall points to x; false when it is behind one.
bool measureAgain(std::vector<Contact>& contacts, const Vec3& x);

/// How far walls that move no farther than `walls_m` in a step push a particle to where it keeps
/// its distance.
double longestPush_m(double spacing_m, double dt_s, double walls_m);

/// Moves x to where it keeps its distance (a film: just inside), no farther than `pushLimit_m`, and
/// leaves the contacts of that place. Returns true when it was outside; from there bit by bit, too.
bool projectInside(const WallField& field, double spacing_m, double pushLimit_m, bool film, Vec3& x,
                   std::vector<Contact>& contacts);
}  // namespace swallowclip::bolus
