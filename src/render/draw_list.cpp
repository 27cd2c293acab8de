// SPDX-License-Identifier: MIT
#include "render/draw_list.h"

#include <algorithm>
#include <cmath>

#include "core/digest.h"
#include "render/body_outline.h"
#include "render/fluid_surface.h"

namespace swallowclip::render {
namespace {

constexpr float kRoomToMove_m = 15e-3f;  // excursion of hyoid and larynx, assumed 10..25 mm
constexpr int kMaxCuts = 3;              // as in shaders/solid.vert

bool contains(const std::vector<std::string>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

// An empty `only` means every structure, but the bolus is cut only where it is named.
bool applies(const ClipRule& rule, const std::string& name) {
  if (contains(rule.except, name)) return false;
  if (name == "bolus") return contains(rule.only, name);
  return rule.only.empty() || contains(rule.only, name);
}

enum class CutResult { whole, cut, gone };

CutResult side(const Bounds& b, const CutPlane& plane) {
  int removed = 0;
  for (int i = 0; i < 8; ++i) removed += plane.normal.dot(b.corner(i)) > plane.offset;
  return removed == 0 ? CutResult::whole : removed == 8 ? CutResult::gone : CutResult::cut;
}

// False when nothing of the item is left.
bool cutItem(DrawItem& item, const ViewDef& view) {
  for (const ClipRule& rule : view.cuts) {
    if (!applies(rule, item.name)) continue;
    const double length = rule.normal.norm();
    const CutPlane plane{(rule.normal / length).cast<float>(),
                         static_cast<float>(rule.offset_m / length), rule.cap};
    const CutResult result = side(item.bounds, plane);
    if (result == CutResult::gone) return false;
    if (result == CutResult::cut && static_cast<int>(item.cuts.size()) < kMaxCuts)
      item.cuts.push_back(plane);
  }
  return true;
}

bool capped(const DrawItem& item) {
  return std::all_of(item.cuts.begin(), item.cuts.end(), [](const CutPlane& c) { return c.cap; });
}

Range append(DrawList& list, const std::vector<Vertex>& vertices,
             const std::vector<std::uint32_t>& indices) {
  const Range r{static_cast<int>(list.indices.size()), static_cast<int>(indices.size()),
                static_cast<int>(list.vertices.size())};
  list.vertices.insert(list.vertices.end(), vertices.begin(), vertices.end());
  list.indices.insert(list.indices.end(), indices.begin(), indices.end());
  return r;
}

std::vector<std::uint32_t> corners(std::span<const Triangle> triangles) {
  std::vector<std::uint32_t> indices;
  indices.reserve(3 * triangles.size());
  for (const Triangle& t : triangles)
    for (int v : t) indices.push_back(static_cast<std::uint32_t>(v));
  return indices;
}

Range appendSoup(DrawList& list, const std::vector<Vertex>& vertices) {
  std::vector<std::uint32_t> indices(vertices.size());
  for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<std::uint32_t>(i);
  return append(list, vertices, indices);
}

void addSections(DrawList& list, DrawItem& item, const std::vector<Triangle>& triangles,
                 const std::vector<Vec3f>& positions, float width) {
  item.fans.resize(item.cuts.size());
  item.outlines.resize(item.cuts.size());
  item.fanBounds.resize(item.cuts.size());
  for (std::size_t k = 0; k < item.cuts.size(); ++k) {
    const CutPlane& c = item.cuts[k];
    if (!c.cap) continue;
    const auto segments = sectionSegments(triangles, positions, c.normal, c.offset);
    for (const Vec3f& p : segments) item.fanBounds[k].add(p);
    item.fans[k] = appendSoup(list, sectionFan(segments, c.normal));
    // the lift keeps ribbons in front of caps at any view angle, and is far below a pixel
    if (width > 0)
      item.outlines[k] = appendSoup(list, sectionOutline(segments, c.normal, width, 0.1e-3f));
  }
}

// Triangles that a cut removes whole need not reach the GPU.
std::vector<std::uint32_t> keptIndices(const std::vector<std::uint32_t>& indices,
                                       const std::vector<Vertex>& vertices,
                                       const std::vector<CutPlane>& cuts) {
  if (cuts.empty()) return indices;
  std::vector<std::uint8_t> gone(vertices.size());  // bit k: beyond cut k
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t k = 0; k < cuts.size(); ++k)
      if (cuts[k].normal.dot(vertices[i].position) > cuts[k].offset) gone[i] |= 1u << k;
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < indices.size(); i += 3)
    if (!(gone[indices[i]] & gone[indices[i + 1]] & gone[indices[i + 2]]))
      kept.insert(kept.end(), {indices[i], indices[i + 1], indices[i + 2]});
  return kept;
}

void addStructure(DrawList& list, const frame::StructureTrack& track, int frame,
                  const DrawMesh& mesh, const RenderPreset& preset, const ViewDef& view) {
  DrawItem item;
  item.name = track.name;
  item.substance = track.material;
  item.material = &preset.materialFor(track.name, track.material);
  item.opacity = item.material->opacity;
  if (auto it = view.ghosted.find(track.name); it != view.ghosted.end()) item.opacity = it->second;
  if (item.opacity <= 0 || contains(view.hidden, track.name)) return;
  const std::vector<Vec3f> positions = positionsAt(track, frame);
  for (const Vec3f& p : positions) item.bounds.add(p);
  if (item.bounds.empty() || !cutItem(item, view)) return;
  item.closed = mesh.closed && capped(item);
  const std::vector<Vertex> vertices = drawVertices(mesh, positions);
  item.mesh = append(list, vertices, keptIndices(mesh.indices, vertices, item.cuts));
  addSections(list, item, track.triangles, positions, preset.sectionOutline_m);
  list.bounds.add(item.bounds);
  for (const Vec3f& p : mesh.rest) list.restBounds.add(p);
  (item.opacity < 1 ? list.ghost : list.solid).push_back(std::move(item));
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

void addBolus(DrawList& list, const frame::History& h, int frame, const RenderPreset& preset,
              const ViewDef& view) {
  const frame::BolusTrack& bolus = h.bolus;
  if (bolus.positions.empty() || contains(view.hidden, "bolus")) return;
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
  FluidSurface s = fluidSurface(particles, def);
  keepWithin(s, wall, 1.5 * def.spacing_m);
  if (s.triangles.empty()) return;
  DrawItem item;
  item.name = "bolus";
  item.material = &preset.bolusFor(h.meta.viscosity_Pas);
  item.opacity = item.material->opacity;
  std::vector<Vertex> vertices;
  for (std::size_t i = 0; i < s.positions.size(); ++i) {
    vertices.push_back({s.positions[i], s.normals[i], s.positions[i]});
    item.bounds.add(s.positions[i]);
  }
  if (!cutItem(item, view)) return;
  item.closed = capped(item);
  item.mesh = append(list, vertices, keptIndices(corners(s.triangles), vertices, item.cuts));
  addSections(list, item, s.triangles, s.positions, preset.sectionOutline_m);
  list.bounds.add(item.bounds);
  list.solid.push_back(std::move(item));
}
// The lumen's air, and the skin of head and neck: whole, seen by X-rays only.
void addFluoroscopy(DrawList& list, const frame::History& h, int frame, const RenderPreset& preset,
                    const ViewDef& view) {
  const auto add = [&](const char* name, std::span<const Triangle> triangles,
                       std::span<const Vec3f> positions) {
    DrawItem item;
    item.name = name;
    std::vector<Vertex> vertices;
    for (const Vec3f& p : positions) {
      vertices.push_back({p, Vec3f::Zero(), p});  // lengths need no normals
      list.bounds.add(p);
    }
    item.mesh = append(list, vertices, corners(triangles));
    return item;
  };
  list.referenceDepth = view.referenceDepth;
  list.barium_kgm3 = h.meta.bariumSulfate_kgm3;
  if (!preset.fluoro.body) return;
  if (!h.skin.positions.empty())
    list.air.push_back(add("lumen", h.skin.triangles, h.skin.positions[frame]));
  const ClosedSurface body = bodyOutline();
  list.body.push_back(add("body", body.triangles, body.positions));
}
}  // namespace

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
    d = stateDigest(s.triangles.data(), s.triangles.size() * sizeof(Triangle), d);
    d = stateDigest(first.data(), first.size() * sizeof(Vec3f), d);
  }
  return d;
}

Prepared prepare(const frame::History& history, double creaseAngle_rad) {
  Prepared p;
  p.digest = topologyDigest(history);
  for (const frame::StructureTrack& s : history.structures)
    p.meshes.push_back(buildDrawMesh(s.triangles, positionsAt(s, 0), creaseAngle_rad));
  return p;
}

DrawList buildDrawList(const frame::History& history, int frame, const Prepared& prepared,
                       const RenderPreset& preset, const ViewDef& view) {
  DrawList list;
  for (std::size_t i = 0; i < history.structures.size(); ++i)
    addStructure(list, history.structures[i], frame, prepared.meshes[i], preset, view);
  const auto priority = [&](const DrawItem& a) {
    const auto& order = preset.sectionPriority;
    return std::find(order.begin(), order.end(), a.name) - order.begin();
  };
  std::stable_sort(list.solid.begin(), list.solid.end(),
                   [&](const DrawItem& a, const DrawItem& b) { return priority(a) < priority(b); });
  const Vec3f back = (view.eye_m - view.target_m).normalized().cast<float>();
  const auto depth = [&](const DrawItem& a) {
    const Vec3f& rest = list.vertices[a.mesh.firstVertex].rest;
    return std::pair(std::round(back.dot(rest) * 1e4f), a.name);
  };
  std::sort(list.ghost.begin(), list.ghost.end(),
            [&](const DrawItem& a, const DrawItem& b) { return depth(a) < depth(b); });
  addBolus(list, history, frame, preset, view);
  if (view.style == Style::fluoro) addFluoroscopy(list, history, frame, preset, view);
  if (list.restBounds.empty()) list.restBounds = list.bounds;
  if (!list.bounds.empty()) {
    list.restBounds.low.array() -= kRoomToMove_m;
    list.restBounds.high.array() += kRoomToMove_m;
    list.bounds.add(list.restBounds);
  }
  return list;
}

std::vector<int> nearestFirst(const std::vector<DrawItem>& items, const Vec3f& back) {
  std::vector<std::pair<float, int>> order;
  for (std::size_t i = 0; i < items.size(); ++i) {
    float depth = 1e9f;
    for (int k = 0; k < 8; ++k) depth = std::min(depth, -back.dot(items[i].bounds.corner(k)));
    order.emplace_back(depth, static_cast<int>(i));
  }
  std::sort(order.begin(), order.end());
  std::vector<int> indices;
  for (const auto& [depth, index] : order) indices.push_back(index);
  return indices;
}
}  // namespace swallowclip::render
