// SPDX-License-Identifier: MIT
#include "biomech/wedge.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace swallowclip::biomech {
namespace {

using Gradients = Eigen::Matrix<double, 6, 3>;  ///< row a: dN_a / d(r, s, z)

// N_a = L_k (1 -+ z)/2 with the area coordinates L = (1-r-s, r, s).
Gradients shapeGradients(double r, double s, double z) {
  const std::array<double, 3> area = {1 - r - s, r, s};
  const std::array<double, 3> dr = {-1, 1, 0}, ds = {-1, 0, 1};
  Gradients g;
  for (int k = 0; k < 3; ++k) {
    const double in = (1 - z) / 2, out = (1 + z) / 2;
    g.row(k) << dr[k] * in, ds[k] * in, -area[k] / 2;
    g.row(k + 3) << dr[k] * out, ds[k] * out, area[k] / 2;
  }
  return g;
}

Mat3 jacobian(const Wedge& w, const Gradients& g) {
  Mat3 j = Mat3::Zero();
  for (int a = 0; a < 6; ++a) j += w[a] * g.row(a);
  return j;
}

// Triangle rule of degree 2 (points at 1/6, 2/3; weight 1/6 each, the reference triangle's area
// being 1/2) times the two-point Gauss rule (z = -+ 1/sqrt 3, weight 1).
constexpr double kGaussWeight = 1.0 / 6;
const std::array<Gradients, 6>& gaussGradients() {
  static const std::array<Gradients, 6> all = [] {
    const double z = 1 / std::sqrt(3.0);
    const std::array<std::array<double, 2>, 3> rs = {
        {{1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6}, {1.0 / 6, 2.0 / 3}}};
    std::array<Gradients, 6> g;
    for (int k = 0; k < 3; ++k) {
      g[k] = shapeGradients(rs[k][0], rs[k][1], -z);
      g[k + 3] = shapeGradients(rs[k][0], rs[k][1], z);
    }
    return g;
  }();
  return all;
}
const std::array<Gradients, 6>& nodeGradients() {
  static const std::array<Gradients, 6> all = [] {
    std::array<Gradients, 6> g;
    for (int k = 0; k < 6; ++k) g[k] = shapeGradients(k % 3 == 1, k % 3 == 2, k < 3 ? -1 : 1);
    return g;
  }();
  return all;
}
}  // namespace

double wedgeVolume(const Wedge& w) {
  double volume = 0;
  for (const Gradients& g : gaussGradients()) volume += kGaussWeight * jacobian(w, g).determinant();
  return volume;
}

double wedgeMinJacobian(const Wedge& w) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto* set : {&gaussGradients(), &nodeGradients()})
    for (const Gradients& g : *set) least = std::min(least, jacobian(w, g).determinant());
  return least;
}

Mat3 wedgeStrain(const Wedge& rest, const Wedge& now) {
  Mat3 sum = Mat3::Zero();
  double volume = 0;
  for (const Gradients& g : gaussGradients()) {
    const Mat3 restJacobian = jacobian(rest, g);
    const double weight = kGaussWeight * restJacobian.determinant();
    const Mat3 f = jacobian(now, g) * restJacobian.inverse();
    sum += weight * 0.5 * (f.transpose() * f - Mat3::Identity());
    volume += weight;
  }
  return sum / volume;
}
}  // namespace swallowclip::biomech
