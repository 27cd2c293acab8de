// SPDX-License-Identifier: MIT
#include "verify/quantities.h"

#include <algorithm>
#include <cmath>

#include "bolus/tension.h"
#include "verify/analytic.h"

namespace swallowclip::verify {
namespace {
// Pressures of neighbouring layers are tied to each other only through their sum (collocated
// unknowns: a zigzag from layer to layer has almost no gradient), so two layers make one bin.
constexpr double kPressureBin = 2;         // spacings
constexpr std::size_t kSurfaceLayers = 3;  // a surface is read from, assumed (2 to 4)

/// Position across the axis of a round room: tubes lie along x, all else stands along z.
Vec3 fromAxis(const CaseDef& def, const Vec3& p) {
  return def.domain.shape == Shape::tube ? Vec3(0, p.y(), p.z()) : Vec3(p.x(), p.y(), 0);
}
int axisOf(const std::string& word) {
  return std::clamp(word.empty() ? 2 : word.back() - 'x', 0, 2);
}

bool within(const QuantityDef& q, const Vec3& p) {
  for (int k = 0; k < 3; ++k)
    if (!(p[k] >= q.within_m[k].first && p[k] <= q.within_m[k].second)) return false;
  return true;
}

double field(const QuantityDef& q, const Snapshot& s, std::size_t i) {
  const Vec3& v = s.velocities[i];
  if (q.of.starts_with("velocity-")) return v[axisOf(q.of)];
  if (q.of == "pressure") return s.pressure_Pa[i];
  if (q.of == "density-error") return s.densityRatio[i] - 1;
  if (q.of == "speed") return v.norm();
  const Vec3 r = fromAxis(*s.def, s.positions[i]);
  const double distance = r.norm();
  if (distance <= 0) return 0;
  if (q.of == "radial") return v.dot(r) / distance;
  const Vec3 axis = s.def->domain.shape == Shape::tube ? Vec3::UnitX() : Vec3::UnitZ();
  return v.dot(axis.cross(r)) / distance;  // swirl
}

double coordinate(const QuantityDef& q, const Snapshot& s, const Vec3& p) {
  if (q.along == "radius") return fromAxis(*s.def, p).norm();
  if (q.along == "up") return p.dot(s.up);
  return p[axisOf(q.along)];
}

/// Particles in one row across a thin periodic room, a handful elsewhere: the front is their mean.
std::size_t rowCount(const Snapshot& s) {
  const DomainDef& d = s.def->domain;
  if (d.shape == Shape::box && d.periodic[1])
    return std::max<std::size_t>(1, std::lround(d.size_m.y() / s.spacing_m));
  return 5;
}

/// Mean of the `count` largest, plus half of the thickness that these fill.
double farthest(std::vector<double> values, std::size_t count, double thickness) {
  if (values.empty()) return 0;
  count = std::clamp<std::size_t>(count, 1, values.size());
  std::ranges::nth_element(values, values.begin() + static_cast<long>(count) - 1, std::greater<>());
  double sum = 0;
  for (std::size_t k = 0; k < count; ++k) sum += values[k];
  return sum / static_cast<double>(count) + thickness / 2;
}

std::vector<double> along(const Snapshot& s, const QuantityDef& q, double sign) {
  std::vector<double> values;
  for (const Vec3& p : s.positions)
    if (within(q, p)) values.push_back(sign * p[axisOf(q.along)]);
  return values;
}

double mean(const Snapshot& s, const QuantityDef& q, auto&& value) {
  double sum = 0, n = 0;
  for (std::size_t i = 0; i < s.positions.size(); ++i)
    if (within(q, s.positions[i])) sum += value(i), ++n;
  return n > 0 ? sum / n : 0;
}

/// From the topmost layers, each of as many particles as one layer of the floor has.
/// Of fluid 10.3 spacings high the last 0.3 are no layer of their own: they lie among the one
/// below, and a surface read from that alone would be as much too low. So several are looked at.
double surfaceHeight(const Snapshot& s, const QuantityDef& q) {
  const DomainDef& d = s.def->domain;
  double area =
      d.shape == Shape::cylinder ? kPi * d.radius_m * d.radius_m : d.size_m.x() * d.size_m.y();
  if (s.def->motion.kind == MotionKind::piston && d.shape == Shape::box)
    area *= 1 - s.def->motion.speed.travel(s.time_s) / d.size_m[s.def->motion.axis];
  const auto layer =
      static_cast<std::size_t>(std::max(1L, std::lround(area / (s.spacing_m * s.spacing_m))));
  const QuantityDef up{.kind = q.kind, .along = "z", .within_m = q.within_m};
  std::vector<double> heights = along(s, up, 1);
  const std::size_t layers = std::clamp<std::size_t>(heights.size() / layer, 1, kSurfaceLayers);
  return farthest(std::move(heights), layers * layer, layers * s.spacing_m);
}

// A plug's edge is rounded off over less than a spacing. Among eight to the wall, this share of the
// fastest speed is lost 1.0 to 1.3 of them away from it. Assumed (0.03 to 0.06: with 0.08 two
// spacings of plug come out 4 % thin, as the line is long and its sheared bins are far away).
constexpr double kRoundedOff = 0.05;
/// Beside a plug shear stress grows as consistency times rate^n: a straight line through rate^n of
/// the sheared bins meets zero at the plug's edge, however much a resolution rounds that edge off.
double plugHalfWidth(const Snapshot& s) {
  const bool tube = s.def->domain.shape == Shape::tube;
  const QuantityDef q{.kind = "profile", .of = "velocity-x", .along = tube ? "radius" : "z"};
  ProfileSum sum;
  sum.add(q, s, [](const Probe&) { return 0.0; });
  const auto points = sum.points();
  double fastest = 0;
  for (const auto& p : points) fastest = std::max(fastest, std::abs(p.measured));
  const double middle = tube ? 0 : s.def->domain.size_m.z() / 2;
  const auto sheared = [&](const auto& p) {
    return std::abs(p.measured) <= (1 - kRoundedOff) * fastest;
  };
  double sw = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t k = 1; k < points.size(); ++k) {
    const auto &p = points[k - 1], &r = points[k];
    if (!sheared(p) || !sheared(r) || (p.along < middle) != (r.along < middle)) continue;
    const double rate = std::abs((r.measured - p.measured) / (r.along - p.along));
    const double x = std::abs((p.along + r.along) / 2 - middle);
    const double y = std::pow(rate, s.def->fluid.index);
    sw += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  const double slope = (sw * sxy - sx * sy) / (sw * sxx - sx * sx);
  return sw < 2 ? 0 : (sx - sy / slope) / sw;
}

/// Mean where surface tension itself no longer reaches, a particle's half more from the surface.
double dropPressure_Pa(const Snapshot& s, const QuantityDef& q) {
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : s.positions) centre += p / static_cast<double>(s.positions.size());
  const double volume_m3 = s.particleVolume_m3 * static_cast<double>(s.positions.size());
  const double inner_m =
      std::cbrt(3 * volume_m3 / (4 * kPi)) - (bolus::kTensionReach + 0.5) * s.spacing_m;
  double sum = 0, n = 0;
  for (std::size_t i = 0; i < s.positions.size(); ++i)
    if (within(q, s.positions[i]) && (s.positions[i] - centre).norm() < inner_m)
      sum += s.pressure_Pa[i], ++n;
  return n > 0 ? sum / n : 0;
}

/// Of the spherical cap on the floor z = 0 whose mean height, over its radius of gyration about the
/// axis, is that of the fluid: all particles have a say, not only those on top and at the rim.
double contactAngle_rad(const Snapshot& s, const QuantityDef& q) {
  const auto of = [&](int axis) {
    return mean(s, q, [&](std::size_t i) { return s.positions[i][axis]; });
  };
  const double x = of(0), y = of(1);
  const double square = mean(s, q, [&](std::size_t i) {
    return std::pow(s.positions[i].x() - x, 2) + std::pow(s.positions[i].y() - y, 2);
  });
  const double wanted = of(2) / std::sqrt(std::max(square, 1e-300));
  double low = 0, high = kPi;
  for (int k = 0; k < 60; ++k) {
    const double angle = (low + high) / 2;
    (capSlenderness(angle) < wanted ? low : high) = angle;
  }
  return low;
}

struct Row {
  const char* name;
  Unit unit;
  double (*value)(const Snapshot&, const QuantityDef&);
};
constexpr Unit kMm{"mm", 1e3}, kMms{"mm/s", 1e3}, kPa{"Pa", 1}, kRatio{"-", 1},
    kDeg{"deg", 180 / kPi};

const std::vector<Row>& rows() {
  static const std::vector<Row> table{
      {"front", kMm,
       [](const Snapshot& s, const QuantityDef& q) {
         return farthest(along(s, q, 1), rowCount(s), s.spacing_m);
       }},
      {"spread", kMm,
       [](const Snapshot& s, const QuantityDef& q) {
         return (farthest(along(s, q, 1), rowCount(s), s.spacing_m) +
                 farthest(along(s, q, -1), rowCount(s), s.spacing_m)) /
                2;
       }},
      {"spread-round", kMm,
       [](const Snapshot& s, const QuantityDef& q) {
         // mean over 24 directions of the farthest in each
         std::vector<double> reach(24, 0.0);
         const Vec3 c(mean(s, q, [&](std::size_t i) { return s.positions[i].x(); }),
                      mean(s, q, [&](std::size_t i) { return s.positions[i].y(); }), 0);
         for (const Vec3& p : s.positions) {
           const double turn = std::atan2(p.y() - c.y(), p.x() - c.x()) / (2 * kPi) + 0.5;
           const auto k = std::min<std::size_t>(23, static_cast<std::size_t>(turn * 24));
           reach[k] = std::max(reach[k], std::hypot(p.x() - c.x(), p.y() - c.y()));
         }
         double sum = 0;
         for (double r : reach) sum += r;
         return sum / 24 + s.spacing_m / 2;
       }},
      {"surface-height", kMm, surfaceHeight},
      {"centre-of-mass", kMm,
       [](const Snapshot& s, const QuantityDef& q) {
         return mean(s, q, [&](std::size_t i) { return s.positions[i][axisOf(q.along)]; });
       }},
      {"mean-velocity", kMms,
       [](const Snapshot& s, const QuantityDef& q) {
         return mean(s, q, [&](std::size_t i) { return s.velocities[i][axisOf(q.along)]; });
       }},
      {"max-speed", kMms,
       [](const Snapshot& s, const QuantityDef& q) {
         double most = 0;
         for (std::size_t i = 0; i < s.positions.size(); ++i)
           if (within(q, s.positions[i])) most = std::max(most, s.velocities[i].norm());
         return most;
       }},
      {"mean-pressure", kPa,
       [](const Snapshot& s, const QuantityDef& q) {
         return mean(s, q, [&](std::size_t i) { return s.pressure_Pa[i]; });
       }},
      {"drop-pressure", kPa, dropPressure_Pa},
      {"contact-angle", kDeg, contactAngle_rad},
      {"kinetic-energy",
       {"uJ", 1e6},
       [](const Snapshot& s, const QuantityDef&) {
         double sum = 0;
         for (const Vec3& v : s.velocities) sum += v.squaredNorm();
         return 0.5 * s.def->fluid.density_kgm3 * s.particleVolume_m3 * sum;
       }},
      {"momentum-drift", kRatio,
       [](const Snapshot& s, const QuantityDef&) {
         Vec3 sum = Vec3::Zero();
         for (const Vec3& v : s.velocities) sum += v;
         sum *= s.def->fluid.density_kgm3 * s.particleVolume_m3;
         return (sum - s.firstMomentum).norm() / std::max(s.firstMomentum.norm(), 1e-300);
       }},
      {"flow",
       {"mm3/s", 1e9},
       [](const Snapshot& s, const QuantityDef& q) {
         const int k = axisOf(q.along);
         double sum = 0;
         for (const Vec3& v : s.velocities) sum += v[k];
         const double length =
             s.def->domain.shape == Shape::tube ? s.def->domain.length_m : s.def->domain.size_m[k];
         return sum * s.particleVolume_m3 / length;
       }},
      {"density-error", kRatio,
       [](const Snapshot& s, const QuantityDef& q) {
         return mean(s, q, [&](std::size_t i) { return std::max(0.0, s.densityRatio[i] - 1); });
       }},
      {"film-exponent", kRatio,
       [](const Snapshot& s, const QuantityDef& q) {
         std::vector<Patch> patches;
         for (const Patch& p : s.patches)
           if (within(q, p.centre)) patches.push_back(p);
         return filmExponent(*s.def, patches);
       }},
      {"plug-half-width", kMm,
       [](const Snapshot& s, const QuantityDef&) { return plugHalfWidth(s); }},
  };
  return table;
}

const Row* findRow(const std::string& name) {
  for (const Row& row : rows())
    if (name == row.name) return &row;
  return nullptr;
}
}  // namespace

std::vector<std::string> quantityNames() {
  std::vector<std::string> names{"profile"};
  for (const Row& row : rows()) names.emplace_back(row.name);
  return names;
}
std::vector<std::string> fieldNames() {
  return {"velocity-x", "velocity-y", "velocity-z",    "speed", "swirl",
          "radial",     "pressure",   "density-error", "film",  "contact-line-speed"};
}
std::vector<std::string> coordinateNames() {
  return {"x", "y", "z", "radius", "up"};
}

Unit unitOf(const QuantityDef& q) {
  if (q.kind != "profile") return findRow(q.kind)->unit;
  if (q.of == "film") return {"um", 1e6};
  return q.of == "pressure" ? kPa : q.of == "density-error" ? kRatio : kMms;
}

double measureSeries(const QuantityDef& q, const Snapshot& s) {
  const Row* row = findRow(q.kind);
  return row ? row->value(s, q) : 0;
}

namespace {
bool isOfWalls(const QuantityDef& q) {
  return q.of == "film" || q.of == "contact-line-speed";
}
constexpr int kPatchBins = 12;  // assumed (5 to 50)
}  // namespace

void ProfileSum::addPatches(const QuantityDef& q, const Snapshot& s, const Reference& reference) {
  if (count_.empty()) {
    double high = -INFINITY;
    low_ = INFINITY;
    for (const Patch& p : s.patches)
      if (within(q, p.centre)) {
        low_ = std::min(low_, coordinate(q, s, p.centre));
        high = std::max(high, coordinate(q, s, p.centre));
      }
    if (!(low_ < high)) return;
    const int bins = q.bins > 0 ? q.bins : kPatchBins;
    width_ = (high - low_) / bins;
    for (auto* sum : {&count_, &along_, &measured_, &reference_}) sum->assign(bins, 0.0);
  }
  for (const Patch& p : s.patches)
    if (within(q, p.centre))
      addOne(coordinate(q, s, p.centre), q.of == "film" ? p.film_m : p.speed_ms,
             reference({p.centre, coordinate(q, s, p.centre), s.time_s}));
}

void ProfileSum::addOne(double at, double measured, double wanted) {
  if (!std::isfinite(wanted)) return;
  const auto k = static_cast<std::size_t>(
      std::clamp((at - low_) / width_, 0.0, static_cast<double>(count_.size()) - 0.5));
  ++count_[k];
  along_[k] += at;
  measured_[k] += measured;
  reference_[k] += wanted;
}

void ProfileSum::add(const QuantityDef& q, const Snapshot& s, const Reference& reference) {
  if (isOfWalls(q)) return addPatches(q, s, reference);
  if (count_.empty()) {
    double low = INFINITY, high = -INFINITY;
    for (const Vec3& p : s.positions) {
      if (!within(q, p)) continue;
      low = std::min(low, coordinate(q, s, p));
      high = std::max(high, coordinate(q, s, p));
    }
    if (!(low <= high)) return;
    // particles lie half a spacing inside the fluid's ends
    low_ = low - s.spacing_m / 2;
    const double range = high - low + s.spacing_m;
    const double bin_m = (q.of == "pressure" ? kPressureBin : 1) * s.spacing_m;
    const int bins = q.bins > 0 ? q.bins : std::max(2, int(std::lround(range / bin_m)));
    width_ = range / bins;
    for (auto* sum : {&count_, &along_, &measured_, &reference_}) sum->assign(bins, 0.0);
  }
  for (std::size_t i = 0; i < s.positions.size(); ++i) {
    const Vec3& p = s.positions[i];
    if (!within(q, p)) continue;
    const double at = coordinate(q, s, p);
    addOne(at, field(q, s, i), reference({p, at, s.time_s}));
  }
}

std::vector<ProfileSum::Point> ProfileSum::points() const {
  std::vector<Point> points;
  for (std::size_t k = 0; k < count_.size(); ++k)
    if (count_[k] > 0)
      points.push_back(
          {along_[k] / count_[k], measured_[k] / count_[k], reference_[k] / count_[k]});
  return points;
}
}  // namespace swallowclip::verify
