// SPDX-License-Identifier: MIT
// How far points lie from a sheet of the airway-skin, frame after frame.
#pragma once
#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "core/tri_mesh.h"

namespace swallowclip::scoring {

/// Distances to one sheet, frame after frame. Triangles farther than the best found so far are
/// left out by their bounding balls, and each asker starts from its last answer.
class SheetDistance {
 public:
  SheetDistance(std::vector<Triangle> triangles, std::size_t askers)
      : triangles_(std::move(triangles)), balls_(triangles_.size()), guess_(askers, 0) {}

  void setFrame(std::span<const Vec3f> x) {
    x_ = x;
    for (std::size_t k = 0; k < triangles_.size(); ++k) {
      const Triangle& t = triangles_[k];
      const Vec3f c = (x[t[0]] + x[t[1]] + x[t[2]]) / 3;
      float r = 0;
      for (int v : t) r = std::max(r, (x[v] - c).norm());
      constexpr double kRounding = 1 + 1e-5;  // float centre and radius
      balls_[k] = {c.cast<double>(), r * kRounding};
    }
  }

  /// The sheet may not be empty.
  double operator()(std::size_t asker, const Vec3& p) {
    int& guess = guess_[asker];
    double best = exact(guess, p);
    for (int k = 0; k < static_cast<int>(triangles_.size()); ++k) {
      if (balls_[k].radius + best <= (p - balls_[k].centre).norm()) continue;
      const double d = exact(k, p);
      if (d < best) best = d, guess = k;
    }
    return best;
  }

 private:
  struct Ball {
    Vec3 centre;
    double radius = 0;
  };

  double exact(int k, const Vec3& p) const {
    const Triangle& t = triangles_[k];
    const Vec3 a = x_[t[0]].cast<double>(), b = x_[t[1]].cast<double>(),
               c = x_[t[2]].cast<double>();
    const Vec3 w = closestBarycentric(p, a, b, c);
    return (p - (w[0] * a + w[1] * b + w[2] * c)).norm();
  }

  std::vector<Triangle> triangles_;
  std::vector<Ball> balls_;
  std::vector<int> guess_;
  std::span<const Vec3f> x_;
};
}  // namespace swallowclip::scoring
