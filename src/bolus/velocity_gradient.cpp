// SPDX-License-Identifier: MIT
#include "bolus/velocity_gradient.h"

#include <algorithm>
#include <cmath>

namespace swallowclip::bolus {
namespace {
// Norm of the inverse moment matrix above which a neighbourhood is too one-sided to be corrected,
// assumed (7 to 13): a full one has 1.7, a half one 3.5, one at an edge 7, at a corner 14.
constexpr double kMostInverse = 10;
}  // namespace

Mat3 velocityGradient_s(const Flow& f, const SlopeSweep& slopes, const Vec3& v, int i) {
  const WallSample& w = f.wall(i);
  float sums[9];
  slopes.run(i, sums);
  Mat3 gradient =
      Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(sums).cast<double>();
  const float* t = f.neighbours.moment[i];
  Mat3 moment;
  moment << t[0], t[4], t[5], t[4], t[1], t[6], t[5], t[6], t[2];
  const double steep = w.gradLambda.norm();
  // Outside, the velocity goes on linearly through the wall's: (v_wall - v) / distance along n. Of
  // such a gradient the missing part of the sum, int_out (y - x).n dW/dn dV, is by parts the share
  // lambda of the kernel plus distance times grad lambda.
  if (w.friction > 0 && w.area > 0 && steep > 0) {
    const double share = std::min(w.lambda + steep * w.area / w.friction, 1.0);
    gradient +=
        share / (w.area * steep) * (w.frictionVelocity - w.friction * v) * w.gradLambda.transpose();
    moment += share / (steep * steep) * w.gradLambda * w.gradLambda.transpose();
  }
  // What the same sums make of a linear field (Bonet & Lok 1999, sec. 3.3): among disordered
  // particles 10 % off, which a stiff plug would take for shear.
  Mat3 inverse;
  double determinant = 0;
  bool fine = false;
  moment.computeInverseAndDetWithCheck(inverse, determinant, fine, 1e-9);
  fine = fine && determinant > 0 && inverse.norm() < kMostInverse;
  return fine ? Mat3(gradient * inverse) : gradient;
}
Mat3 gradientBeforeWall_s(const WallSample& w, const Vec3& v, const Mat3& gradient) {
  const double steep = w.gradLambda.norm();
  if (!(w.friction > 0 && w.area > 0 && steep > 0)) return gradient;
  const Vec3 n = w.gradLambda / steep;
  return gradient + ((w.frictionVelocity - w.friction * v) / w.area - gradient * n) * n.transpose();
}
double shearRate_s(const Mat3& gradient) {
  const Mat3 d = 0.5 * (gradient + gradient.transpose());
  return std::sqrt(2 * d.squaredNorm());
}
}  // namespace swallowclip::bolus
