// SPDX-License-Identifier: MIT
#include "biomech/model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace swallowclip::biomech {
namespace {

// One-to-one correspondence of the sequential meshes is checked, not assumed.
Result<void> checkSequence(const kinematics::StructureSequence& s, int frames) {
  const auto wrong = [&](std::string problem) {
    return usageError("structure " + s.name, std::move(problem),
                      "export every frame of it with the same vertices and faces");
  };
  if (s.rest.empty() || s.triangles.empty()) return wrong("has no surface");
  if (static_cast<int>(s.frames.size()) != frames)
    return wrong(fmt::format("has {} frames where the others have {}", s.frames.size(), frames));
  const int count = static_cast<int>(s.rest.size());
  for (const Triangle& t : s.triangles)
    for (int v : t)
      if (v < 0 || v >= count) return wrong(fmt::format("names vertex {} of {}", v, count));
  const auto finite = [](const std::vector<Vec3>& points) {
    return std::all_of(points.begin(), points.end(), [](const Vec3& p) { return p.allFinite(); });
  };
  if (!finite(s.rest)) return wrong("has a rest vertex that is not a finite number");
  for (size_t f = 0; f < s.frames.size(); ++f) {
    if (s.frames[f].size() != s.rest.size())
      return wrong(fmt::format("has {} vertices in frame {} and {} at rest", s.frames[f].size(), f,
                               s.rest.size()));
    if (!finite(s.frames[f]))
      return wrong(fmt::format("has a vertex in frame {} that is not a finite number", f));
  }
  return {};
}

std::shared_ptr<const PoseTrack> fitTrack(const kinematics::MeshSequence& sequence,
                                          const kinematics::StructureSequence& s,
                                          ModelStructure& out) {
  std::vector<Pose> poses;
  for (const auto& frame : s.frames) {
    const RigidFit fit = fitPose(s.rest, frame);
    poses.push_back(fit.worldFromRest);
    out.residual_m.push_back(fit.rms_m);
    out.worstVertex_m = std::max(out.worstVertex_m, fit.max_m);
  }
  Vec3 reference = Vec3::Zero();
  for (const Vec3& p : s.rest) reference += p / static_cast<double>(s.rest.size());
  if (out.body) reference = out.body->centre_m;
  return std::make_shared<PoseTrack>(sequence.start_s, sequence.rate_hz, poses, reference);
}
}  // namespace

std::string ModelState::validate() const {
  for (size_t i = 0; i < structures.size(); ++i) {
    const StructureState& s = structures[i];
    bool good = s.worldFromRest.q.coeffs().allFinite() && s.worldFromRest.t.allFinite() &&
                s.twist.linear_ms.allFinite() && s.twist.angular_rads.allFinite();
    for (const auto* values : {&s.positions, &s.velocities})
      for (const Vec3& p : *values) good = good && p.allFinite();
    if (!good) return fmt::format("structure {} is not finite at {} s", i, time_s);
  }
  return "";
}

Result<Model> Model::build(const kinematics::MeshSequence& sequence, const ModelDef& def) {
  Model m;
  m.start_s_ = sequence.start_s;
  m.rate_hz_ = sequence.rate_hz;
  m.frames_ = sequence.frames();
  if (m.frames_ < 1 || !(m.rate_hz_ > 0) || !std::isfinite(m.rate_hz_))
    return usageError("mesh sequence",
                      fmt::format("{} frames at {} frames/s", m.frames_, m.rate_hz_),
                      "give at least one frame and a positive rate");
  for (const kinematics::StructureSequence& s : sequence.structures) {
    if (auto good = checkSequence(s, m.frames_); !good) return std::unexpected(good.error());
    if (m.find(s.name) >= 0)
      return usageError("structure " + s.name, "appears twice",
                        "give every structure its own name");
    const Material* material = findMaterial(def.materials, s.material);
    if (material == nullptr) {
      std::vector<std::string> known;
      for (const Material& each : def.materials) known.push_back(each.name);
      const std::string near = nearestName(s.material, known);
      return usageError("structure " + s.name, "has the unknown material '" + s.material + "'",
                        near.empty() ? "name a known material" : "did you mean '" + near + "'?");
    }
    ModelStructure out{s.name, s.material, s.rigid, {s.rest, s.triangles}, {}, {}, 0, {}};
    if (s.rigid) {
      if (auto body = massProperties(out.rest, material->density_kgm3)) out.body = *body;
      m.poses_.push_back(fitTrack(sequence, s, out));
      m.nodes_.push_back(nullptr);
    } else {
      auto wedges = WedgeMesh::build(out.rest, {def.layer_m, *material});
      if (!wedges) {
        wedges.error().place = "structure " + s.name;
        return std::unexpected(wedges.error());
      }
      out.wedges = std::move(*wedges);
      m.poses_.push_back(nullptr);
      m.nodes_.push_back(std::make_shared<kinematics::SequenceSampler>(sequence.start_s,
                                                                       sequence.rate_hz, s.frames));
    }
    m.structures_.push_back(std::move(out));
  }
  return m;
}

int Model::find(const std::string& name) const {
  for (size_t i = 0; i < structures_.size(); ++i)
    if (structures_[i].name == name) return static_cast<int>(i);
  return -1;
}

ModelState Model::at(double t_s) const {
  ModelState state;
  state.time_s = t_s;
  state.structures.resize(structures_.size());
  for (size_t i = 0; i < structures_.size(); ++i) {
    StructureState& s = state.structures[i];
    if (structures_[i].rigid)
      poses_[i]->at(t_s, s.worldFromRest, s.twist);
    else
      nodes_[i]->at(t_s, s.positions, s.velocities);
  }
  return state;
}

ModelState Model::rest() const {
  ModelState state;
  state.time_s = start_s_;
  state.structures.resize(structures_.size());
  for (size_t i = 0; i < structures_.size(); ++i) {
    if (structures_[i].rigid) continue;
    state.structures[i].positions = structures_[i].rest.positions;
    state.structures[i].velocities.assign(structures_[i].rest.positions.size(), Vec3::Zero());
  }
  return state;
}

std::vector<Vec3> Model::positions(const ModelState& state, int i) const {
  const StructureState& s = state.structures[i];
  if (!structures_[i].rigid) return s.positions;
  std::vector<Vec3> out;
  out.reserve(structures_[i].rest.positions.size());
  for (const Vec3& p : structures_[i].rest.positions) out.push_back(s.worldFromRest.apply(p));
  return out;
}

StrainField Model::strain(const ModelState& state, int i, ThreadPool& pool) const {
  const WedgeMesh& w = structures_[i].wedges.value();
  return w.strain(w.follow(state.structures[i].positions), pool);
}

double Model::maxRigidResidual_m() const {
  double most = 0;
  for (const ModelStructure& s : structures_)
    for (double r : s.residual_m) most = std::max(most, r);
  return most;
}
}  // namespace swallowclip::biomech
