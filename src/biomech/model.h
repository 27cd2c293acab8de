// SPDX-License-Identifier: MIT
// The coupled biomechanical model (thesis 3.2.2-3.2.3): rigid structures as bodies with a best-fit
// pose per sequential mesh, soft ones as hollow wedge models with driven surface nodes. It knows
// the whole motion; `at(t)` is a pure function of time, C1, with exact velocities.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "biomech/rigid_body.h"
#include "biomech/wedge_fem.h"
#include "kinematics/mesh_sequence.h"

namespace swallowclip::biomech {

struct ModelDef {
  double layer_m = 1e-3;  ///< wedge layer thickness, see WedgeDef
  std::vector<Material> materials = standardMaterials();
};

/// One structure at one time. Rigid: pose and twist; soft: surface nodes.
struct StructureState {
  Pose worldFromRest;
  Twist twist;  ///< at the centre of mass
  std::vector<Vec3> positions, velocities;
};

struct ModelState {
  double time_s = 0;
  std::vector<StructureState> structures;  ///< in Model's order

  /// "" when every number is finite, else what is not.
  std::string validate() const;
};

struct ModelStructure {
  std::string name, material;
  bool rigid = true;
  TriMesh rest;
  // rigid
  std::optional<MassProperties> body;  ///< none when the surface is not closed (drawn only)
  std::vector<double> residual_m;      ///< [frame] rms distance from the best-fit rigid pose
  double worstVertex_m = 0;            ///< largest distance of any vertex in any frame
  // soft
  std::optional<WedgeMesh> wedges;
};

class Model {
 public:
  static Result<Model> build(const kinematics::MeshSequence& sequence, const ModelDef& def = {});

  double start_s() const { return start_s_; }
  double rate_hz() const { return rate_hz_; }
  int frames() const { return frames_; }
  double end_s() const { return start_s_ + (frames_ - 1) / rate_hz_; }

  const std::vector<ModelStructure>& structures() const { return structures_; }
  /// Index by name, or -1.
  int find(const std::string& name) const;

  ModelState at(double t_s) const;
  /// The bind pose: every pose the identity, every node at rest.
  ModelState rest() const;
  /// Vertex positions of a structure, whichever kind it is.
  std::vector<Vec3> positions(const ModelState& state, int structure) const;
  /// Strain and stress of a soft structure in that state.
  StrainField strain(const ModelState& state, int structure, ThreadPool& pool) const;
  /// Largest rms residual over the rigid structures and frames.
  double maxRigidResidual_m() const;

 private:
  double start_s_ = 0, rate_hz_ = 1;
  int frames_ = 0;
  std::vector<ModelStructure> structures_;
  // one of the two per structure; shared so that a Model is a value and cheap to copy
  std::vector<std::shared_ptr<const PoseTrack>> poses_;
  std::vector<std::shared_ptr<const kinematics::SequenceSampler>> nodes_;
};
}  // namespace swallowclip::biomech
