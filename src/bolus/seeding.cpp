// SPDX-License-Identifier: MIT
#include "bolus/seeding.h"

#include <algorithm>
#include <cmath>

#include "bolus/wall_field.h"

namespace swallowclip::bolus {
namespace {
// Lattices tried in turn, in spacings: (edge, distance from walls). A closer lattice is over-dense
// and spreads while it settles. 0.4: DESIGN 5; the others assumed.
struct Lattice {
  double edge, wallDistance;
};
constexpr Lattice kLattices[] = {{1.0, 0.4}, {0.96, 0.4}, {0.92, 0.35}, {0.88, 0.3}, {0.84, 0.3}};
constexpr double kShifts[] = {0.0, 0.5};        // lattice offsets per axis, in lattice edges
constexpr std::size_t kMostPlaces = 4'000'000;  // a range given in millimetres must not fill memory

bool withinRange(const WallMotion& m, const NearestPoint& at, const SeedRange& range) {
  if (m.s_m.empty()) return true;
  const Triangle& t = m.triangles[at.triangle];
  const double s = Vec3(m.s_m[t[0]], m.s_m[t[1]], m.s_m[t[2]]).dot(at.barycentric);
  return s >= range.sMin_m && s <= range.sMax_m;
}

struct Box {
  Vec3 low = Vec3::Constant(INFINITY), high = Vec3::Constant(-INFINITY);
};
Box boxOfRange(const WallMotion& m, const std::vector<Vec3>& x, const SeedRange& range) {
  Box box;
  for (std::size_t v = 0; v < x.size(); ++v) {
    if (!m.s_m.empty() && (m.s_m[v] < range.sMin_m || m.s_m[v] > range.sMax_m)) continue;
    box.low = box.low.cwiseMin(x[v]);
    box.high = box.high.cwiseMax(x[v]);
  }
  return box;
}
}  // namespace

Result<std::vector<Vec3>> seedPlaces(const WallMotion& m, const std::vector<Vec3>& x,
                                     const Vec3& gravity, const SeedRange& range, double spacing,
                                     int count) {
  const Box box = boxOfRange(m, x, range);
  const std::string place =
      fmt::format("bolus seed, s {:.1f} to {:.1f} mm", range.sMin_m * 1e3, range.sMax_m * 1e3);
  if (!(box.low.array() <= box.high.array()).all())
    return usageError(place, "no skin vertex has a path coordinate in this range",
                      "give the range of the held mouth, in metres");
  const Vec3 edges = (box.high - box.low) / (0.8 * spacing);
  if (!(edges.prod() < kMostPlaces))
    return usageError(place, fmt::format("the range is {:.0f} lattice places large", edges.prod()),
                      "check the units of the skin (metres) and of the spacing");
  const KernelTable table{Kernel(KernelKind::cubicSpline, 2 * spacing)};
  WallField field(table, spacing);
  const std::vector<Vec3> still(x.size(), Vec3::Zero());
  field.build(m.triangles, x, still, box.low, box.high);
  TriangleRuns runs;
  runs.build(x, m.triangles);
  std::vector<Contact> contacts;
  int best = 0;
  for (const Lattice& lattice : kLattices)
    for (int shift = 0; shift < 8; ++shift) {
      const double edge = lattice.edge * spacing;
      const Vec3 origin = box.low + edge * Vec3(kShifts[shift & 1], kShifts[shift >> 1 & 1],
                                                kShifts[shift >> 2 & 1]);
      const Eigen::Vector3i n = ((box.high - origin) / edge).array().ceil().max(0).cast<int>();
      std::vector<Vec3> places;
      std::vector<std::uint8_t> within((n.x() + 1) * (n.y() + 1) * (n.z() + 1));
      const int rowStep = n.x() + 1, layerStep = rowStep * (n.y() + 1);
      int at = -1;
      for (int k = 0; k <= n.z(); ++k)
        for (int j = 0; j <= n.y(); ++j)
          for (int i = 0; i <= n.x(); ++i) {
            const Vec3 p = origin + edge * Vec3(i, j, k);
            ++at;
            field.contacts(p, table.support_m(), contacts);
            // Beside a wall its side decides. No wall within a support: the same side as the place
            // before, an edge away; the first place of all is counted.
            if (!contacts.empty())
              within[at] = contacts[0].distance_m > 0;
            else if (at > 0)
              within[at] = within[at - (i > 0 ? 1 : j > 0 ? rowStep : layerStep)];
            else
              within[at] = windingNumber(p, x, m.triangles) > 0.5;
            if (!within[at]) continue;
            if (!contacts.empty() && contacts[0].distance_m < lattice.wallDistance * spacing)
              continue;
            if (withinRange(m, runs.nearest(p, x, m.triangles, -1), range)) places.push_back(p);
          }
      best = std::max(best, static_cast<int>(places.size()));
      if (static_cast<int>(places.size()) < count) continue;
      std::stable_sort(places.begin(), places.end(), [&](const Vec3& a, const Vec3& b) {
        return a.dot(gravity) > b.dot(gravity) + 1e-12;
      });
      places.resize(count);
      return places;
    }
  return failure(
      place,
      fmt::format("the lumen has places for {} of {} particles ({:.2f} of {:.2f} mL)", best, count,
                  best * std::pow(spacing, 3) * 1e6, count * std::pow(spacing, 3) * 1e6),
      "hold a smaller bolus, or open the held mouth to 1.15 times its volume");
}
}  // namespace swallowclip::bolus
