// SPDX-License-Identifier: MIT
#include "core/curve.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace swallowclip {

Curve::Curve(std::vector<double> x, std::vector<double> y) : x_(std::move(x)), y_(std::move(y)) {
  CHECK_EQ(x_.size(), y_.size());
  CHECK_GT(x_.size(), 0u);
  const std::size_t n = x_.size();
  m_.assign(n, 0.0);
  if (n < 2) return;
  std::vector<double> d(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    CHECK_LT(x_[i], x_[i + 1]);
    d[i] = (y_[i + 1] - y_[i]) / (x_[i + 1] - x_[i]);
  }
  // End slopes one-sided; interior ones by the weighted harmonic mean (zero at local extrema).
  m_.front() = d.front();
  m_.back() = d.back();
  for (std::size_t i = 1; i + 1 < n; ++i) {
    if (d[i - 1] * d[i] <= 0) continue;
    const double h0 = x_[i] - x_[i - 1], h1 = x_[i + 1] - x_[i];
    const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
    m_[i] = (w0 + w1) / (w0 / d[i - 1] + w1 / d[i]);
  }
}

std::size_t Curve::interval(double x) const {
  const auto it = std::upper_bound(x_.begin(), x_.end(), x);
  const auto i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, it - x_.begin() - 1));
  return std::min(i, x_.size() - 2);
}

double Curve::operator()(double x) const {
  if (x <= x_.front() || x_.size() == 1) return y_.front();
  if (x >= x_.back()) return y_.back();
  const std::size_t i = interval(x);
  const double h = x_[i + 1] - x_[i], t = (x - x_[i]) / h;
  const double t2 = t * t, t3 = t2 * t;
  return y_[i] * (2 * t3 - 3 * t2 + 1) + h * m_[i] * (t3 - 2 * t2 + t) +
         y_[i + 1] * (3 * t2 - 2 * t3) + h * m_[i + 1] * (t3 - t2);
}

Curve Curve::shifted(double by) const {
  Curve later = *this;
  for (double& x : later.x_) x += by;
  return later;
}

double Curve::reaches(double y) const {
  double low = x_.front(), high = x_.back();
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    ((*this)(middle) < y ? low : high) = middle;
  }
  return high;
}

double Curve::slope(double x) const {
  if (x < x_.front() || x > x_.back() || x_.size() == 1) return 0;
  const std::size_t i = interval(x);
  const double h = x_[i + 1] - x_[i], t = (x - x_[i]) / h;
  return (y_[i + 1] - y_[i]) / h * (6 * t - 6 * t * t) + m_[i] * (3 * t * t - 4 * t + 1) +
         m_[i + 1] * (3 * t * t - 2 * t);
}

double smoothstep(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

double minimumJerk(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (10 + x * (6 * x - 15));
}

double plateau(double x, double a, double b, double c, double d) {
  return smoothstep((x - a) / (b - a)) * (1 - smoothstep((x - c) / (d - c)));
}
}  // namespace swallowclip
