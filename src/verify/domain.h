// SPDX-License-Identifier: MIT
// The walls of a case as a moving closed surface, and what is known of the room they leave.
#pragma once
#include <memory>

#include "bolus/wall_motion.h"
#include "core/error.h"
#include "verify/case.h"

namespace swallowclip::verify {

class Domain {
 public:
  /// Fails for a mesh that is missing or open, naming its edges.
  static Result<Domain> build(const CaseDef& def, double spacing_m);

  /// No triangles in free space and where every axis is periodic. Lives as long as the Domain.
  const bolus::WallMotion& walls() const { return *walls_; }
  Vec3 period_m() const { return period_m_; }
  /// Volume between the walls at the start, of one period; 0 without walls or periods.
  double volume_m3() const { return volume_m3_; }
  /// Bounding box of the room of one period, in the frame of the walls.
  const Vec3& low_m() const { return low_m_; }
  const Vec3& high_m() const { return high_m_; }
  double narrowest_m() const;  ///< least extent, infinite in free space
  /// Is this point (in the frame of the walls) inside at the start?
  bool inside(const Vec3& p) const;
  /// Tilted walls: world place of a point of their frame.
  Vec3 toWorld(const Vec3& p) const { return turn_ * p; }
  Vec3 fromWorld(const Vec3& p) const { return turn_.transpose() * p; }
  /// Height (along -gravity, in the frame of the walls) up to which a volume fills the room at
  /// rest.
  double level_m(double volume_m3, const Vec3& up) const;

 private:
  const CaseDef* def_ = nullptr;
  std::shared_ptr<bolus::WallMotion> walls_;
  std::vector<Vec3> rest_;  // of a mesh
  Vec3 period_m_ = Vec3::Zero(), low_m_ = Vec3::Zero(), high_m_ = Vec3::Zero();
  double volume_m3_ = 0;
  Mat3 turn_ = Mat3::Identity();
};

/// Half width of a peristaltic room (plane or tube) at x: a (1 + occlusion sin k(x - travel)).
double waveHalfWidth_m(const CaseDef& def, double x_m, double travel_m);
double meanHalfWidth_m(const CaseDef& def);
}  // namespace swallowclip::verify
