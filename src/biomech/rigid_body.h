// SPDX-License-Identifier: MIT
// Rigid bodies of the bony and cartilaginous structures: mass properties from the closed surface
// mesh, the best-fit pose of every sequential mesh, and a pose that is C1 in time with its
// six-dimensional velocity. Metres, kilograms, seconds; world frame of core/vec.h.
#pragma once
#include <span>
#include <vector>

#include "core/error.h"
#include "core/tri_mesh.h"
#include "core/vec.h"

namespace swallowclip::biomech {

/// Of a homogeneous solid. `inertia_kgm2` is taken about the centre of mass, in world axes.
struct MassProperties {
  double mass_kg = 0, volume_m3 = 0;
  Vec3 centre_m = Vec3::Zero();
  Mat3 inertia_kgm2 = Mat3::Zero();
};

/// Exact integrals over the polyhedron. The mesh has to be closed and face outward.
Result<MassProperties> massProperties(const TriMesh& mesh, double density_kgm3);

/// The same body seen in another place.
MassProperties moved(const MassProperties& body, const Pose& worldFromBody);

struct RigidFit {
  Pose worldFromRest;
  double rms_m = 0;  ///< root mean square distance of the vertices from the rigid body
  double max_m = 0;
};

/// Least-squares rotation and translation of `rest` onto `now`, never a reflection.
RigidFit fitPose(std::span<const Vec3> rest, std::span<const Vec3> now);

/// Six-dimensional velocity: of the body's reference point, and about it, in world axes.
struct Twist {
  Vec3 linear_ms = Vec3::Zero();
  Vec3 angular_rads = Vec3::Zero();
};

/// Poses at evenly spaced times made C1: shape-preserving for the path of `reference_m` (a point
/// of the rest mesh, best the centre of mass) and for the quaternion, which is then normalised.
class PoseTrack {
 public:
  PoseTrack(double start_s, double rate_hz, const std::vector<Pose>& worldFromRest,
            const Vec3& reference_m);

  void at(double t_s, Pose& worldFromRest, Twist& atReference) const;
  int frames() const { return static_cast<int>(keys_.size()); }

 private:
  using Key = Eigen::Matrix<double, 7, 1>;  ///< reference point, then quaternion x y z w

  double start_s_, rate_hz_;
  Vec3 reference_m_;
  std::vector<Key> keys_, tangents_;  ///< tangents per frame interval
};
}  // namespace swallowclip::biomech
