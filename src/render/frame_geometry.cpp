// SPDX-License-Identifier: MIT
#include "render/frame_geometry.h"

#include <meshoptimizer.h>

#include <cmath>

#include "core/digest.h"

namespace swallowclip::render {
namespace {

// Detail finer than this share of a pixel is left out of the meshes.
constexpr float kFinest_px = 0.25f;
constexpr float kPictureHeight_m = 0.172f;  // of the views that show most of the scene

// Fewer triangles over the same vertices, nowhere farther from the mesh than `error_m`.
std::vector<Triangle> simplified(const std::vector<Triangle>& triangles,
                                 const std::vector<Vec3f>& positions, float error_m) {
  if (triangles.empty() || positions.empty() || error_m <= 0) return triangles;
  std::vector<std::uint32_t> indices, kept(3 * triangles.size());
  indices.reserve(kept.size());
  for (const Triangle& t : triangles)
    for (int v : t) indices.push_back(static_cast<std::uint32_t>(v));
  const float* p = positions[0].data();
  const float scale = meshopt_simplifyScale(p, positions.size(), sizeof(Vec3f));
  kept.resize(meshopt_simplify(kept.data(), indices.data(), indices.size(), p, positions.size(),
                               sizeof(Vec3f), 0, error_m / scale, 0, nullptr));
  std::vector<Triangle> out;
  out.reserve(kept.size() / 3);
  for (std::size_t i = 0; i < kept.size(); i += 3)
    out.push_back(
        {static_cast<int>(kept[i]), static_cast<int>(kept[i + 1]), static_cast<int>(kept[i + 2])});
  return out;
}

std::uint64_t digestOf(const std::vector<Vec3f>& v, std::uint64_t d) {
  return stateDigest(v.data(), v.size() * sizeof(Vec3f), d);
}

void add(FrameGeometry& g, Part part, const std::vector<Vertex>& vertices) {
  part.firstVertex = static_cast<int>(g.vertices.size());
  g.vertices.insert(g.vertices.end(), vertices.begin(), vertices.end());
  for (const Vec3f& p : part.positions) part.bounds.add(p);
  g.parts.push_back(std::move(part));
}

LumenWall lumenWall(const frame::SkinTrack& skin, int frame) {
  LumenWall w;
  if (skin.positions.empty()) return w;
  w.positions = skin.positions[frame];
  w.normals.assign(w.positions.size(), Vec3f::Zero());
  for (const Triangle& t : skin.triangles) {
    const Vec3f& a = w.positions[t[0]];
    const Vec3f n = (w.positions[t[1]] - a).cross(w.positions[t[2]] - a);
    for (int v : t) w.normals[v] += n;
  }
  for (Vec3f& n : w.normals) n = n.norm() > 0 ? Vec3f(n.normalized()) : Vec3f(0, 0, 1);
  return w;
}

// A film particle lies on the skin vertex nearest to it.
void setWallNormals(const LumenWall& wall, std::vector<FluidParticle>& film) {
  if (wall.positions.empty()) return;
  for (FluidParticle& f : film) {
    std::size_t best = 0;
    float bestDistance2 = 1e9f;
    for (std::size_t i = 0; i < wall.positions.size(); ++i)
      if (const float d2 = (wall.positions[i] - f.position).squaredNorm(); d2 < bestDistance2) {
        bestDistance2 = d2;
        best = i;
      }
    f.wallNormal = -wall.normals[best];
  }
}

}  // namespace

void addBolus(FrameGeometry& g, const frame::History& h, int frame, const RenderPreset& preset) {
  const frame::BolusTrack& bolus = h.bolus;
  if (bolus.positions.empty()) return;
  std::vector<FluidParticle> particles, film;
  const auto& positions = bolus.positions[frame];
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto state = bolus.state.empty() ? frame::ParticleState::fluid : bolus.state[frame][i];
    if (state == frame::ParticleState::fluid) particles.push_back({positions[i]});
    if (state == frame::ParticleState::film) film.push_back({positions[i]});
  }
  const LumenWall wall = lumenWall(h.skin, frame);
  setWallNormals(wall, film);
  particles.insert(particles.end(), film.begin(), film.end());
  FluidSurfaceDef def;
  if (bolus.particleVolume_m3 > 0) def.spacing_m = std::cbrt(bolus.particleVolume_m3);
  if (h.meta.particleSpacing_m > 0) def.spacing_m = h.meta.particleSpacing_m;
  FluidSurface& s = g.bolus_;
  s = fluidSurface(particles, def);
  keepWithin(s, wall, 1.5 * def.spacing_m);
  if (s.triangles.empty()) return;
  for (const Triangle& t : s.triangles)
    for (int v : t) g.bolusIndices_.push_back(static_cast<std::uint32_t>(v));
  std::vector<Vertex> vertices;
  for (std::size_t i = 0; i < s.positions.size(); ++i)
    vertices.push_back({s.positions[i], s.normals[i], s.positions[i]});
  Part part;
  part.name = "bolus";
  part.material = &preset.bolusFor(h.meta.viscosity_Pas);
  part.closed = true;
  part.indices = g.bolusIndices_;
  part.triangles = s.triangles;
  part.positions = s.positions;
  add(g, std::move(part), vertices);
}

std::vector<Vec3f> positionsAt(const frame::StructureTrack& track, int frame) {
  if (!track.rigid) return track.positions[frame];
  const Eigen::Matrix3f q = track.poses[frame].q.toRotationMatrix().cast<float>();
  const Vec3f t = track.poses[frame].t.cast<float>();
  std::vector<Vec3f> out;
  out.reserve(track.rest.size());
  for (const Vec3f& p : track.rest) out.push_back(q * p + t);
  return out;
}

std::uint64_t topologyDigest(const frame::History& history) {
  std::uint64_t d = history.structures.size();
  for (const frame::StructureTrack& s : history.structures) {
    const auto& first = s.rigid || s.positions.empty() ? s.rest : s.positions[0];
    for (const std::string* word : {&s.name, &s.material})
      d = stateDigest(word->data(), word->size(), d);
    d = stateDigest(s.triangles.data(), s.triangles.size() * sizeof(Triangle), d);
    d = stateDigest(first.data(), first.size() * sizeof(Vec3f), d);
  }
  return d;
}

std::uint64_t frameDigest(const frame::History& h, int frame) {
  const auto f = static_cast<std::size_t>(frame);
  std::uint64_t d = topologyDigest(h) + f;
  for (const frame::StructureTrack& s : h.structures)
    if (s.rigid) {
      d = stateDigest(s.poses[f].q.coeffs().data(), sizeof(double) * 4, d);
      d = stateDigest(s.poses[f].t.data(), sizeof(double) * 3, d);
    } else {
      d = digestOf(s.positions[f], d);
    }
  if (!h.skin.positions.empty()) d = digestOf(h.skin.positions[f], d);
  if (!h.bolus.positions.empty()) d = digestOf(h.bolus.positions[f], d);
  if (!h.bolus.state.empty())
    d = stateDigest(h.bolus.state[f].data(), h.bolus.state[f].size() * sizeof(h.bolus.state[f][0]),
                    d);
  const double bolus[] = {h.bolus.particleVolume_m3, h.meta.particleSpacing_m, h.meta.viscosity_Pas,
                          h.meta.bariumSulfate_kgm3};
  return stateDigest(bolus, sizeof(bolus), d);
}

float unseenDetail_m(int height_px) {
  return kFinest_px * kPictureHeight_m / static_cast<float>(height_px);
}

Prepared prepare(const frame::History& history, double creaseAngle_rad, float error_m) {
  Prepared p;
  p.digest = topologyDigest(history);
  for (const frame::StructureTrack& s : history.structures) {
    const std::vector<Vec3f> first = positionsAt(s, 0);
    p.meshes.push_back(
        buildDrawMesh(simplified(s.triangles, first, error_m), first, creaseAngle_rad));
  }
  return p;
}

FrameGeometry frameGeometry(const frame::History& history, int frame, const Prepared& prepared,
                            const RenderPreset& preset) {
  FrameGeometry g;
  for (std::size_t i = 0; i < history.structures.size(); ++i) {
    const frame::StructureTrack& track = history.structures[i];
    const DrawMesh& mesh = prepared.meshes[i];
    Part part;
    part.name = track.name;
    part.substance = track.material;
    part.material = &preset.materialFor(track.name, track.material);
    part.closed = mesh.closed;
    part.indices = mesh.indices;
    part.triangles = mesh.triangles;
    part.positions = positionsAt(track, frame);
    for (const Vec3f& p : mesh.rest) part.restBounds.add(p);
    const std::vector<Vertex> vertices = drawVertices(mesh, part.positions);
    add(g, std::move(part), vertices);
  }
  addBolus(g, history, frame, preset);
  return g;
}
}  // namespace swallowclip::render
