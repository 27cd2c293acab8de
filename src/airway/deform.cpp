// SPDX-License-Identifier: MIT
// The moving half of skinning.h: equations 4.4 to 4.9.
#include <array>
#include <cmath>
#include <span>

#include "airway/skin_frame.h"
#include "airway/skinning.h"

namespace swallowclip::airway {
namespace {

struct DualQuat {
  Eigen::Vector4d real = Eigen::Vector4d::Zero(), dual = Eigen::Vector4d::Zero();
};

// x -> q x q* + t as the unit dual quaternion q + e (0, t) q / 2; coefficients x y z w.
DualQuat dualQuat(const Pose& pose) {
  const Quat t(0, pose.t.x(), pose.t.y(), pose.t.z());
  return {pose.q.coeffs(), 0.5 * (t * pose.q).coeffs()};
}

// Weighted mean of the relative frames, normalised (eq. 4.9); a quaternion and its negative are
// one rotation, so all take the side of the first.
Pose blended(std::span<const RigidMaster> masters, const std::vector<DualQuat>& frames) {
  DualQuat sum;
  for (const RigidMaster& m : masters) {
    const DualQuat& f = frames[m.structure];
    const double side = f.real.dot(frames[masters.front().structure].real) < 0 ? -1 : 1;
    sum.real += side * m.weight * f.real;
    sum.dual += side * m.weight * f.dual;
  }
  const double length = sum.real.norm();
  const Quat q(Eigen::Vector4d(sum.real / length)), d(Eigen::Vector4d(sum.dual / length));
  // dividing by the dual norm too takes the part of d along q out, which is the scalar part of t
  return {q, 2 * (d * q.conjugate()).vec()};
}

Vec3 rigidPart(std::span<const RigidMaster> masters, const std::vector<DualQuat>& frames,
               const biomech::ModelState& state, RigidBlend blend, const Vec3& q0) {
  if (masters.empty()) return Vec3::Zero();
  Vec3 sum = Vec3::Zero();
  if (blend == RigidBlend::linear || masters.size() == 1) {
    for (const RigidMaster& m : masters)
      sum += m.weight * (state.structures[m.structure].worldFromRest.apply(q0) - q0);
    return sum;
  }
  double weight = 0;
  for (const RigidMaster& m : masters) weight += m.weight;
  return weight * (blended(masters, frames).apply(q0) - q0);
}
}  // namespace

std::vector<Vec3> deform(const BindSkin& skin, const Attachment& a, const biomech::Model& model,
                         const biomech::ModelState& state, RigidBlend blend) {
  const auto& structures = model.structures();
  std::vector<DualQuat> frames(structures.size());
  std::vector<std::vector<Vec3>> normals(structures.size());
  for (size_t i = 0; i < structures.size(); ++i)
    if (structures[i].rigid) frames[i] = dualQuat(state.structures[i].worldFromRest);
  for (const SoftMaster& m : a.soft)
    if (m.hasOffset && normals[m.structure].empty())
      normals[m.structure] = vertexNormals(state.structures[m.structure].positions,
                                           structures[m.structure].rest.triangles);
  std::vector<Vec3> out(skin.mesh.positions.size());
  for (size_t v = 0; v < out.size(); ++v) {
    const Vec3& q0 = skin.mesh.positions[v];
    Vec3 moved = rigidPart({a.rigid.data() + a.rigidBegin[v], a.rigid.data() + a.rigidBegin[v + 1]},
                           frames, state, blend, q0);
    for (int i = a.softBegin[v]; i < a.softBegin[v + 1]; ++i) {
      const SoftMaster& m = a.soft[i];
      const auto& now = state.structures[m.structure].positions;
      const auto& rest = structures[m.structure].rest.positions;
      Vec3 f = Vec3::Zero();
      for (int k = 0; k < 3; ++k) f += m.barycentric[k] * (now[m.nodes[k]] - rest[m.nodes[k]]);
      Mat3 frame;
      if (m.hasOffset && triangleFrame(m, now, normals[m.structure], frame))
        f += frame * m.localOffset_m - m.offset_m;
      moved += m.weight * f;
    }
    out[v] = q0 + moved;
  }
  return out;
}
}  // namespace swallowclip::airway
