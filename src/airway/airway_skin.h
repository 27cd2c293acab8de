// SPDX-License-Identifier: MIT
// The airway-skin: bound once, deformed by skinning at evenly spaced times, C1 in between with
// exact velocities. What the bolus, the measures and the pictures see of the lumen.
#pragma once
#include <memory>
#include <vector>

#include "airway/skinning.h"
#include "biomech/model.h"
#include "bolus/wall_motion.h"
#include "core/parallel.h"

namespace swallowclip::airway {

/// How the motion runs between the baked frames.
enum class TimeBlend {
  /// Through every frame, shape-preserving per coordinate (kinematics::SequenceSampler). Two
  /// vertices that touch at the frames may still cross a little in between.
  pchip,
  /// Uniform quadratic B-spline over the frames: always a convex mean of neighbouring frames, so
  /// that a gap that is positive at the frames is positive between them too. It cuts corners: at
  /// frame k it lies 1/8 of the second difference away from it.
  convex,
};

struct BakeDef {
  double rate_hz = 0;  ///< 0: the model's own
  TimeBlend blend = TimeBlend::pchip;
  int threads = 1;
};

/// The skin's motion, self-contained: needs neither model nor binding any more.
class BakedSkin {
 public:
  /// From positions at evenly spaced times, wherever they come from.
  static Result<BakedSkin> fromFrames(std::shared_ptr<const BindSkin> bind, double start_s,
                                      double rate_hz, std::vector<std::vector<Vec3>> frames,
                                      TimeBlend blend);

  void at(double t_s, std::vector<Vec3>& positions, std::vector<Vec3>& velocities) const;
  int frames() const;
  double start_s() const { return start_s_; }
  double rate_hz() const { return rate_hz_; }
  double time_s(int frame) const { return start_s_ + frame / rate_hz_; }
  /// The bind pose, labels and path coordinates.
  const BindSkin& bind() const { return *bind_; }
  /// For the fluid; shares this motion's data.
  bolus::WallMotion wallMotion() const;

 private:
  struct Motion;

  double start_s_ = 0, rate_hz_ = 1;
  std::shared_ptr<const BindSkin> bind_;
  std::shared_ptr<const Motion> motion_;
};

class AirwaySkin {
 public:
  const BindSkin& bind() const { return *bind_; }
  const Attachment& attachment() const { return attachment_; }
  const AttachReport& report() const { return report_; }

  std::vector<Vec3> deform(const biomech::Model& model, const biomech::ModelState& state) const;
  /// `model` has to be the one that the skin was attached to.
  Result<BakedSkin> bake(const biomech::Model& model, const BakeDef& def = {}) const;

 private:
  friend Result<AirwaySkin> attachSkin(BindSkin, const biomech::Model&, const SkinningDef&);

  std::shared_ptr<const BindSkin> bind_;
  Attachment attachment_;
  AttachReport report_;
  RigidBlend blend_ = RigidBlend::dualQuaternion;
};

Result<AirwaySkin> attachSkin(BindSkin bind, const biomech::Model& model, const SkinningDef& def);
}  // namespace swallowclip::airway
