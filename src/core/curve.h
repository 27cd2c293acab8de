// SPDX-License-Identifier: MIT
// Shape-preserving piecewise cubic (Fritsch & Carlson 1980): C1, never overshoots its control
// points, constant outside them. Also the easing functions of the motion tracks.
#pragma once
#include <vector>

namespace swallowclip {

class Curve {
 public:
  Curve() = default;
  /// Knots `x` strictly increasing, one value each; at least one knot.
  Curve(std::vector<double> x, std::vector<double> y);
  double operator()(double x) const;
  double slope(double x) const;
  /// The same curve, by this much later in x.
  Curve shifted(double by) const;
  /// The x at which a rising curve comes to y; its ends' for what is beyond.
  double reaches(double y) const;
  bool empty() const { return x_.empty(); }
  double front() const { return x_.front(); }
  double back() const { return x_.back(); }

 private:
  std::size_t interval(double x) const;
  std::vector<double> x_, y_, m_;
};

/// 0 below 0, 1 above 1, 3x^2-2x^3 between: C1.
double smoothstep(double x);
/// Minimum-jerk ease 10x^3-15x^4+6x^5 (Flash & Hogan 1985): C2, clamped to 0..1.
double minimumJerk(double x);
/// Smooth bump: 0 outside (a,d), 1 on [b,c], smoothstep between.
double plateau(double x, double a, double b, double c, double d);
}  // namespace swallowclip
