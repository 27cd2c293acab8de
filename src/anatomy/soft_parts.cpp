// SPDX-License-Identifier: MIT
#include "anatomy/soft_parts.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.h"

namespace swallowclip::anatomy {
namespace {
constexpr double kFloorRise_m = 12e-3, kFloorFall_m = 22e-3;  // floor of the mouth, assumed
// Where volume makes the floor go: down between mandible and hyoid. Away from the dorsum instead it
// would run forward, into the symphysis. Assumed (0 to 20 degrees backwards).
const Vec3 kSag = Vec3(0, 0.17, -1).normalized();
constexpr double kFoldCover_m = 3e-4;                  // assumed, 0.2-0.5 mm
constexpr double kFoldsFrom = 0.52, kFoldsTo = 0.595;  // of the vocal folds in the inlet's depth
constexpr int kUnderside = 11;  // vertices from the tongue's lateral edge round to the other one

// Closed tube over `stations` rings of `ring` vertices, the first `top` of which run from right to
// left over the upper face. Ends are zipped between upper and lower face, so no vertex is added.
std::vector<Triangle> tubeTriangles(int stations, int ring, int top, bool flip) {
  std::vector<Triangle> t;
  const auto add = [&](int a, int b, int c) {
    t.push_back(flip ? Triangle{a, c, b} : Triangle{a, b, c});
  };
  const auto at = [&](int i, int j) { return i * ring + (j % ring + ring) % ring; };
  for (int i = 0; i + 1 < stations; ++i)
    for (int j = 0; j < ring; ++j) {
      add(at(i, j), at(i, j + 1), at(i + 1, j));
      add(at(i + 1, j), at(i, j + 1), at(i + 1, j + 1));
    }
  const int bottom = ring - top;
  for (int i : {0, stations - 1}) {
    const auto cap = [&](int a, int b, int c) { i == 0 ? add(a, c, b) : add(a, b, c); };
    int u = 0, l = 0;  // steps taken along the upper and the lower chain
    while (u < top - 1 || l < bottom - 1) {
      const bool upper =
          l == bottom - 1 || (u < top - 1 && (u + 1) * (bottom - 1) <= (l + 1) * (top - 1));
      const int a = at(i, u), b = at(i, ring - 1 - l);
      if (upper) {
        cap(a, at(i, u + 1), b);
        ++u;
      } else {
        cap(a, at(i, ring - 2 - l), b);
        ++l;
      }
    }
  }
  return t;
}
}  // namespace

SoftParts::SoftParts(const Lumen& lumen, SoftDef def) : lumen_(lumen), def_(std::move(def)) {
  const LumenSheets rest = lumen_.evaluate(lumen_.neutralPose());
  const SoftPose still;
  const int nc = lumen_.columns();
  // Scale rule of the thesis: the breadth of the tongue is 51.9 mm.
  for (int pass = 0; pass < 20; ++pass) {
    double half = 0;
    for (const Vec3& p : tongue(rest, still, 0)) half = std::max(half, p.x());
    widthScale_ *= def_.tongueBreadth_m / 2 / half;
  }
  const int tongueRows = lumen_.rowAt(lumen_.def().tongueEnd_m) + 1;
  structures_.push_back(
      {"tongue",
       "muscle",
       false,
       Carrier::skull,
       false,
       {tongue(rest, still, 0), tubeTriangles(tongueRows, nc + kUnderside, nc, false)}});
  tongueVolume_m3_ = volume(structures_.back().mesh);
  const int velumRows = lumen_.port().firstRow - lumen_.rowAt(lumen_.def().velumStart_m) + 1;
  structures_.push_back({"soft_palate",
                         "mucosa",
                         false,
                         Carrier::skull,
                         false,
                         {velum(rest), tubeTriangles(velumRows, 2 * nc, nc, true)}});
  const auto wall = [this](WallId w) {
    return [this, w](const Triangle& t) { return ofWall(t, w); };
  };
  addShell("pharyngeal_wall", "muscle", {{}, {}, def_.wallThickness_m}, wall(WallId::posterior));
  addShell("larynx_mucosa", "mucosa", {{}, {}, def_.mucosaThickness_m}, wall(WallId::larynx));
  addShell("esophagus", "muscle", {{}, {}, def_.wallThickness_m}, wall(WallId::esophagus));
  // a pale band on the mucosa, so thin that shut folds still look shut
  addShell("vocal_folds", "mucosa", {{}, {}, kFoldCover_m, kFoldCover_m},
           [this](const Triangle& t) {
             return std::all_of(t.begin(), t.end(), [this](int v) {
               const double depth = lumen_.inletDepth(v);
               return depth >= kFoldsFrom && depth <= kFoldsTo;
             });
           });
  const std::vector<Vec3> skin = lumen_.skinPositions(rest);
  for (std::size_t i = 0; i < shells_.size(); ++i)
    structures_[2 + i].mesh.positions = shell(shells_[i], skin);
}

std::vector<Vec3> SoftParts::tongue(const LumenSheets& sheets, const SoftPose& pose,
                                    double bulge_m) const {
  const int nc = lumen_.columns(), last = lumen_.rowAt(lumen_.def().tongueEnd_m);
  std::vector<Vec3> p;
  p.reserve(static_cast<std::size_t>(last + 1) * (nc + kUnderside));
  for (int r = 0; r <= last; ++r) {
    const double at = lumen_.s(r);
    const Vec3 top = sheets.m[lumen_.index(r, nc / 2)];
    Vec3 floor(0, def_.tongueFloorY(at), def_.tongueFloorZ(at));
    floor += pose.hyoidShift_m * smoothstep((at - 0.005) / 0.085);
    const double free = smoothstep(at / 0.045) * (1 - smoothstep((at - 0.080) / 0.024));
    floor += bulge_m * free * kSag;
    const Vec3 down = (floor - top).normalized();
    for (int c = 0; c < nc; ++c) p.push_back(sheets.m[lumen_.index(r, c)]);
    const double half = widthScale_ * def_.tongueHalfWidth(at);
    for (int k = 1; k <= kUnderside; ++k) {
      // cubic Bezier from the lateral edge over the side to the midline, then mirrored
      const double side = k <= (kUnderside + 1) / 2 ? 1 : -1;
      const double x = 2.0 * k / (kUnderside + 1);
      const double t = side > 0 ? x : 2 - x;
      const Vec3 edge = sheets.m[lumen_.index(r, side > 0 ? nc - 1 : 0)];
      const double height = (floor - edge).dot(down);
      Vec3 p1 = edge + down * 0.25 * height, p2 = edge + down * 0.85 * height;
      p1.x() = side * half * 1.12;
      p2.x() = side * half * 0.9;
      const double q = 1 - t;
      Vec3 b = q * q * q * edge + 3 * q * q * t * p1 + 3 * q * t * t * p2 + t * t * t * floor;
      if (2 * k == kUnderside + 1) b.x() = 0;
      p.push_back(b);
    }
  }
  return p;
}

std::vector<Vec3> SoftParts::keepVolume(const LumenSheets& sheets, const SoftPose& pose) const {
  // Volume grows almost linearly with the bulge: a few secant steps reach 0.01 %.
  const std::vector<Triangle>& t = structures_.front().mesh.triangles;
  double b0 = 0, b1 = 1e-3;
  std::vector<Vec3> p = tongue(sheets, pose, b0);
  double v0 = volume(p, t) - tongueVolume_m3_;
  for (int i = 0; i < 6 && std::abs(v0) > 1e-4 * tongueVolume_m3_; ++i) {
    p = tongue(sheets, pose, b1);
    const double v1 = volume(p, t) - tongueVolume_m3_;
    if (v1 == v0) break;
    const double next = std::clamp(b1 - v1 * (b1 - b0) / (v1 - v0), -kFloorRise_m, kFloorFall_m);
    b0 = b1;
    v0 = v1;
    b1 = next;
  }
  return p;
}

std::vector<Vec3> SoftParts::velum(const LumenSheets& sheets) const {
  const int nc = lumen_.columns();
  std::vector<Vec3> p;
  for (int r = lumen_.rowAt(lumen_.def().velumStart_m); r <= lumen_.port().firstRow; ++r) {
    for (int c = 0; c < nc; ++c) p.push_back(sheets.f[lumen_.index(r, c)]);
    for (int c = nc - 1; c >= 0; --c) p.push_back(sheets.velumTop[lumen_.index(r, c)]);
  }
  return p;
}

bool SoftParts::ofWall(const Triangle& t, WallId wall) const {
  int own = 0, posterior = 0;
  for (int v : t) {
    own += lumen_.skin().wall[v] == static_cast<std::uint8_t>(wall);
    posterior += lumen_.skin().wall[v] == static_cast<std::uint8_t>(WallId::posterior);
  }
  if (wall == WallId::posterior) return own == 3;
  if (wall == WallId::larynx) return own > 0 && own + posterior == 3;
  return own > 0;
}

void SoftParts::addShell(const std::string& name, const std::string& material, Shell s,
                         const std::function<bool(const Triangle&)>& belongs) {
  std::map<int, int> local;
  for (const Triangle& t : lumen_.skin().triangles) {
    if (!belongs(t)) continue;
    Triangle mapped;
    for (int k = 0; k < 3; ++k) {
      const auto [it, fresh] = local.try_emplace(t[k], static_cast<int>(local.size()));
      if (fresh) s.skinVertices.push_back(t[k]);
      mapped[k] = it->second;
    }
    s.inner.push_back(mapped);
  }
  // The face to the lumen looks the other way than the skin; the outer face as the skin does.
  const int n = static_cast<int>(s.skinVertices.size());
  std::vector<Triangle> all;
  std::map<std::pair<int, int>, int> halfEdges;
  for (const Triangle& t : s.inner) {
    all.push_back({t[0], t[2], t[1]});
    all.push_back({t[0] + n, t[1] + n, t[2] + n});
    for (int k = 0; k < 3; ++k) ++halfEdges[{t[k], t[(k + 1) % 3]}];
  }
  for (const auto& [e, count] : halfEdges)
    if (!halfEdges.contains({e.second, e.first})) {
      all.push_back({e.first, e.second, e.first + n});
      all.push_back({e.second, e.second + n, e.first + n});
    }
  structures_.push_back({name, material, false, Carrier::skull, false, {{}, std::move(all)}});
  shells_.push_back(std::move(s));
}

std::vector<Vec3> SoftParts::shell(const Shell& s, const std::vector<Vec3>& skin) const {
  std::vector<Vec3> p;
  for (int v : s.skinVertices) p.push_back(skin[v]);
  const std::vector<Vec3> n = vertexNormals(p, s.inner);
  const std::size_t count = p.size();
  for (std::size_t i = 0; i < count; ++i) p.push_back(p[i] + s.thickness_m * n[i]);
  for (std::size_t i = 0; i < count; ++i) p[i] -= s.lift_m * n[i];
  return p;
}

std::vector<std::vector<Vec3>> SoftParts::positions(const LumenSheets& sheets,
                                                    const SoftPose& pose) const {
  const std::vector<Vec3> skin = lumen_.skinPositions(sheets);
  std::vector<std::vector<Vec3>> all{keepVolume(sheets, pose), velum(sheets)};
  for (const Shell& s : shells_) all.push_back(shell(s, skin));
  return all;
}
}  // namespace swallowclip::anatomy
