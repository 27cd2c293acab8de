// SPDX-License-Identifier: MIT
#include "render/fluid_surface.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

namespace swallowclip::render {
namespace {

// All lengths in units of the particle spacing dx.
constexpr float kSupport = 1.9f;     // blob support radius; assumed 1.6..2.2
constexpr float kBulkSum = 4.38f;    // sum of blobs in a full lattice: kSupport^3 * 4 pi 16/315
constexpr float kMaxStretch = 2.5f;  // longest over shortest blob axis; Yu & Turk 2013 use 4
constexpr float kPrior = 2.0f;  // weight of "round" against the neighbours' shape; assumed 1..4

using Grid3 = Eigen::Vector3i;

float blob(float q2) {
  const float f = 1 - q2;
  return q2 < 1 ? f * f * f : 0;
}

struct Blob {
  Vec3f centre;
  Eigen::Matrix3f toUnit;  ///< maps the support ellipsoid to the unit ball
  Vec3f reach;             ///< half sizes of its box
  float amplitude;
};

std::int64_t cellKey(const Grid3& c) {
  const auto part = [](int v) { return static_cast<std::int64_t>(v + (1 << 20)); };
  return part(c.x()) | part(c.y()) << 21 | part(c.z()) << 42;
}

// Particles by cells of one neighbour radius, in particle order.
class Neighbours {
 public:
  Neighbours(const std::vector<Vec3f>& p, float radius) : p_(p), radius_(radius) {
    for (std::size_t i = 0; i < p.size(); ++i)
      cells_[cellKey(cell(p[i]))].push_back(static_cast<int>(i));
  }
  template <class F>
  void around(const Vec3f& x, F&& f) const {
    const Grid3 c = cell(x);
    for (int k = 0; k < 27; ++k) {
      const auto it = cells_.find(cellKey(c + Grid3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)));
      if (it == cells_.end()) continue;
      for (int j : it->second) {
        const float d2 = (p_[j] - x).squaredNorm();
        if (d2 < radius_ * radius_) f(j, d2);
      }
    }
  }

 private:
  Grid3 cell(const Vec3f& x) const { return (x / radius_).array().floor().cast<int>(); }
  const std::vector<Vec3f>& p_;
  float radius_;
  std::map<std::int64_t, std::vector<int>> cells_;
};

// Axes of a flat disc on a wall.
Blob filmBlob(const Vec3f& centre, const Vec3f& normal, float thickness, const Neighbours& near) {
  // A sheet's surface lies at 0.47 of its support: (1 - q^2)^3 = level 0.42 / 0.9. With this reach
  // a lone disc has the volume of its particle.
  const float reach = 1.2f * kSupport;
  const Vec3f radii(thickness / 0.47f, reach, reach);
  const Vec3f t = normal.unitOrthogonal();
  Eigen::Matrix3f axes;
  axes << normal, t, normal.cross(t);
  Blob b;
  b.centre = centre;
  b.toUnit = radii.cwiseInverse().asDiagonal() * axes.transpose();
  b.reach = (axes * radii.asDiagonal()).rowwise().norm();
  float crowd = 0;  // discs that overlap share their height: a sheet is as thin as one disc
  near.around(centre, [&](int, float d2) { crowd += blob(d2 / (reach * reach)); });
  b.amplitude = 0.9f / crowd;
  return b;
}

Blob freeBlob(int i, const std::vector<Vec3f>& p, const Neighbours& near, float smoothing) {
  const float radius2 = 4 * kSupport * kSupport * 0.8f;
  Vec3f mean = Vec3f::Zero();
  float weight = 0, crowd = 0;
  near.around(p[i], [&](int j, float d2) {
    const float w = blob(d2 / radius2);
    mean += w * p[j];
    weight += w;
    crowd += blob(d2 / (kSupport * kSupport));
  });
  mean /= weight;  // the particle itself counts, so weight >= 1
  // the prior is the covariance of a full neighbourhood, so that bulk stays round
  const float roundness = 0.11f * radius2;
  Eigen::Matrix3f c = kPrior * roundness * Eigen::Matrix3f::Identity();
  near.around(p[i], [&](int j, float d2) {
    const Vec3f d = p[j] - mean;
    c += blob(d2 / radius2) * d * d.transpose();
  });
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(c);
  Vec3f radii = solver.eigenvalues().cwiseMax(1e-6f).cwiseSqrt();
  radii = radii.cwiseMax(radii.maxCoeff() / kMaxStretch);
  radii *= kSupport / std::cbrt(radii.prod());  // stretching keeps the blob's volume
  const Eigen::Matrix3f axes = solver.eigenvectors();
  Blob b;
  b.centre = p[i] + smoothing * std::min(1.0f, (weight - 1) / 3) * (mean - p[i]);
  b.toUnit = radii.cwiseInverse().asDiagonal() * axes.transpose();
  b.reach = (axes * radii.asDiagonal()).rowwise().norm();
  b.amplitude = 1 / std::max(0.85f * kBulkSum, std::min(crowd, kBulkSum));
  // a lone drop must not vanish: its own centre alone reaches past the level
  b.amplitude = std::max(b.amplitude, 0.75f / crowd);
  return b;
}

struct Field {
  Vec3f origin;
  Grid3 n;
  float cell = 0.5f;
  std::vector<float> value;

  int index(int x, int y, int z) const { return x + n.x() * (y + n.y() * z); }
  float sample(const Vec3f& p) const {
    const Vec3f g = (p - origin) / cell;
    const Grid3 i = g.array().floor().cast<int>().max(0).min(n.array() - 2);
    const Vec3f f = g - i.cast<float>();
    float sum = 0;
    for (int k = 0; k < 8; ++k) {
      const int x = k & 1, y = k >> 1 & 1, z = k >> 2;
      sum += (x ? f.x() : 1 - f.x()) * (y ? f.y() : 1 - f.y()) * (z ? f.z() : 1 - f.z()) *
             value[index(i.x() + x, i.y() + y, i.z() + z)];
    }
    return sum;
  }
};

// The grid is a part of one lattice fixed in space: no crawling from frame to frame.
Field splat(const std::vector<Blob>& blobs, float cell) {
  Vec3f low = Vec3f::Constant(1e9f), high = Vec3f::Constant(-1e9f);
  for (const Blob& b : blobs) {
    low = low.cwiseMin(b.centre - b.reach);
    high = high.cwiseMax(b.centre + b.reach);
  }
  Field f;
  f.cell = cell;
  const Grid3 first = (low / cell).array().floor().cast<int>() - 1;
  const Grid3 last = (high / cell).array().ceil().cast<int>() + 1;
  f.n = last - first + Grid3::Ones();
  f.origin = first.cast<float>() * cell;
  f.value.assign(static_cast<std::size_t>(f.n.prod()), 0.0f);
  for (const Blob& b : blobs) {
    const Grid3 from = ((b.centre - b.reach - f.origin) / cell).array().ceil().cast<int>();
    const Grid3 to = ((b.centre + b.reach - f.origin) / cell).array().floor().cast<int>();
    const Vec3f step = b.toUnit.col(0) * cell;
    for (int z = from.z(); z <= to.z(); ++z)
      for (int y = from.y(); y <= to.y(); ++y) {
        Vec3f q = b.toUnit * (f.origin + cell * Vec3f(from.x(), y, z) - b.centre);
        float* v = &f.value[f.index(from.x(), y, z)];
        for (int x = from.x(); x <= to.x(); ++x, q += step, ++v)
          *v += b.amplitude * blob(q.squaredNorm());
      }
  }
  return f;
}

// One vertex per cell that the surface crosses, at the mean of its edge crossings.
std::vector<int> placeVertices(const Field& f, float level, std::vector<Vec3f>& out) {
  std::vector<int> vertexOf(f.value.size(), -1);
  for (int z = 0; z + 1 < f.n.z(); ++z)
    for (int y = 0; y + 1 < f.n.y(); ++y)
      for (int x = 0; x + 1 < f.n.x(); ++x) {
        float v[8];
        int inside = 0;
        for (int k = 0; k < 8; ++k) {
          v[k] = f.value[f.index(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2))] - level;
          inside += v[k] > 0;
        }
        if (inside == 0 || inside == 8) continue;
        Vec3f sum = Vec3f::Zero();
        int crossings = 0;
        for (int a = 0; a < 8; ++a)
          for (int axis = 0; axis < 3; ++axis) {
            const int b = a | 1 << axis;
            if (b == a || (v[a] > 0) == (v[b] > 0)) continue;
            Vec3f p(static_cast<float>(a & 1), static_cast<float>(a >> 1 & 1),
                    static_cast<float>(a >> 2));
            p[axis] = v[a] / (v[a] - v[b]);
            sum += p;
            ++crossings;
          }
        vertexOf[f.index(x, y, z)] = static_cast<int>(out.size());
        out.push_back(f.origin + f.cell * (Vec3f(x, y, z) + sum / static_cast<float>(crossings)));
      }
  return vertexOf;
}

// A quad around every grid edge that the surface crosses, facing out of the fluid.
void joinVertices(const Field& f, float level, const std::vector<int>& vertexOf,
                  std::vector<Triangle>& out) {
  const Grid3 step[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int z = 1; z + 1 < f.n.z(); ++z)
    for (int y = 1; y + 1 < f.n.y(); ++y)
      for (int x = 1; x + 1 < f.n.x(); ++x)
        for (int axis = 0; axis < 3; ++axis) {
          const Grid3 p(x, y, z), q = p + step[axis];
          const bool in = f.value[f.index(x, y, z)] > level;
          if (in == (f.value[f.index(q.x(), q.y(), q.z())] > level)) continue;
          const Grid3 u = step[(axis + 1) % 3], w = step[(axis + 2) % 3];
          const auto at = [&](const Grid3& c) { return vertexOf[f.index(c.x(), c.y(), c.z())]; };
          int a = at(p - u - w), b = at(p - w), c = at(p), d = at(p - u);
          if (!in) std::swap(b, d);
          out.push_back({a, b, c});
          out.push_back({a, c, d});
        }
}
}  // namespace

FluidSurface fluidSurface(std::span<const FluidParticle> particles, const FluidSurfaceDef& def) {
  FluidSurface s;
  if (particles.empty()) return s;
  const float dx = static_cast<float>(def.spacing_m);
  std::vector<Vec3f> p;
  for (const FluidParticle& a : particles) p.push_back(a.position / dx);
  const Neighbours near(p, 2 * kSupport * 0.9f);
  std::vector<Blob> blobs;
  for (std::size_t i = 0; i < p.size(); ++i)
    blobs.push_back(
        particles[i].wallNormal.squaredNorm() > 0.5f
            ? filmBlob(p[i], particles[i].wallNormal, static_cast<float>(def.filmThickness), near)
            : freeBlob(static_cast<int>(i), p, near, static_cast<float>(def.smoothing)));
  const float level = static_cast<float>(def.level);
  const Field field = splat(blobs, static_cast<float>(def.cell));
  const std::vector<int> vertexOf = placeVertices(field, level, s.positions);
  joinVertices(field, level, vertexOf, s.triangles);
  s.normals.reserve(s.positions.size());
  for (Vec3f& x : s.positions) {
    Vec3f g;
    for (int k = 0; k < 3; ++k) {
      const Vec3f e = Vec3f::Unit(k) * field.cell;
      g[k] = field.sample(x - e) - field.sample(x + e);
    }
    s.normals.push_back(g.squaredNorm() > 0 ? g.normalized() : Vec3f(0, 0, 1));
    x *= dx;
  }
  return s;
}

void keepWithin(FluidSurface& s, const LumenWall& wall, double reach_m) {
  constexpr float kAside2_m2 = 1.5e-3f * 1.5e-3f;  // farther aside than a skin edge: another place
  constexpr float kClosedGap_m =
      0.4e-3f;  // sheets this near count as one; the scene closes to less
  const float reach = static_cast<float>(reach_m);
  const Neighbours near(wall.positions, reach);
  for (Vec3f& x : s.positions) {
    float outside2 = reach * reach, inside = reach;
    int through = -1;
    near.around(x, [&](int j, float d2) {
      const float height = wall.normals[j].dot(x - wall.positions[j]);
      if (d2 - height * height > kAside2_m2) return;
      if (height < 0)
        inside = std::min(inside, -height);
      else if (d2 < outside2)
        outside2 = d2, through = j;
    });
    if (through < 0 || std::sqrt(outside2) > inside + kClosedGap_m) continue;
    x -= wall.normals[through].dot(x - wall.positions[through]) * wall.normals[through];
  }
}
}  // namespace swallowclip::render
