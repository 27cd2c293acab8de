// SPDX-License-Identifier: MIT
// Unified geometric skinning (thesis 4.1.2): every vertex of the airway-skin hangs on masters,
//   q = q0 + sum_i w_i f_i(q_m, q_m0, q0)                                        (eq. 4.4)
// where f is a node displacement for FEM masters (eq. 4.5) and a blended rigid displacement for
// frames (eq. 4.6-4.9). Beyond the thesis: a vertex off its FEM surface carries its offset along in
// the turning frame of the triangle, so that one rigid motion of all masters moves the skin
// rigidly.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "biomech/model.h"
#include "core/error.h"

namespace swallowclip::airway {

/// The skin at the bind pose. Triangles face out of the lumen.
struct BindSkin {
  TriMesh mesh;
  std::vector<std::uint8_t> wall;    ///< [vertex] frame::Wall
  std::vector<double> s_m, u;        ///< [vertex] path coordinates, may be empty
  std::vector<std::uint8_t> branch;  ///< [vertex] 0 main, 1 nasopharynx, 2 larynx, may be empty
};

/// Structures that vertices of one wall may hang on.
struct WallMasters {
  std::uint8_t wall = 0;
  std::vector<std::string> structures;
};

enum class RigidBlend { linear, dualQuaternion };

struct SkinningDef {
  std::vector<WallMasters> walls;
  /// A structure joins in up to this much farther away than the nearest one; assumed (2-8 mm).
  double radius_m = 4e-3;
  /// Masters of a neighbouring wall join in up to this far along the skin from the seam; assumed
  /// (0-6 mm), 0 for none.
  double seam_m = 3e-3;
  /// Nearer than this a vertex lies on a structure and follows it alone (soft before rigid).
  double onSurface_m = 1e-6;
  RigidBlend blend = RigidBlend::dualQuaternion;
};

/// A share in the three nodes of one soft triangle, with the offset from it at the bind pose.
struct SoftMaster {
  int structure = 0;
  Triangle nodes{};
  Vec3 barycentric = Vec3::Zero();
  double weight = 0;
  bool hasOffset = false;
  int edge = 0;                       ///< triangle edge that gives the frame its first axis
  Vec3 offset_m = Vec3::Zero();       ///< world axes, bind pose
  Vec3 localOffset_m = Vec3::Zero();  ///< in the triangle's frame
};

struct RigidMaster {
  int structure = 0;
  double weight = 0;
};

/// Masters of vertex v are soft[softBegin[v] .. softBegin[v+1]) and likewise rigid ones.
struct Attachment {
  std::vector<int> softBegin, rigidBegin;
  std::vector<SoftMaster> soft;
  std::vector<RigidMaster> rigid;

  /// Sum of all weights of a vertex over FEM nodes and frames.
  double weightSum(int vertex) const;
};

struct AttachReport {
  int onSoft = 0, onRigid = 0, blended = 0, offSurface = 0;  ///< vertices; off: one master, apart
  double meanDistance_m = 0, maxDistance_m = 0;              ///< to the nearest allowed master
  int farthestVertex = -1;
};

/// Chooses masters and weights: among the structures allowed for the vertex' wall, nearest points
/// blended by inverse distance with compact radius. Weights are >= 0 and sum to 1.
Result<Attachment> attach(const BindSkin& skin, const biomech::Model& model, const SkinningDef& def,
                          AttachReport* report = nullptr);

/// Skin positions for a model state.
std::vector<Vec3> deform(const BindSkin& skin, const Attachment& attachment,
                         const biomech::Model& model, const biomech::ModelState& state,
                         RigidBlend blend);
}  // namespace swallowclip::airway
