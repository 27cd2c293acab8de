// SPDX-License-Identifier: MIT
#include "verify/fill.h"

#include <algorithm>
#include <cmath>

namespace swallowclip::verify {
namespace {
constexpr double kMostParticles = 400'000;  // hours; far above any case of a few minutes

int cells(double length, double spacing) {
  return std::max(1, static_cast<int>(std::lround(length / spacing)));
}

/// Half a cell from every side.
void addBlock(const Vec3& low, const Vec3& size, double spacing, std::vector<Vec3>& out) {
  const int nx = cells(size.x(), spacing), ny = cells(size.y(), spacing),
            nz = cells(size.z(), spacing);
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        out.push_back(low + Vec3(size.x() * (i + 0.5) / nx, size.y() * (j + 0.5) / ny,
                                 size.z() * (k + 0.5) / nz));
}

/// One disc of a round body: rings of even width, half a width from the wall, each with as many
/// particles as its area asks for. Turned by `turn` so that discs do not line up.
void addDisc(int axis, const Vec3& centre, double radius, double spacing, int disc,
             std::vector<Vec3>& out) {
  const int rings = cells(radius, spacing);
  const double width = radius / rings;
  double wanted = 0;
  int placed = 0;
  for (int r = 0; r < rings; ++r) {
    wanted += kPi * (2 * r + 1) * width * width / (spacing * spacing);
    const int n = std::max(1, static_cast<int>(std::lround(wanted)) - placed);
    placed += n;
    for (int k = 0; k < n; ++k) {
      const double a = 2 * kPi * (k + 0.5 * (disc % 2) + 0.31 * r) / n;
      Vec3 p = centre;
      p[(axis + 1) % 3] += (r + 0.5) * width * std::cos(a);
      p[(axis + 2) % 3] += (r + 0.5) * width * std::sin(a);
      out.push_back(p);
    }
  }
}

/// As many of the lattice places nearest to the centre as the volume asks for.
void addSphere(const Vec3& centre, double radius, double spacing, std::vector<Vec3>& out) {
  const double volume = 4 * kPi / 3 * std::pow(radius, 3);
  const auto count = static_cast<std::size_t>(std::lround(volume / std::pow(spacing, 3)));
  const int reach = static_cast<int>(std::ceil(radius / spacing)) + 2;
  std::vector<Vec3> places;
  for (int k = -reach; k < reach; ++k)
    for (int j = -reach; j < reach; ++j)
      for (int i = -reach; i < reach; ++i)
        places.emplace_back((Vec3(i, j, k) + Vec3::Constant(0.5)) * spacing);
  std::ranges::stable_sort(
      places, [](const Vec3& a, const Vec3& b) { return a.squaredNorm() < b.squaredNorm(); });
  for (std::size_t k = 0; k < std::min(count, places.size()); ++k)
    out.push_back(centre + places[k]);
}

/// Between plane wavy walls: columns as high as the room is there.
void addWavyBox(const CaseDef& def, double spacing, std::vector<Vec3>& out) {
  const Vec3& size = def.domain.size_m;
  const int nx = cells(size.x(), spacing), ny = cells(size.y(), spacing);
  const double mean = meanHalfWidth_m(def), dx = size.x() / nx, dy = size.y() / ny;
  double wanted = 0;
  int placed = 0;
  for (int i = 0; i < nx; ++i) {
    const double x = (i + 0.5) * dx, half = waveHalfWidth_m(def, x, 0);
    wanted += 2 * half * dx * dy * ny / std::pow(spacing, 3);
    const int n = std::max(1, static_cast<int>(std::lround((wanted - placed) / ny)));
    placed += n * ny;
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < n; ++k)
        out.emplace_back(x, (j + 0.5) * dy, mean + half * (2 * (k + 0.5) / n - 1));
  }
}

void addDomain(const CaseDef& def, const Domain& domain, double spacing, std::vector<Vec3>& out) {
  const DomainDef& d = def.domain;
  if (d.shape == Shape::box) {
    if (def.motion.kind == MotionKind::peristalsis) return addWavyBox(def, spacing, out);
    return addBlock(Vec3::Zero(), d.size_m, spacing, out);
  }
  if (d.shape == Shape::cylinder || d.shape == Shape::tube) {
    const int axis = d.shape == Shape::tube ? 0 : 2, n = cells(d.length_m, spacing);
    for (int k = 0; k < n; ++k) {
      Vec3 centre = Vec3::Zero();
      centre[axis] = d.length_m * (k + 0.5) / n;
      addDisc(axis, centre,
              d.shape == Shape::tube ? waveHalfWidth_m(def, centre[axis], 0) : d.radius_m, spacing,
              k, out);
    }
    return;
  }
  // A lattice in a mesh: the edge at which it has as many places as the volume asks for.
  const auto count =
      static_cast<std::size_t>(std::lround(domain.volume_m3() / std::pow(spacing, 3)));
  double low = 0.9 * spacing, high = 1.1 * spacing;
  for (int step = 0; step < 20 && out.size() != count; ++step) {
    const double edge = (low + high) / 2;
    std::vector<Vec3> lattice;
    addBlock(domain.low_m(), domain.high_m() - domain.low_m(), edge, lattice);
    std::erase_if(lattice, [&](const Vec3& p) { return !domain.inside(p); });
    (lattice.size() > count ? low : high) = edge;
    out = std::move(lattice);
  }
}

double volumeOf(const FillDef& fill, const Domain& domain) {
  switch (fill.kind) {
    case FillKind::block:
      return fill.size_m.prod();
    case FillKind::sphere:
      return 4 * kPi / 3 * std::pow(fill.radius_m, 3);
    case FillKind::cylinder:
      return kPi * fill.radius_m * fill.radius_m * fill.size_m.z();
    case FillKind::domain:
      break;
  }
  return domain.volume_m3();
}
}  // namespace

Vec3 startVelocity(const CaseDef& def, const Vec3& p) {
  if (def.start == StartKind::rotation) return def.startRate * Vec3::UnitZ().cross(p);
  if (def.start != StartKind::taylorGreen) return Vec3::Zero();
  const double kx = 2 * kPi / def.domain.size_m.x(), ky = 2 * kPi / def.domain.size_m.y();
  return def.startRate * Vec3(std::sin(kx * p.x()) * std::cos(ky * p.y()),
                              -kx / ky * std::cos(kx * p.x()) * std::sin(ky * p.y()), 0);
}

Result<Start> fillDomain(const CaseDef& def, const Domain& domain, double spacing_m) {
  Start start;
  for (const FillDef& fill : def.fill) {
    if (fill.kind == FillKind::domain && domain.volume_m3() <= 0)
      return usageError(fill.place, "fill \"domain\" in free space has no end",
                        "Fill a block or a sphere, or give the domain walls.");
    start.volume_m3 += volumeOf(fill, domain);
  }
  if (const double n = start.volume_m3 / std::pow(spacing_m, 3); !(n >= 1 && n <= kMostParticles))
    return usageError(
        def.fill.front().place,
        fmt::format("the fluid makes {:.0f} particles, expected 1 to {:.0f}", n, kMostParticles),
        "Check sizes, spacing and units.");
  for (const FillDef& fill : def.fill) {
    std::vector<Vec3> places;
    if (fill.kind == FillKind::block) addBlock(fill.low_m, fill.size_m, spacing_m, places);
    if (fill.kind == FillKind::sphere) addSphere(fill.low_m, fill.radius_m, spacing_m, places);
    if (fill.kind == FillKind::cylinder)
      for (int k = 0, n = cells(fill.size_m.z(), spacing_m); k < n; ++k)
        addDisc(2, fill.low_m + Vec3(0, 0, fill.size_m.z() * (k + 0.5) / n), fill.radius_m,
                spacing_m, k, places);
    if (fill.kind == FillKind::domain) addDomain(def, domain, spacing_m, places);
    for (const Vec3& p : places) {
      if (!domain.inside(p))
        return usageError(fill.place,
                          fmt::format("fluid outside the domain, at ({:.2f}, {:.2f}, {:.2f}) mm",
                                      p.x() * 1e3, p.y() * 1e3, p.z() * 1e3),
                          "Move or shrink the fill, or widen the domain.");
      start.positions.push_back(domain.toWorld(p));
      start.velocities.push_back(domain.toWorld(fill.velocity_ms + startVelocity(def, p)));
    }
  }
  if (start.positions.empty())
    return usageError(def.fill.front().place, "not one particle fits", "Use a smaller spacing.");
  start.spacing_m = std::cbrt(start.volume_m3 / static_cast<double>(start.positions.size()));
  return start;
}
}  // namespace swallowclip::verify
