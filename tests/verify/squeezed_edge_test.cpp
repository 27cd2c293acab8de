// SPDX-License-Identifier: MIT
// What squeezedEdge_m says against Stokes' equations of half a strip between plates that close,
// with a bulging free edge: unknowns on a staggered grid, stresses on its cells' faces and corners.
#include <gtest/gtest.h>

#include <Eigen/Sparse>
#include <Eigen/SparseLU>
#include <cmath>
#include <utility>
#include <vector>

#include "core/vec.h"
#include "verify/analytic.h"

using namespace swallowclip;
using namespace swallowclip::verify;

namespace {
/// Lengths in gaps, speeds in that of the plates towards each other, viscosity 1.
class Strip {
 public:
  /// Wet half length, area of the bulge (part of a disc), cells across the gap.
  Strip(double wet, double bulge, int across)
      : wet_(wet), across_(across), cell_(1.0 / across), along_(int((wet + 0.55) * across) + 2) {
    double low = 1e-6, high = kPi / 2;  // half the angle under which the disc's centre sees it
    for (int k = 0; k < 60; ++k) {
      const double angle = (low + high) / 2, radius = 0.5 / std::sin(angle);
      const double area = radius * radius * (angle - std::sin(angle) * std::cos(angle));
      (area < bulge ? low : high) = angle;
    }
    radius_ = 0.5 / std::sin(low);
    centre_ = wet - radius_ * std::cos(low);
    bulges_ = bulge > 0;
    number();
    solve();
  }
  /// Where 6 (x0^2 - x^2), as high as the mean pressure across the gap at x, is zero.
  double zeroOfPressure(double x) const {
    const int i = static_cast<int>(x / cell_);
    double mean = 0;
    for (int j = 0; j < across_; ++j) mean += solution_[p(i, j)] * cell_;
    return std::sqrt(mean / 6 + std::pow((i + 0.5) * cell_, 2));
  }

 private:
  using Sum = std::vector<std::pair<int, double>>;  // unknown, factor
  static constexpr int kKnown = -2;                 // in place of an unknown: the number 1

  bool inside(int i, int j) const {
    if (i < 0 || j < 0 || j >= across_ || i >= along_) return false;
    const double x = (i + 0.5) * cell_, y = (j + 0.5) * cell_;
    if (x < wet_) return true;
    return bulges_ && std::pow(x - centre_, 2) + std::pow(y - 0.5, 2) < radius_ * radius_;
  }
  bool onPlate(int i, int j) const { return (j == 0 || j == across_) && (i + 0.5) * cell_ < wet_; }
  int& u(int i, int j) { return u_[i * across_ + j]; }
  int& v(int i, int j) { return v_[i * (across_ + 1) + j]; }
  int p(int i, int j) const { return p_[i * across_ + j]; }

  void number() {
    u_.assign((along_ + 1) * across_, -1);
    v_.assign(along_ * (across_ + 1), -1);
    p_.assign(along_ * across_, -1);
    for (int i = 0; i <= along_; ++i)
      for (int j = 0; j < across_; ++j)
        if (inside(i, j) || inside(i - 1, j)) u(i, j) = count_++;
    for (int i = 0; i < along_; ++i)
      for (int j = 0; j <= across_; ++j)
        if ((inside(i, j) || inside(i, j - 1)) && !onPlate(i, j)) v(i, j) = count_++;
    for (int i = 0; i < along_; ++i)
      for (int j = 0; j < across_; ++j)
        if (inside(i, j)) p_[i * across_ + j] = count_++;
  }

  void addU(Sum& s, int i, int j, double w) {
    if (u(i, j) >= 0) s.push_back({u(i, j), w});
  }
  void addV(Sum& s, int i, int j, double w) {
    if (v(i, j) >= 0)
      s.push_back({v(i, j), w});
    else if (onPlate(i, j))
      s.push_back({kKnown, j == 0 ? w / 2 : -w / 2});
  }
  Sum alongStress(int i, int j) {
    Sum s;
    if (!inside(i, j)) return s;
    s.push_back({p(i, j), -1});
    addU(s, i + 1, j, 2 / cell_), addU(s, i, j, -2 / cell_);
    return s;
  }
  Sum acrossStress(int i, int j) {
    Sum s;
    if (!inside(i, j)) return s;
    s.push_back({p(i, j), -1});
    addV(s, i, j + 1, 2 / cell_), addV(s, i, j, -2 / cell_);
    return s;
  }
  Sum shearStress(int i, int j) {  // at the cell's lower corner towards the middle
    Sum s;
    if (j == 0 || j == across_) {
      if (i * cell_ < wet_ - 1e-9) addU(s, i, j == 0 ? 0 : j - 1, (j == 0 ? 2 : -2) / cell_);
      return s;
    }
    const bool full =
        i > 0 && inside(i, j) && inside(i - 1, j) && inside(i, j - 1) && inside(i - 1, j - 1);
    if (!full) return s;  // a free surface, or the plane of symmetry
    addU(s, i, j, 1 / cell_), addU(s, i, j - 1, -1 / cell_);
    addV(s, i, j, 1 / cell_), addV(s, i - 1, j, -1 / cell_);
    return s;
  }

  void solve() {
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count_);
    const auto put = [&](int row, const Sum& sum, double w) {
      for (const auto& [unknown, factor] : sum)
        if (unknown == kKnown)
          right[row] -= w * factor;
        else
          entries.emplace_back(row, unknown, w * factor);
    };
    for (int i = 0; i <= along_; ++i)
      for (int j = 0; j < across_; ++j) {
        const int row = u(i, j);
        if (row < 0) continue;
        if (i == 0) {
          entries.emplace_back(row, row, 1);
          continue;
        }
        put(row, alongStress(i, j), 1), put(row, alongStress(i - 1, j), -1);
        put(row, shearStress(i, j + 1), 1), put(row, shearStress(i, j), -1);
      }
    for (int i = 0; i < along_; ++i)
      for (int j = 0; j <= across_; ++j) {
        const int row = v(i, j);
        if (row < 0) continue;
        put(row, shearStress(i + 1, j), 1), put(row, shearStress(i, j), -1);
        put(row, acrossStress(i, j), 1), put(row, acrossStress(i, j - 1), -1);
      }
    for (int i = 0; i < along_; ++i)
      for (int j = 0; j < across_; ++j) {
        if (!inside(i, j)) continue;
        Sum outflow;
        addU(outflow, i + 1, j, 1), addU(outflow, i, j, -1);
        addV(outflow, i, j + 1, 1), addV(outflow, i, j, -1);
        put(p(i, j), outflow, 1);
      }
    Eigen::SparseMatrix<double> matrix(count_, count_);
    matrix.setFromTriplets(entries.begin(), entries.end());
    matrix.makeCompressed();
    const Eigen::SparseLU<Eigen::SparseMatrix<double>> lu(matrix);
    EXPECT_EQ(lu.info(), Eigen::Success);
    if (lu.info() == Eigen::Success)
      solution_ = lu.solve(right);
    else
      solution_.setConstant(count_, NAN);
  }

  double wet_;
  int across_;
  double cell_;
  int along_;
  double radius_ = 0, centre_ = 0;
  bool bulges_ = false;
  int count_ = 0;
  std::vector<int> u_, v_, p_;
  Eigen::VectorXd solution_;
};
}  // namespace

TEST(SqueezedEdge, StokesEquationsAgree) {
  for (const double wet : {4.0, 6.0, 9.0})
    for (const double bulge : {0.0, 0.2, kPi / 8}) {
      // the free edge is made of cells: an error of first order
      const double x = 0.6 * wet, coarse = Strip(wet, bulge, 20).zeroOfPressure(x),
                   fine = Strip(wet, bulge, 40).zeroOfPressure(x);
      const SqueezedEdge edge = squeezedEdge_m(wet, wet + bulge, 1);
      EXPECT_NEAR(edge.contact, wet, 1e-12);
      EXPECT_NEAR(edge.zero, 2 * fine - coarse, 0.02) << "wet " << wet << " bulge " << bulge;
    }
}

TEST(SqueezedEdge, RollsOnceItIsHalfRound) {
  const SqueezedEdge edge = squeezedEdge_m(5, 6, 0.5);
  EXPECT_NEAR(edge.contact, 6 - 0.5 * kPi / 8, 1e-12);
  EXPECT_GT(edge.contact, 5);
}
