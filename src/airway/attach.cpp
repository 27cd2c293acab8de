// SPDX-License-Identifier: MIT
// The binding half of skinning.h: which masters, which weights.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <queue>
#include <utility>

#include "airway/skin_frame.h"
#include "airway/skinning.h"
#include "airway/surface_search.h"

namespace swallowclip::airway {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
// Below this an offset is rounding, not geometry (m).
constexpr double kNoOffset_m = 1e-13;

struct Candidate {
  int structure = 0;
  double share = 1;  ///< 1 in its own wall, fading to 0 away from a seam
  SurfacePoint at;
  double weight = 0;
};

using WallTable = std::vector<std::pair<std::uint8_t, std::vector<int>>>;

Result<WallTable> resolveWalls(const biomech::Model& model, const SkinningDef& def) {
  std::vector<std::string> known;
  for (const auto& s : model.structures()) known.push_back(s.name);
  WallTable table;
  for (const WallMasters& w : def.walls) {
    std::vector<int> ids;
    for (const std::string& name : w.structures) {
      const int id = model.find(name);
      if (id < 0) {
        const std::string near = nearestName(name, known);
        return usageError(
            fmt::format("skinning, wall {}", w.wall), "the model has no structure '" + name + "'",
            near.empty() ? "name a structure of the scene" : "did you mean '" + near + "'?");
      }
      ids.push_back(id);
    }
    table.push_back({w.wall, std::move(ids)});
  }
  return table;
}

const std::vector<int>* mastersOf(const WallTable& table, std::uint8_t wall) {
  for (const auto& [label, ids] : table)
    if (label == wall && !ids.empty()) return &ids;
  return nullptr;
}

Result<void> checkSkin(const BindSkin& skin, const WallTable& table) {
  const size_t n = skin.mesh.positions.size();
  const ManifoldReport manifold = checkManifold(skin.mesh.triangles, static_cast<int>(n));
  if (n == 0 || !manifold.closed())
    return usageError("airway-skin", "is not watertight: " + manifold.text(),
                      "close the skin before attaching it");
  if (!(volume(skin.mesh) > 0))
    return usageError("airway-skin", "encloses no positive volume",
                      "turn its triangles to face out of the lumen");
  if (skin.wall.size() != n)
    return usageError("airway-skin",
                      fmt::format("{} wall labels for {} vertices", skin.wall.size(), n),
                      "label every vertex");
  for (size_t v = 0; v < n; ++v)
    if (mastersOf(table, skin.wall[v]) == nullptr)
      return usageError(
          "airway-skin",
          fmt::format("vertex {} belongs to wall {}, which has no structures", v, skin.wall[v]),
          "name the structures of that wall in the skinning table");
  return {};
}

// Distance along mesh edges from the vertices of one wall, up to `reach_m` (Dijkstra).
std::vector<double> distanceFromWall(const BindSkin& skin, std::uint8_t wall, double reach_m,
                                     const std::vector<std::vector<int>>& neighbours) {
  std::vector<double> distance(skin.wall.size(), kNever);
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (size_t v = 0; v < skin.wall.size(); ++v)
    if (skin.wall[v] == wall) open.push({distance[v] = 0, static_cast<int>(v)});
  while (!open.empty()) {
    const auto [d, v] = open.top();
    open.pop();
    if (d > distance[v]) continue;
    for (int w : neighbours[v]) {
      const double next = d + (skin.mesh.positions[v] - skin.mesh.positions[w]).norm();
      if (next < distance[w] && next < reach_m) open.push({distance[w] = next, w});
    }
  }
  return distance;
}

// [vertex] walls other than its own that may join in, with their share.
std::vector<std::vector<std::pair<std::uint8_t, double>>> seamShares(const BindSkin& skin,
                                                                     const WallTable& table,
                                                                     double seam_m) {
  const size_t n = skin.wall.size();
  std::vector<std::vector<std::pair<std::uint8_t, double>>> shares(n);
  if (!(seam_m > 0)) return shares;
  std::vector<std::vector<int>> neighbours(n);
  for (const Triangle& t : skin.mesh.triangles)
    for (int k = 0; k < 3; ++k) neighbours[t[k]].push_back(t[(k + 1) % 3]);
  for (const auto& [wall, ids] : table) {
    const std::vector<double> distance = distanceFromWall(skin, wall, seam_m, neighbours);
    for (size_t v = 0; v < n; ++v)
      if (skin.wall[v] != wall && distance[v] < seam_m)
        shares[v].push_back({wall, std::pow(1 - distance[v] / seam_m, 2)});
  }
  return shares;
}

// One surface alone where the vertex lies on it, else inverse distance with compact radius
// (Franke & Little's form of Shepard's weights): ((R - d) / (R d))^2 with R = nearest + radius.
void chooseWeights(std::vector<Candidate>& candidates, const biomech::Model& model,
                   const SkinningDef& def) {
  const Candidate* alone = nullptr;
  double nearest = kNever;
  for (const Candidate& c : candidates) {
    if (c.share == 1) nearest = std::min(nearest, c.at.distance_m);
    if (c.share < 1 || c.at.distance_m >= def.onSurface_m) continue;
    const bool soft = !model.structures()[c.structure].rigid;
    if (alone == nullptr || (soft && model.structures()[alone->structure].rigid)) alone = &c;
  }
  double sum = 0;
  const double radius = nearest + def.radius_m;
  for (Candidate& c : candidates) {
    const double d = std::max(c.at.distance_m, def.onSurface_m);
    if (alone != nullptr)
      c.weight = &c == alone ? 1 : 0;
    else
      c.weight = d < radius ? c.share * std::pow((radius - d) / (radius * d), 2) : 0;
    sum += c.weight;
  }
  for (Candidate& c : candidates) c.weight /= sum;
}

SoftMaster softMaster(const Candidate& c, const biomech::ModelStructure& s,
                      const std::vector<Vec3>& normals, const Vec3& q0) {
  SoftMaster m;
  m.structure = c.structure;
  m.nodes = s.rest.triangles[c.at.triangle];
  m.barycentric = c.at.barycentric;
  m.weight = c.weight;
  m.offset_m = q0 - c.at.point;
  if (m.offset_m.norm() > kNoOffset_m) {
    m.edge = longestTangent(m, s.rest.positions, normals);
    Mat3 frame;
    m.hasOffset = triangleFrame(m, s.rest.positions, normals, frame);
    if (m.hasOffset) m.localOffset_m = frame.transpose() * m.offset_m;
  }
  return m;
}

void count(const std::vector<Candidate>& used, const biomech::Model& model, double onSurface_m,
           int vertex, AttachReport& r) {
  double nearest = kNever;
  for (const Candidate& c : used) nearest = std::min(nearest, c.at.distance_m);
  const bool soft = !model.structures()[used.front().structure].rigid;
  if (used.size() > 1)
    ++r.blended;
  else if (nearest >= onSurface_m)
    ++r.offSurface;
  else
    ++(soft ? r.onSoft : r.onRigid);
  r.meanDistance_m += nearest;
  if (nearest > r.maxDistance_m || r.farthestVertex < 0) {
    r.maxDistance_m = nearest;
    r.farthestVertex = vertex;
  }
}
}  // namespace

double Attachment::weightSum(int v) const {
  double sum = 0;
  for (int i = softBegin[v]; i < softBegin[v + 1]; ++i)
    sum += soft[i].weight * soft[i].barycentric.sum();
  for (int i = rigidBegin[v]; i < rigidBegin[v + 1]; ++i) sum += rigid[i].weight;
  return sum;
}

Result<Attachment> attach(const BindSkin& skin, const biomech::Model& model, const SkinningDef& def,
                          AttachReport* report) {
  if (!(def.radius_m > 0) || !(def.onSurface_m > 0))
    return usageError(
        "skinning",
        fmt::format("blend radius {} m, on-surface distance {} m", def.radius_m, def.onSurface_m),
        "give positive distances");
  const auto table = resolveWalls(model, def);
  if (!table) return std::unexpected(table.error());
  if (auto good = checkSkin(skin, *table); !good) return std::unexpected(good.error());
  const auto shares = seamShares(skin, *table, def.seam_m);
  const auto& structures = model.structures();
  std::vector<std::unique_ptr<SurfaceSearch>> search(structures.size());
  std::vector<std::vector<Vec3>> normals(structures.size());
  const auto candidate = [&](int id, double share, const Vec3& p) {
    const TriMesh& rest = structures[id].rest;
    if (!search[id]) {
      search[id] = std::make_unique<SurfaceSearch>(rest.positions, rest.triangles);
      normals[id] = vertexNormals(rest.positions, rest.triangles);
    }
    return Candidate{id, share, search[id]->nearest(p), 0};
  };
  Attachment out;
  AttachReport seen;
  const int n = static_cast<int>(skin.wall.size());
  for (int v = 0; v < n; ++v) {
    const Vec3& q0 = skin.mesh.positions[v];
    std::vector<Candidate> candidates;
    for (int id : *mastersOf(*table, skin.wall[v])) candidates.push_back(candidate(id, 1, q0));
    for (const auto& [wall, share] : shares[v])
      if (const auto* ids = mastersOf(*table, wall))
        for (int id : *ids) {
          const bool known = std::any_of(candidates.begin(), candidates.end(),
                                         [&](const Candidate& c) { return c.structure == id; });
          if (!known) candidates.push_back(candidate(id, share, q0));
        }
    chooseWeights(candidates, model, def);
    std::erase_if(candidates, [](const Candidate& c) { return !(c.weight > 0); });
    count(candidates, model, def.onSurface_m, v, seen);
    out.softBegin.push_back(static_cast<int>(out.soft.size()));
    out.rigidBegin.push_back(static_cast<int>(out.rigid.size()));
    for (const Candidate& c : candidates)
      if (structures[c.structure].rigid)
        out.rigid.push_back({c.structure, c.weight});
      else
        out.soft.push_back(softMaster(c, structures[c.structure], normals[c.structure], q0));
  }
  out.softBegin.push_back(static_cast<int>(out.soft.size()));
  out.rigidBegin.push_back(static_cast<int>(out.rigid.size()));
  seen.meanDistance_m /= n;
  if (report != nullptr) *report = seen;
  return out;
}
}  // namespace swallowclip::airway
