// SPDX-License-Identifier: MIT
#include "render/draw_list.h"

#include <algorithm>
#include <cmath>

#include "render/body_outline.h"

namespace swallowclip::render {
namespace {

constexpr float kRoomToMove_m = 15e-3f;  // excursion of hyoid and larynx, assumed 10..25 mm
constexpr int kMaxCuts = 3;              // as in shaders/solid.vert
// Sections that overlap in one plane lie as sheets on each other, this far apart: far below a
// pixel, and some hundred steps of the depth buffer.
constexpr float kSheet_m = 5e-6f;
constexpr float kLeastOutline_px = 1.2f;  // thinner ones break up into dots

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

Soup append(DrawList& list, const std::vector<Vertex>& vertices) {
  const Soup s{static_cast<int>(list.extra.size()), static_cast<int>(vertices.size())};
  list.extra.insert(list.extra.end(), vertices.begin(), vertices.end());
  return s;
}

// A rectangle in the plane of a section, with a margin for its outermost pixels.
std::vector<Vertex> coverOf(std::span<const Vec3f> segments, const Vec3f& normal, float lift_m) {
  constexpr float kMargin_m = 1e-3f;
  const Vec3f u = normal.unitOrthogonal(), v = normal.cross(u);
  Bounds box;  // in axes u, v, normal
  for (const Vec3f& p : segments) box.add(Vec3f(u.dot(p), v.dot(p), normal.dot(p)));
  if (box.empty()) return {};
  box.low.array() -= kMargin_m;
  box.high.array() += kMargin_m;
  const float height = 0.5f * (box.low.z() + box.high.z()) + lift_m;
  const auto corner = [&](int k) {
    const Vec3f c = box.corner(k);
    const Vec3f p = u * c.x() + v * c.y() + normal * height;
    return Vertex{p, normal, p};
  };
  return {corner(0), corner(1), corner(3), corner(0), corner(3), corner(2)};
}

// `rank`: sheets below this one.
void addSections(DrawList& list, DrawItem& item, const Part& part, float width, int rank) {
  item.sections.resize(item.cuts.size());
  const float lift = kSheet_m * static_cast<float>(2 * rank);
  for (std::size_t k = 0; k < item.cuts.size(); ++k) {
    const CutPlane& c = item.cuts[k];
    if (!c.cap) continue;
    const auto segments = sectionSegments(part.triangles, part.positions, c.normal, c.offset);
    item.sections[k].fan = append(list, sectionFan(segments, c.normal));
    item.sections[k].cover = append(list, coverOf(segments, c.normal, lift));
    if (width > 0)
      item.sections[k].outline =
          append(list, sectionOutline(segments, c.normal, width, lift + kSheet_m));
  }
}

// Triangles that a cut removes whole need not reach the GPU.
Range keptIndices(DrawList& list, const Part& part, const std::vector<Vertex>& vertices,
                  const std::vector<CutPlane>& cuts) {
  Range r{static_cast<int>(list.indices.size()), 0, part.firstVertex};
  if (cuts.empty()) {
    list.indices.insert(list.indices.end(), part.indices.begin(), part.indices.end());
  } else {
    const auto gone = [&](std::uint32_t i) {  // bit k: beyond cut k
      unsigned bits = 0;
      const Vec3f& p = vertices[static_cast<std::size_t>(part.firstVertex) + i].position;
      for (std::size_t k = 0; k < cuts.size(); ++k)
        if (cuts[k].normal.dot(p) > cuts[k].offset) bits |= 1u << k;
      return bits;
    };
    for (std::size_t i = 0; i < part.indices.size(); i += 3)
      if (!(gone(part.indices[i]) & gone(part.indices[i + 1]) & gone(part.indices[i + 2])))
        list.indices.insert(list.indices.end(), &part.indices[i], &part.indices[i] + 3);
  }
  r.count = static_cast<int>(list.indices.size()) - r.firstIndex;
  return r;
}

void addPart(DrawList& list, const Part& part, const std::vector<Vertex>& vertices,
             const ViewDef& view) {
  DrawItem item;
  item.name = part.name;
  item.substance = part.substance;
  item.material = part.material;
  item.opacity = part.material->opacity;
  if (auto it = view.ghosted.find(part.name); it != view.ghosted.end()) item.opacity = it->second;
  if (item.opacity <= 0 || contains(view.hidden, part.name)) return;
  item.bounds = part.bounds;
  if (item.bounds.empty() || !cutItem(item, view)) return;
  item.closed = part.closed && capped(item);
  item.mesh = keptIndices(list, part, vertices, item.cuts);
  list.bounds.add(item.bounds);
  if (!part.restBounds.empty()) list.restBounds.add(part.restBounds);
  (item.opacity < 1 ? list.ghost : list.solid).push_back(std::move(item));
}

// The lumen's air, and the skin of head and neck: whole, seen by X-rays only.
void addFluoroscopy(DrawList& list, const frame::History& h, int frame, const RenderPreset& preset,
                    const ViewDef& view) {
  const auto add = [&](const char* name, std::span<const Triangle> triangles,
                       std::span<const Vec3f> positions) {
    DrawItem item;
    item.name = name;
    std::vector<Vertex> vertices;
    vertices.reserve(3 * triangles.size());
    for (const Triangle& t : triangles)
      for (int v : t)  // lengths need no normals
        vertices.push_back({positions[v], Vec3f::Zero(), positions[v]});
    for (const Vec3f& p : positions) item.bounds.add(p);
    list.bounds.add(item.bounds);
    item.skin = append(list, vertices);
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

// Metres that a pixel spans about the middle of what is shown.
float pixelSize_m(const ViewDef& view, const RenderPreset& preset) {
  const double height =
      view.projection == Projection::orthographic
          ? view.orthoHeight_m
          : 2 * std::tan(0.5 * view.fovY_rad) * (view.eye_m - view.target_m).norm();
  return static_cast<float>(height) / static_cast<float>(preset.height);
}
}  // namespace

DrawList buildDrawList(const frame::History& history, int frame, const FrameGeometry& geometry,
                       const RenderPreset& preset, const ViewDef& view) {
  DrawList list;
  for (const Part& part : geometry.parts) addPart(list, part, geometry.vertices, view);
  const auto priority = [&](const DrawItem& a) {
    const auto& order = preset.sectionPriority;
    return std::pair(a.name == "bolus", std::find(order.begin(), order.end(), a.name));
  };
  std::stable_sort(list.solid.begin(), list.solid.end(),
                   [&](const DrawItem& a, const DrawItem& b) { return priority(a) < priority(b); });
  const auto partOf = [&](const DrawItem& item) -> const Part& {
    return *std::find_if(geometry.parts.begin(), geometry.parts.end(),
                         [&](const Part& p) { return p.name == item.name; });
  };
  const float outline_m =
      preset.sectionOutline_m > 0
          ? std::max(preset.sectionOutline_m, kLeastOutline_px * pixelSize_m(view, preset))
          : 0.0f;
  int rank = static_cast<int>(list.solid.size() + list.ghost.size());
  for (auto* items : {&list.solid, &list.ghost})
    for (DrawItem& item : *items) addSections(list, item, partOf(item), outline_m, --rank);
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
