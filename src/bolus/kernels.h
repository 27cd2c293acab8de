// SPDX-License-Identifier: MIT
// Smoothing kernels in three dimensions, all with compact support H (m) and unit integral.
// r is a distance in metres; w in 1/m^3, its slope in 1/m^4.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace swallowclip::bolus {

enum class KernelKind { lucy, gaussian, cubicSpline, quarticSpline, wendlandC2 };

const char* name(KernelKind kind);
/// Names as in scene files: lucy, gaussian, cubic-spline, quartic-spline, wendland-c2.
Result<KernelKind> kernelFromName(std::string_view word);
/// Support H in particle spacings. A cubic spline of 2 sums to 1.0000 on a cubic lattice.
double supportPerSpacing(KernelKind kind);

class Kernel {
 public:
  Kernel(KernelKind kind, double support_m);

  KernelKind kind() const { return kind_; }
  double support_m() const { return support_m_; }
  double w(double r_m) const;
  double slope(double r_m) const;  ///< dW/dr, never positive

  /// Sum of spacing^3 W over a cubic lattice: what the kernel calls the rest density.
  double latticeSum(double spacing_m) const;

 private:
  KernelKind kind_;
  double support_m_, h_m_, scale_;
};

/// Tabulated W and F(r) = r^-2 * int_0^r W s^2 ds (so F = 1 / (4 pi r^2) from H on), the two
/// functions that the wall integrals need. G(r) = 1 / (4 pi r^2) - F(r) is zero beyond H.
class KernelTable {
 public:
  struct Entry {
    double w, f;
  };
  explicit KernelTable(const Kernel& kernel);
  double support_m() const { return support_m_; }
  Entry at(double r_m) const {
    const double x = r_m * perMetre_;
    const int i = static_cast<int>(x);
    if (i >= kIntervals) return {0, 1 / (kFourPi * r_m * r_m)};
    const double t = x - i;
    const Entry &a = entries_[i], &b = entries_[i + 1];
    return {a.w + t * (b.w - a.w), a.f + t * (b.f - a.f)};
  }

 private:
  static constexpr int kIntervals = 2048;  // linear interpolation error below 1e-6 of W(0)
  static constexpr double kFourPi = 12.566370614359172;
  double support_m_, perMetre_;
  std::vector<Entry> entries_;
};
}  // namespace swallowclip::bolus
