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

/// Tabulated W, slope / r and F / r with F(r) = r^-2 * int_0^r W s^2 ds (so F = 1 / (4 pi r^2) from
/// H on): all that the neighbour lists and the wall integrals need. G(r) = 1 / (4 pi r^2) - F(r) is
/// zero beyond H. Linear between 2048 nodes: within 1e-6 of the value at 0.
class KernelTable {
 public:
  static constexpr int kIntervals = 2048;
  struct Pair {
    float w, wStep, slope, slopeStep;  ///< of W and slope / r, and their growth to the next node
  };
  struct Wall {
    float w, wStep, f, fStep;  ///< of W and F / r
  };
  explicit KernelTable(const Kernel& kernel);

  double support_m() const { return support_m_; }
  float nodesPerMetre() const { return static_cast<float>(kIntervals / support_m_); }
  const Pair* pairs() const { return pairs_.data(); }  ///< [kIntervals + 1], the last one zero
  const Wall* walls() const { return walls_.data(); }  ///< [kIntervals + 1]
  double selfW() const { return selfW_; }
  /// The cubic spline is cheaper by its formulas (bolus/cubic_spline.h) than by its table.
  bool isCubicSpline() const { return cubicSpline_; }

 private:
  double support_m_, selfW_;
  bool cubicSpline_;
  std::vector<Pair> pairs_;
  std::vector<Wall> walls_;
};
}  // namespace swallowclip::bolus
