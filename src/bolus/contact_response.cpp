// SPDX-License-Identifier: MIT
#include "bolus/contact_response.h"

#include <algorithm>
#include <cmath>

namespace swallowclip::bolus {
namespace {
constexpr double kRestDistance = 0.4;   // spacings (DESIGN 5, measured)
constexpr double kGapShare = 0.45;      // of the local gap (DESIGN 5, measured)
constexpr double kFacingCosine = -0.5;  // walls within 60 degrees of opposite, assumed (-0.8 to 0)
constexpr int kPasses = 3;              // Gauss-Seidel over the contacts, assumed (2 to 5)
constexpr int kRescues = 4;             // times a particle outside is looked at again, assumed
// Farther in one go no wall pushes, in spacings, assumed (0.1 to 0.5): where sheets cross and part,
// a cusp opens at once, and what it held comes out bit by bit.
constexpr double kLongestPush = 0.2;
// And no faster than that within this time: where a fold opens so far that its sheets no longer
// face each other, the distance to be kept leaps from a share of the gap to that of a wide place.
// In a step of 14 us a push of 0.2 spacings made a particle 16 % too dense. Assumed (0.05 to 0.2
// ms).
constexpr double kPush_s = 1e-4;
// But at least so many times as far as walls move, assumed (1 to 3).
constexpr double kAhead = 2;
// After a push no longer than this no wall point is looked for again; spacings, assumed (1e-3 to
// 0.03).
constexpr double kSmallPush = 0.01;
constexpr double kJustInside = 1e-3;  // spacings, assumed: small against the smallest gap

double keptDistance(double gap_m, double spacing_m) {
  return std::min(kRestDistance * spacing_m, kGapShare * gap_m);
}
}  // namespace

int facingContact(const std::vector<Contact>& c) {
  for (int k = 1; k < static_cast<int>(c.size()); ++k)
    if (c[k].inward.dot(c[0].inward) < kFacingCosine) return k;
  return -1;
}

double localGap_m(const std::vector<Contact>& c) {
  const int k = facingContact(c);
  return k < 0 ? INFINITY : c[0].distance_m + c[k].distance_m;
}

void clampVelocity(const std::vector<Contact>& contacts, double gap_m, double spacing_m,
                   double dt_s, Vec3& v) {
  if (contacts.empty()) return;
  const double kept = keptDistance(gap_m, spacing_m);
  bool turned = true;
  for (int pass = 0; pass < kPasses && turned; ++pass) {
    turned = false;
    for (const Contact& c : contacts) {
      const double least = std::min(0.0, (kept - c.distance_m) / dt_s);
      const double approach = (v - c.velocity).dot(c.inward);
      if (!(approach < least)) continue;
      v += (least - approach) * c.inward;
      turned = contacts.size() > 1;
    }
  }
}

void keepDistance(const std::vector<Contact>& contacts, double spacing_m, Vec3& x) {
  const double kept = keptDistance(localGap_m(contacts), spacing_m);
  bool moved = true;
  for (int pass = 0; pass < kPasses && moved; ++pass) {
    moved = false;
    for (const Contact& c : contacts) {
      const double d = (x - c.point).dot(c.inward);
      if (!(d < kept)) continue;
      x += (kept - d) * c.inward;
      moved = contacts.size() > 1;
    }
  }
}

bool measureAgain(std::vector<Contact>& contacts, const Vec3& x) {
  bool inside = true;
  for (Contact& c : contacts) {
    c.distance_m = (x - c.point).dot(c.inward);
    inside = inside && c.distance_m >= 0;
  }
  return inside;
}

double longestPush_m(double spacing_m, double dt_s, double walls_m) {
  const double longest_m = kLongestPush * spacing_m;
  return std::min(longest_m, std::max(longest_m * dt_s / kPush_s, kAhead * walls_m));
}

bool projectInside(const WallField& field, double spacing_m, double pushLimit_m, bool film, Vec3& x,
                   std::vector<Contact>& out) {
  const double reach = kContactReach * spacing_m, longest = kLongestPush * spacing_m;
  const Vec3 start = x;
  bool wasOutside = false;
  const auto stayAt = [&](const Vec3& place) {
    x = place;
    field.contacts(x, reach, out);
  };
  for (int k = 0; k < kRescues; ++k) {
    field.contacts(x, reach, out);
    if (out.empty() || out[0].distance_m >= 0) break;
    wasOutside = true;
    x = out[0].point + kJustInside * spacing_m * out[0].inward;
  }
  // Between sheets that cross the way inside can be far: bit by bit too.
  if (const double away = (x - start).norm(); wasOutside && away > longest)
    stayAt(start + longest / away * (x - start));
  if (film || out.empty() || out[0].distance_m < 0) return wasOutside;
  const Vec3 before = x;
  keepDistance(out, spacing_m, x);
  if (x == before) return wasOutside;
  const double pushed = (x - before).norm();
  if (pushed < kSmallPush * spacing_m && measureAgain(out, x)) return wasOutside;
  if (pushed > pushLimit_m) x = before + pushLimit_m / pushed * (x - before);
  field.contacts(x, reach, out);
  if (!out.empty() && out[0].distance_m < 0) stayAt(before);  // a corner threw it out
  return wasOutside;
}
}  // namespace swallowclip::bolus
