// SPDX-License-Identifier: MIT
#include "biomech/wedge_fem.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace swallowclip::biomech {
namespace {

// An element has to keep this share of the Jacobian it would have at vanishing thickness; assumed
// (0.2-0.8): thin enough at folds to stay unfolded when the surface bends.
constexpr double kLeastJacobianShare = 0.5;
// A vertex direction has to lean towards each of its faces by at least this cosine; assumed
// (0.1-0.4).
constexpr double kLeastLean = 0.2;
constexpr int kLeanRounds = 300, kThinningRounds = 24;
// Thickness changes are held within this factor; assumed (2-4), plane stress is a small-strain law.
constexpr double kMostThickening = 3;
// Triangles thinner than this (area over longest edge squared) carry no element; assumed.
constexpr double kSliver = 1e-7;

struct Face {
  Vec3 normal = Vec3::Zero();  ///< unit, or zero for a sliver
  double area_m2 = 0;
};

Face faceOf(std::span<const Vec3> p, const Triangle& t) {
  const Vec3 a = p[t[1]] - p[t[0]], b = p[t[2]] - p[t[0]], n = a.cross(b);
  const double twice = n.norm();
  const double longest = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
  if (!(twice > kSliver * longest)) return {Vec3::Zero(), twice / 2};
  return {n / twice, twice / 2};
}

double cornerAngle(std::span<const Vec3> p, const Triangle& t, int k) {
  const Vec3 a = p[t[(k + 1) % 3]] - p[t[k]], b = p[t[(k + 2) % 3]] - p[t[k]];
  return std::atan2(a.cross(b).norm(), a.dot(b));
}
}  // namespace

Result<WedgeMesh> WedgeMesh::build(const TriMesh& surface, const WedgeDef& def) {
  if (!(def.layer_m > 0))
    return usageError("wedge model", fmt::format("layer thickness {} m", def.layer_m),
                      "give a positive thickness");
  const Material& m = def.material;
  if (!(m.young_Pa > 0) || !(m.poisson > -1) || !(m.poisson < 0.5))
    return usageError("wedge model of " + m.name,
                      fmt::format("E = {} Pa, Poisson ratio {}", m.young_Pa, m.poisson),
                      "take E > 0 and a ratio in (-1, 0.5)");
  const int count = static_cast<int>(surface.positions.size());
  for (const Triangle& t : surface.triangles)
    for (int v : t)
      if (v < 0 || v >= count)
        return usageError("wedge model", fmt::format("triangle names vertex {} of {}", v, count),
                          "repair the surface mesh");
  for (const Vec3& p : surface.positions)
    if (!p.allFinite())
      return usageError("wedge model", "a vertex is not a finite number",
                        "repair the surface mesh");
  WedgeMesh w;
  w.vertices_ = count;
  w.material_ = m;
  w.triangles_ = surface.triangles;
  w.thickness_m_.assign(count, def.layer_m);
  w.chooseWeights(surface.positions);
  w.extrude(surface.positions);
  if (w.elements_.empty())
    return usageError("wedge model", "no triangle of the surface has an area",
                      "repair the surface mesh");
  return w;
}

// Vertex direction = normalised sum of face normals with fixed weights: corner angles, and more
// for faces that the sum would leave behind (the perceptron rule, which ends wherever a direction
// in front of all faces exists). Fixed weights make the direction turn exactly with the surface.
void WedgeMesh::chooseWeights(std::span<const Vec3> p) {
  const int count = static_cast<int>(triangles_.size());
  weights_.assign(count, {0, 0, 0});
  std::vector<Face> faces(count);
  std::vector<std::vector<std::pair<int, int>>> corners(vertices_);
  for (int t = 0; t < count; ++t) {
    faces[t] = faceOf(p, triangles_[t]);
    if (faces[t].normal.isZero()) continue;
    for (int k = 0; k < 3; ++k) {
      weights_[t][k] = cornerAngle(p, triangles_[t], k);
      corners[triangles_[t][k]].push_back({t, k});
    }
  }
  for (const auto& fan : corners) {
    double step = 0;
    for (auto [t, k] : fan) step += 0.1 * weights_[t][k];
    for (int round = 0; round < kLeanRounds; ++round) {
      Vec3 sum = Vec3::Zero();
      for (auto [t, k] : fan) sum += weights_[t][k] * faces[t].normal;
      double least = kLeastLean * sum.norm();
      std::pair<int, int> behind{-1, 0};
      for (auto [t, k] : fan) {
        if (faces[t].normal.dot(sum) >= least) continue;
        least = faces[t].normal.dot(sum);
        behind = {t, k};
      }
      if (behind.first < 0) break;
      weights_[behind.first][behind.second] += step;
    }
  }
}

void WedgeMesh::directions(std::span<const Vec3> p, std::vector<Vec3>& out,
                           std::vector<double>& area_m2) const {
  out.assign(vertices_, Vec3::Zero());
  area_m2.assign(vertices_, 0);
  for (size_t t = 0; t < triangles_.size(); ++t) {
    const Face f = faceOf(p, triangles_[t]);
    for (int k = 0; k < 3; ++k) {
      out[triangles_[t][k]] += weights_[t][k] * f.normal;
      area_m2[triangles_[t][k]] += f.area_m2;
    }
  }
  for (Vec3& d : out) d = d.norm() > 0 ? Vec3(d.normalized()) : Vec3(Vec3::UnitZ());
}

// Halves the thickness at the nodes of bad elements until none is left; what stays bad carries no
// element.
void WedgeMesh::extrude(std::span<const Vec3> p) {
  std::vector<Vec3> outward;
  directions(p, outward, restArea_m2_);
  const int count = static_cast<int>(triangles_.size());
  const auto wedgeAt = [&](int t, int layer) {
    Wedge w;
    for (int k = 0; k < 3; ++k) {
      const int v = triangles_[t][k];
      w[k] = p[v] - (layer + 1) * thickness_m_[v] * outward[v];
      w[k + 3] = p[v] - layer * thickness_m_[v] * outward[v];
    }
    return w;
  };
  // no direction of its nodes can carry it: no area, or a fold that no thinning mends
  std::vector<double> lean(count, 1);  // how far a triangle's nodes move straight away from it
  for (int t = 0; t < count; ++t)
    for (int v : triangles_[t])
      lean[t] = std::min(lean[t], faceOf(p, triangles_[t]).normal.dot(outward[v]));
  const auto hopeless = [&](int t) { return !(lean[t] > kLeastLean / 10); };
  const auto good = [&](int t) {
    if (hopeless(t)) return false;
    const double area = faceOf(p, triangles_[t]).area_m2;
    // the thinnest node counts: measured by the mean, thinning would spread without end
    double h = thickness_m_[triangles_[t][0]];
    for (int v : triangles_[t]) h = std::min(h, thickness_m_[v]);
    for (int layer = 0; layer < kLayers; ++layer)
      if (!(wedgeMinJacobian(wedgeAt(t, layer)) > kLeastJacobianShare * lean[t] * area * h))
        return false;
    return true;
  };
  std::vector<char> keep(count);
  for (int round = 0; round <= kThinningRounds; ++round) {
    std::vector<char> thin(vertices_, 0);
    bool any = false;
    for (int t = 0; t < count; ++t) {
      keep[t] = good(t);
      if (keep[t] || hopeless(t)) continue;
      any = true;
      for (int v : triangles_[t]) thin[v] = 1;
    }
    if (!any || round == kThinningRounds) break;
    for (int v = 0; v < vertices_; ++v)
      if (thin[v]) thickness_m_[v] /= 2;
  }
  for (int layer = 0; layer <= kLayers; ++layer)
    for (int v = 0; v < vertices_; ++v)
      rest_.push_back(p[v] - layer * thickness_m_[v] * outward[v]);
  for (int t = 0; t < count; ++t) {
    skipped_ += keep[t] ? 0 : 1;
    for (int layer = 0; keep[t] && layer < kLayers; ++layer) {
      std::array<int, 6> e{};
      for (int k = 0; k < 3; ++k) {
        e[k] = (layer + 1) * vertices_ + triangles_[t][k];
        e[k + 3] = layer * vertices_ + triangles_[t][k];
      }
      elements_.push_back(e);
      triangleOf_.push_back(t);
    }
  }
}

double WedgeMesh::thinnestLayer_m() const {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& e : elements_)
    for (int k = 3; k < 6; ++k) least = std::min(least, thickness_m_[e[k] % vertices_]);
  return least;
}

std::vector<Vec3> WedgeMesh::follow(std::span<const Vec3> surface) const {
  CHECK_EQ(static_cast<int>(surface.size()), vertices_);
  std::vector<Vec3> outward, nodes(this->nodes());
  std::vector<double> area;
  directions(surface, outward, area);
  const double power = -material_.poisson / (1 - material_.poisson);
  for (int v = 0; v < vertices_; ++v) {
    const double growth = restArea_m2_[v] > 0 ? area[v] / restArea_m2_[v] : 1;
    const double factor = std::clamp(growth > 0 ? std::pow(growth, power) : kMostThickening,
                                     1 / kMostThickening, kMostThickening);
    for (int layer = 0; layer <= kLayers; ++layer)
      nodes[layer * vertices_ + v] = surface[v] - layer * factor * thickness_m_[v] * outward[v];
  }
  return nodes;
}

Wedge WedgeMesh::gather(std::span<const Vec3> nodes, int e) const {
  Wedge w;
  for (int a = 0; a < 6; ++a) w[a] = nodes[elements_[e][a]];
  return w;
}

StrainField WedgeMesh::strain(std::span<const Vec3> now, ThreadPool& pool) const {
  CHECK_EQ(static_cast<int>(now.size()), nodes());
  const int n = elements();
  StrainField f;
  f.strain.resize(n);
  f.stress_Pa.resize(n);
  f.vonMises_Pa.resize(n);
  f.equivalentStrain.resize(n);
  std::vector<double> ratio(n);
  pool.forChunks(n, 1024, [&](int begin, int end, int) {
    for (int e = begin; e < end; ++e) {
      const Wedge rest = gather(rest_, e), moved = gather(now, e);
      f.strain[e] = wedgeStrain(rest, moved);
      f.stress_Pa[e] = hookeStress(f.strain[e], material_);
      f.vonMises_Pa[e] = vonMises(f.stress_Pa[e]);
      f.equivalentStrain[e] = biomech::equivalentStrain(f.strain[e]);
      ratio[e] = wedgeMinJacobian(moved) / wedgeVolume(rest);
    }
  });
  f.minJacobianRatio = *std::min_element(ratio.begin(), ratio.end());
  f.foldedElements = static_cast<int>(
      std::count_if(ratio.begin(), ratio.end(), [](double r) { return !(r > 0); }));
  f.nodeVonMises_Pa.assign(vertices_, 0);
  f.nodeStrain.assign(vertices_, 0);
  std::vector<int> hits(vertices_, 0);
  for (int e = 0; e < n; ++e)
    for (int k = 3; k < 6; ++k) {
      const int v = elements_[e][k];
      if (v >= vertices_) continue;  // the deeper layer
      f.nodeVonMises_Pa[v] += f.vonMises_Pa[e];
      f.nodeStrain[v] += f.equivalentStrain[e];
      ++hits[v];
    }
  for (int v = 0; v < vertices_; ++v)
    if (hits[v] > 0) {
      f.nodeVonMises_Pa[v] /= hits[v];
      f.nodeStrain[v] /= hits[v];
    }
  return f;
}

double WedgeMesh::volume(std::span<const Vec3> nodes) const {
  double sum = 0;
  for (int e = 0; e < elements(); ++e) sum += wedgeVolume(gather(nodes, e));
  return sum;
}
}  // namespace swallowclip::biomech
