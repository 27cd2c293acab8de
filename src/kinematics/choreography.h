// SPDX-License-Identifier: MIT
// A swallow file's timeline turned into poses: gap fields of the lumen and frames of the bones.
#pragma once
#include "anatomy/anatomy.h"
#include "anatomy/lumen.h"
#include "anatomy/soft_parts.h"
#include "core/error.h"
#include "kinematics/mesh_sequence.h"
#include "kinematics/swallow_def.h"

namespace swallowclip::kinematics {

/// Rigid displacement of every carrier from rest (head-from-rest).
struct CarrierPoses {
  Pose hyoid, thyroid, cricoid, arytenoidL, arytenoidR, mandible;
};

class Choreography {
 public:
  Choreography(const anatomy::Lumen& lumen, SwallowDef def);

  const SwallowDef& def() const { return def_; }
  /// Of the tongue below the palate, where it holds the bolus.
  double grooveDepth_m() const { return grooveDepth_m_; }
  anatomy::LumenPose lumenPose(double t_s) const;
  CarrierPoses carriers(double t_s) const;
  /// Branch 1: velum against the wall; 2: laryngeal inlet shut lip to lip.
  bool sealed(double t_s, int branch) const;

 private:
  double track(const char* name, double tau_s) const;
  double chamber(double s_m, double u, double tau_s) const;
  double restPosture(double s_m, double u) const;
  double release(double s_m, double tau_s) const;
  double leftBehind(double s_m, double u, double bulge_m, double tau_s) const;
  double wallOut(double s_m, double side, double tau_s) const;

  const anatomy::Lumen& lumen_;
  SwallowDef def_;
  double grooveDepth_m_ = 0;
};

/// Sequential meshes of the whole scene at rate_hz, landmarks included as tracks.
struct BakedMotion {
  MeshSequence sequence;
  std::vector<std::vector<Vec3>> skin;  ///< [frame][skin vertex]
  std::vector<std::string> landmarkNames;
  std::vector<std::vector<Vec3>> landmarks;  ///< [frame][landmark]
};
BakedMotion bake(const anatomy::Anatomy& rigidParts, const anatomy::Lumen& lumen,
                 const anatomy::SoftParts& soft, const SwallowDef& swallow, double rate_hz);
}  // namespace swallowclip::kinematics
