// SPDX-License-Identifier: MIT
#include "biomech/rigid_body.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "kinematics/mesh_sequence.h"

namespace swallowclip::biomech {
namespace {

Vec3 mean(std::span<const Vec3> points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p;
  return points.empty() ? sum : Vec3(sum / static_cast<double>(points.size()));
}

}  // namespace

// Each triangle spans a signed tetrahedron with a point o near the mesh (so that little cancels).
// With corners a, b, c seen from o, s = a+b+c and d = a . (b x c), that tetrahedron has
//   volume d/6,   first moment d s / 24,   second moment d (aa' + bb' + cc' + ss') / 120,
// and the inertia about the centre is rho (tr(C) I - C) with C the central second moment.
Result<MassProperties> massProperties(const TriMesh& mesh, double density_kgm3) {
  if (!(density_kgm3 > 0) || !std::isfinite(density_kgm3))
    return usageError("rigid body", fmt::format("density {} kg/m^3 is not positive", density_kgm3),
                      "give the material a positive density");
  const ManifoldReport report =
      checkManifold(mesh.triangles, static_cast<int>(mesh.positions.size()));
  if (mesh.triangles.empty() || !report.closed())
    return usageError("rigid body", "its surface mesh is not closed: " + report.text(),
                      "repair the mesh, or mark it as drawn only");
  const Vec3 o = mean(mesh.positions);
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]] - o, b = mesh.positions[t[1]] - o,
               c = mesh.positions[t[2]] - o, s = a + b + c;
    const double d = a.dot(b.cross(c));
    volume += d / 6;
    first += d / 24 * s;
    second +=
        d / 120 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
  }
  if (!(volume > 0))
    return usageError("rigid body", fmt::format("its volume is {} m^3", volume),
                      "turn the triangles so that they face outward");
  MassProperties m;
  m.volume_m3 = volume;
  m.mass_kg = density_kgm3 * volume;
  const Vec3 centre = first / volume;
  const Mat3 central = second - volume * centre * centre.transpose();
  m.centre_m = o + centre;
  m.inertia_kgm2 = density_kgm3 * (central.trace() * Mat3::Identity() - central);
  return m;
}

MassProperties moved(const MassProperties& body, const Pose& worldFromBody) {
  MassProperties m = body;
  const Mat3 r = worldFromBody.q.toRotationMatrix();
  m.centre_m = worldFromBody.apply(body.centre_m);
  m.inertia_kgm2 = r * body.inertia_kgm2 * r.transpose();
  return m;
}

// Kabsch 1976 with Umeyama's (1991) sign: R = V diag(1, 1, det) U' of the covariance U S V'. The
// sign falls on the smallest singular value, which also settles flat and straight point sets.
RigidFit fitPose(std::span<const Vec3> rest, std::span<const Vec3> now) {
  CHECK_EQ(rest.size(), now.size());
  CHECK_GT(rest.size(), 0u);
  const Vec3 restMean = mean(rest), nowMean = mean(now);
  Mat3 covariance = Mat3::Zero();
  for (size_t i = 0; i < rest.size(); ++i)
    covariance += (rest[i] - restMean) * (now[i] - nowMean).transpose();
  RigidFit fit;
  if (covariance.norm() > 0) {
    const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Mat3 u = svd.matrixU(), v = svd.matrixV();
    Vec3 sign(1, 1, (v * u.transpose()).determinant() < 0 ? -1 : 1);
    fit.worldFromRest.q = Quat(Mat3(v * sign.asDiagonal() * u.transpose())).normalized();
  }
  fit.worldFromRest.t = nowMean - fit.worldFromRest.q * restMean;
  double squares = 0;
  for (size_t i = 0; i < rest.size(); ++i) {
    const double d2 = (fit.worldFromRest.apply(rest[i]) - now[i]).squaredNorm();
    squares += d2;
    fit.max_m = std::max(fit.max_m, std::sqrt(d2));
  }
  fit.rms_m = std::sqrt(squares / static_cast<double>(rest.size()));
  return fit;
}

// The same tangents as kinematics::SequenceSampler: harmonic mean of the secants, zero at turning
// points and at both ends. A quaternion and its negative are one rotation, so each takes the sign
// nearest to its predecessor first.
PoseTrack::PoseTrack(double start_s, double rate_hz, const std::vector<Pose>& poses,
                     const Vec3& reference_m)
    : start_s_(start_s), rate_hz_(rate_hz), reference_m_(reference_m) {
  CHECK_GT(poses.size(), 0u);
  CHECK_GT(rate_hz, 0.0);
  for (const Pose& pose : poses) {
    Key key;
    key << pose.apply(reference_m), pose.q.coeffs();
    if (!keys_.empty() && keys_.back().tail<4>().dot(key.tail<4>()) < 0) key.tail<4>() *= -1;
    keys_.push_back(key);
  }
  tangents_.assign(keys_.size(), Key::Zero());
  for (size_t f = 1; f + 1 < keys_.size(); ++f) {
    const Key before = keys_[f] - keys_[f - 1], after = keys_[f + 1] - keys_[f];
    for (int c = 0; c < 7; ++c)
      if (before[c] * after[c] > 0)
        tangents_[f][c] = 2 * before[c] * after[c] / (before[c] + after[c]);
  }
}

void PoseTrack::at(double t_s, Pose& pose, Twist& twist) const {
  const kinematics::HermiteWeights w = kinematics::locate(t_s, start_s_, rate_hz_, frames());
  Key key = keys_[w.frame], rate = Key::Zero();
  if (frames() > 1) {
    const double x = w.x, y = 1 - x;
    const Key d = keys_[w.frame + 1] - key, &m0 = tangents_[w.frame], &m1 = tangents_[w.frame + 1];
    key += x * x * (3 - 2 * x) * d + x * y * y * m0 - x * x * y * m1;
    rate = rate_hz_ * (6 * x * y * d + y * (1 - 3 * x) * m0 + x * (3 * x - 2) * m1);
  }
  // q = h/|h|, so q' = (h' - q (q . h')) / |h|, and the angular velocity is 2 q' q*
  const Eigen::Vector4d h = key.tail<4>(), dh = rate.tail<4>();
  const double length = h.norm();
  const Eigen::Vector4d q = h / length, dq = (dh - q * q.dot(dh)) / length;
  pose.q = Quat(q);
  pose.t = key.head<3>() - pose.q * reference_m_;
  twist.linear_ms = rate.head<3>();
  twist.angular_rads = 2 * (Quat(dq) * pose.q.conjugate()).vec();
}
}  // namespace swallowclip::biomech
