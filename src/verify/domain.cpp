// SPDX-License-Identifier: MIT
#include "verify/domain.h"

#include <algorithm>
#include <cmath>

#include "anatomy/mesh_import.h"
#include "bolus/closed_walls.h"
#include "verify/domain_mesh.h"

namespace swallowclip::verify {
namespace {
// Walls of a periodic axis go on for this many spacings beyond both ends: more than the widest
// kernel support (2.5; 3 of surface tension) and one step.
constexpr double kBeyond = 4;
constexpr double kMostTriangles = 1e6;  // of walls; a swallow has some 20 000
constexpr double kAlmost = 1e-9;        // m; vertices this near a face belong to it

using Moving = std::function<void(double, std::vector<Vec3>&, std::vector<Vec3>&)>;

Moving still(const std::vector<Vec3>& rest) {
  return [rest](double, std::vector<Vec3>& x, std::vector<Vec3>& v) {
    x = rest;
    v.assign(rest.size(), Vec3::Zero());
  };
}

/// A face that slides in itself: the surface stays, its velocity does not vanish.
Moving slide(const std::vector<Vec3>& rest, const MotionDef& motion, double face) {
  return [rest, motion, face](double, std::vector<Vec3>& x, std::vector<Vec3>& v) {
    x = rest;
    v.assign(rest.size(), Vec3::Zero());
    for (std::size_t k = 0; k < rest.size(); ++k)
      if (std::abs(rest[k][motion.axis] - face) < kAlmost) v[k] = motion.velocity_ms;
  };
}

/// Faces low and high of an axis moved inwards; the side walls get shorter without sliding, so
/// only the faces have a velocity.
Moving press(const std::vector<Vec3>& rest, const MotionDef& motion, double low, double high,
             double lowShare, double highShare) {
  return [=](double t, std::vector<Vec3>& x, std::vector<Vec3>& v) {
    x = rest;
    v.assign(rest.size(), Vec3::Zero());
    const double travel = motion.speed.travel(t), speed = motion.speed.speed(t);
    for (std::size_t k = 0; k < rest.size(); ++k) {
      const double share = (rest[k][motion.axis] - low) / (high - low);
      x[k][motion.axis] += travel * (lowShare * (1 - share) - highShare * share);
      if (share < kAlmost) v[k][motion.axis] = lowShare * speed;
      if (share > 1 - kAlmost) v[k][motion.axis] = -highShare * speed;
    }
  };
}

Moving rotate(const std::vector<Vec3>& rest, const MotionDef& motion) {
  return [rest, motion](double t, std::vector<Vec3>& x, std::vector<Vec3>& v) {
    const double angle = motion.speed.travel(t), rate = motion.speed.speed(t);
    const Mat3 turn = Eigen::AngleAxisd(angle, Vec3::UnitZ()).toRotationMatrix();
    x.resize(rest.size());
    v.resize(rest.size());
    for (std::size_t k = 0; k < rest.size(); ++k) {
      x[k] = turn * rest[k];
      v[k] = rate * Vec3::UnitZ().cross(x[k]);
    }
  };
}

/// Walls move across the mean flow only (Shapiro, Jaffrin & Weinberg 1969).
Moving wave(const std::vector<Vec3>& rest, const CaseDef& def) {
  const double mean = meanHalfWidth_m(def);
  const bool tube = def.domain.shape == Shape::tube;
  return [=](double t, std::vector<Vec3>& x, std::vector<Vec3>& v) {
    const double travel = def.motion.speed.travel(t), speed = def.motion.speed.speed(t);
    const double length = tube ? def.domain.length_m : def.domain.size_m.x();
    const double k = 2 * kPi * def.motion.waves / length;
    x = rest;
    v.assign(rest.size(), Vec3::Zero());
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const double stretch = waveHalfWidth_m(def, rest[i].x(), travel) / mean;
      const double rate = -def.motion.occlusion * k * speed * std::cos(k * (rest[i].x() - travel));
      if (tube) {
        x[i].tail<2>() = rest[i].tail<2>() * stretch;
        v[i].tail<2>() = rest[i].tail<2>() * rate;
      } else {
        const double above = rest[i].z() - mean;
        x[i].z() = mean + above * stretch;
        v[i].z() = above * rate;
      }
    }
  };
}
}  // namespace

double SpeedProfile::speed(double t) const {
  if (points.empty()) return 0;
  if (t <= points.front().first) return points.front().second;
  for (std::size_t k = 1; k < points.size(); ++k) {
    const auto [t0, v0] = points[k - 1];
    const auto [t1, v1] = points[k];
    if (t < t1) return v0 + (v1 - v0) * (t - t0) / (t1 - t0);
  }
  return points.back().second;
}

double SpeedProfile::travel(double t) const {
  double sum = 0, last = 0;
  // exact for straight pieces: midpoint rule between the corners
  for (const auto& [corner, v] : points)
    if (corner > last && corner < t)
      sum += speed((last + corner) / 2) * (corner - last), last = corner;
  return t > last ? sum + speed((last + t) / 2) * (t - last) : sum;
}

double meanHalfWidth_m(const CaseDef& def) {
  return def.domain.shape == Shape::tube ? def.domain.radius_m : def.domain.size_m.z() / 2;
}

double waveHalfWidth_m(const CaseDef& def, double x, double travel) {
  const double mean = meanHalfWidth_m(def);
  if (def.motion.kind != MotionKind::peristalsis) return mean;
  const double length =
      def.domain.shape == Shape::tube ? def.domain.length_m : def.domain.size_m.x();
  return mean *
         (1 + def.motion.occlusion * std::sin(2 * kPi * def.motion.waves * (x - travel) / length));
}

Result<Domain> Domain::build(const CaseDef& def, double spacing_m) {
  Domain d;
  d.def_ = &def;
  d.walls_ = std::make_shared<bolus::WallMotion>();
  const DomainDef& shape = def.domain;
  const double edge = shape.edge_m > 0 ? shape.edge_m : spacing_m;
  const double beyond = kBeyond * spacing_m;
  d.turn_ = Eigen::AngleAxisd(shape.tilt_rad, Vec3::UnitY()).toRotationMatrix();
  TriMesh mesh;
  // Two triangles per square of the walls, with room for what goes on beyond periods.
  const Vec3 sides = shape.shape == Shape::box ? Vec3(shape.size_m.array() + 2 * beyond)
                                               : Vec3(2 * shape.radius_m, 2 * shape.radius_m,
                                                      shape.length_m + 2 * beyond);
  const double area = 2 * (sides.x() * sides.y() + sides.y() * sides.z() + sides.z() * sides.x());
  if (shape.shape != Shape::mesh && shape.shape != Shape::none &&
      2 * area / (edge * edge) > kMostTriangles)
    return usageError("",
                      fmt::format("walls of {:.2g} triangles, at most {:.2g} are made",
                                  2 * area / (edge * edge), kMostTriangles),
                      "Use a wider spacing or edge_mm, or a smaller domain.");
  if (shape.shape == Shape::box) {
    d.high_m_ = shape.size_m;
    Vec3 low = Vec3::Zero(), high = shape.size_m;
    for (int k = 0; k < 3; ++k) {
      if (!shape.periodic[k]) continue;
      d.period_m_[k] = shape.size_m[k];
      low[k] -= beyond;
      high[k] += beyond;
    }
    d.volume_m3_ = shape.size_m.prod();
    if (def.motion.kind == MotionKind::peristalsis) {
      const double crest = def.motion.occlusion * shape.size_m.z() / 2;
      d.low_m_.z() -= crest;
      d.high_m_.z() += crest;
    }
    if (d.period_m_.minCoeff() <= 0) mesh = boxMesh(low, high, edge);
  } else if (shape.shape == Shape::cylinder) {
    mesh = roundMesh(2, shape.radius_m, 0, shape.length_m, edge);
    d.low_m_ = Vec3(-shape.radius_m, -shape.radius_m, 0);
    d.high_m_ = Vec3(shape.radius_m, shape.radius_m, shape.length_m);
    d.volume_m3_ = kPi * shape.radius_m * shape.radius_m * shape.length_m;
  } else if (shape.shape == Shape::tube) {
    d.period_m_.x() = shape.length_m;
    mesh = roundMesh(0, shape.radius_m, -beyond, shape.length_m + beyond, edge);
    const double widest = shape.radius_m * (1 + def.motion.occlusion);
    d.low_m_ = Vec3(0, -widest, -widest);
    d.high_m_ = Vec3(shape.length_m, widest, widest);
    d.volume_m3_ = kPi * shape.radius_m * shape.radius_m * shape.length_m *
                   (1 + def.motion.occlusion * def.motion.occlusion / 2);
  } else if (shape.shape == Shape::mesh) {
    auto raw = anatomy::readMeshFile(shape.file, "");
    if (!raw) return std::unexpected(raw.error());
    for (Vec3& p : raw->corners) p *= shape.metresPerUnit;
    std::vector<std::string> report;
    const std::vector<anatomy::RawMesh> frames{*raw};
    auto map = anatomy::weldFrames(frames, report);
    if (!map) return std::unexpected(map.error());
    if (auto ok = anatomy::closeSurface(*map, *raw, anatomy::SurfaceClosure::requireClosed, false,
                                        shape.file.string(), report);
        !ok)
      return std::unexpected(ok.error());
    mesh = {map->apply(raw->corners), map->triangles};
    d.low_m_ = d.high_m_ = mesh.positions[0];
    for (const Vec3& p : mesh.positions)
      d.low_m_ = d.low_m_.cwiseMin(p), d.high_m_ = d.high_m_.cwiseMax(p);
    d.volume_m3_ = volume(mesh);
  }
  d.rest_ = mesh.positions;
  for (Vec3& p : mesh.positions) p = d.turn_ * p;
  d.walls_->triangles = mesh.triangles;
  const MotionDef& motion = def.motion;
  const double high = shape.shape == Shape::cylinder ? shape.length_m : shape.size_m[motion.axis];
  switch (motion.kind) {
    case MotionKind::still:
      d.walls_->at = still(mesh.positions);
      d.walls_->standsStill = true;
      break;
    case MotionKind::slide:
      d.walls_->at = slide(mesh.positions, motion, motion.high ? high : 0);
      break;
    case MotionKind::piston:
      d.walls_->at = press(mesh.positions, motion, 0, high, !motion.high, motion.high);
      break;
    case MotionKind::close:
      d.walls_->at = press(mesh.positions, motion, 0, high, 0.5, 0.5);
      break;
    case MotionKind::rotate:
      d.walls_->at = rotate(mesh.positions, motion);
      break;
    case MotionKind::peristalsis:
      d.walls_->at = wave(mesh.positions, def);
      break;
  }
  return d;
}

double Domain::narrowest_m() const {
  return def_->domain.shape == Shape::none ? INFINITY : (high_m_ - low_m_).minCoeff();
}

bool Domain::inside(const Vec3& p) const {
  const DomainDef& d = def_->domain;
  switch (d.shape) {
    case Shape::none:
      return true;
    case Shape::cylinder:
      return p.head<2>().norm() < d.radius_m && p.z() > 0 && p.z() < d.length_m;
    case Shape::tube:
      return p.x() >= 0 && p.x() < d.length_m &&
             p.tail<2>().norm() < waveHalfWidth_m(*def_, p.x(), 0);
    case Shape::box:
      if (def_->motion.kind == MotionKind::peristalsis)
        return (p.head<2>().array() >= 0).all() &&
               (p.head<2>().array() < d.size_m.head<2>().array()).all() &&
               std::abs(p.z() - meanHalfWidth_m(*def_)) < waveHalfWidth_m(*def_, p.x(), 0);
      return (p.array() >= 0).all() && (p.array() < d.size_m.array()).all();
    case Shape::mesh:
      return windingNumber(p, rest_, walls_->triangles) > 0.5;
  }
  return false;
}

double Domain::level_m(double wanted_m3, const Vec3& up) const {
  // Heights of points inside, one per cell of a lattice, shifted within its cell so that no wall
  // or surface runs along a layer of them; the level has the wanted volume below it.
  constexpr int kCells = 80, kMeshCells = 40;
  const int n = def_->domain.shape == Shape::mesh ? kMeshCells : kCells;
  std::vector<double> heights;
  const Vec3 cell = (high_m_ - low_m_) / n;
  const auto part = [](double x) { return x - std::floor(x); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        // fractional parts of multiples of square roots are spread evenly (Weyl)
        const Vec3 shift(part(j * 0.41421356 + k * 0.73205081),
                         part(i * 0.41421356 + k * 0.23606798),
                         part(i * 0.73205081 + j * 0.23606798));
        const Vec3 p = low_m_ + cell.cwiseProduct(Vec3(i, j, k) + shift);
        if (inside(p)) heights.push_back(p.dot(up));
      }
  if (heights.empty()) return 0;
  std::ranges::sort(heights);
  const double at = std::clamp(wanted_m3 / cell.prod(), 0.0, static_cast<double>(heights.size()));
  const auto index = std::min(static_cast<std::size_t>(at), heights.size() - 1);
  return heights[index];
}
}  // namespace swallowclip::verify
