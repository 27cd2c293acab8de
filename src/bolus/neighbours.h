// SPDX-License-Identifier: MIT
// Who is within a kernel support of whom: counting-sort grid, then flat lists (CSR) with the
// kernel gradient cached, since the projections and the viscosity walk them many times a step.
#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "bolus/kernels.h"
#include "bolus/sweeps.h"
#include "core/parallel.h"
#include "core/vec.h"

namespace swallowclip::bolus {

/// Points sorted into cubic cells; cell c holds order[start[c]] .. order[start[c + 1] - 1].
/// Points of one cell keep their index order, so that every sum has a fixed order.
class PointGrid {
 public:
  /// Only points with take[i] != 0 enter; an empty `take` takes all.
  void build(std::span<const Vec3> points, std::span<const std::uint8_t> take, double cell_m);

  /// Calls visit(first, last) for each row of the cells within reach_m of p along every axis:
  /// places in order().
  template <class Visit>
  void rowsAround(const Vec3& p, double reach_m, Visit&& visit) const {
    if (order_.empty()) return;
    const Vec3 reach = Vec3::Constant(reach_m);
    const Eigen::Vector3i low = cellOf(p - reach).cwiseMax(0),
                          high = cellOf(p + reach).cwiseMin(size_.array().matrix() - kOne);
    if (low.x() > high.x()) return;
    for (int z = low.z(); z <= high.z(); ++z)
      for (int y = low.y(); y <= high.y(); ++y) {
        const int row = (z * size_.y() + y) * size_.x();
        const int first = start_[row + low.x()], last = start_[row + high.x() + 1];
        if (first < last) visit(first, last);
      }
  }

  const std::vector<int>& order() const { return order_; }

 private:
  Eigen::Vector3i cellOf(const Vec3& p) const {  // one outside at most, so that rows are few
    const Eigen::Array3d at = ((p - low_) / cell_m_).array().floor();
    return at.max(-1).min(size_.cast<double>().array()).cast<int>();
  }

  static inline const Eigen::Vector3i kOne = Eigen::Vector3i::Ones();
  double cell_m_ = 1;
  Vec3 low_ = Vec3::Zero();
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  std::vector<int> start_, order_, cell_;
};

/// The active particles in the order of their cells, so that neighbours lie near each other in
/// memory: "slots". Lists are as long as whole vectors; what fills them up names the slot `count`
/// and has gradient zero. Gradients are floats and exactly antisymmetric.
struct Neighbours {
  int count = 0;                  ///< slots
  std::vector<int> id;            ///< [count] particle of a slot
  std::vector<int> slot;          ///< [particle] its slot, or -1
  std::vector<int> start, stop;   ///< [count + 1], [count] of each list, in whole vectors (kLanes)
  std::vector<int> index;         ///< slots of the neighbours
  std::vector<float> gx, gy, gz;  ///< V gradW(x_i - x_j) at x_i (1/m)
  std::vector<float> r;           ///< distances, m
  std::vector<double> sumW;       ///< [count] V times the sum of W, the particle itself included
  Floats3 sumG;                   ///< [count] sum of the gradients, 1/m
  Tensors moment;                 ///< [count] sum of r |g| n n, n along the pair: one when full

  /// `take` [particle] says who is active. With a period, images count as neighbours too. Who might
  /// be a neighbour is looked for within `skin_m` more than the kernel reaches. `then` is called
  /// for ranges of slots that are done.
  using Range = std::function<void(int begin, int end)>;
  void build(std::span<const Vec3> points, std::span<const std::uint8_t> take,
             const KernelTable& kernel, double volume_m3, const Vec3& period_m, double skin_m,
             ThreadPool& pool, const Range& then = {});
  /// The same particles in new places, of whom nobody has moved by more than half the skin since
  /// they were built; else, or when others are active, nothing is done and false returned.
  bool follow(std::span<const Vec3> points, std::span<const std::uint8_t> take,
              const KernelTable& kernel, double volume_m3, ThreadPool& pool,
              const Range& then = {});

  /// The particles have got new numbers: those of their slots, and who has none the others.
  void renumber();

  PairLists lists() const {
    return {start.data(), stop.data(), index.data(), gx.data(), gy.data(), gz.data()};
  }

  /// Particles at their last places that are within a kernel support of p, and how far away (m).
  struct Near {
    int particle;
    double away_m;
  };
  void around(const Vec3& p, std::vector<Near>& out) const;

 private:
  struct Found {
    std::vector<int> places, length;
  };
  void sortIntoCells(std::span<const Vec3> points, std::span<const std::uint8_t> take,
                     double cell_m, const Vec3& period_m, ThreadPool& pool);
  void search(int begin, int end, float reach_m, Found& out) const;
  void measure(const KernelTable& kernel, double volume_m3, ThreadPool& pool, const Range& then);

  static inline const Eigen::Vector3i kOne = Eigen::Vector3i::Ones();
  int cellAlong(float x_m, int axis) const {
    return std::min(static_cast<int>(x_m / cell_m_), size_[axis] - 1);
  }
  Eigen::Vector3i cellOf(int place) const {  // when built
    return {cellAlong(sx_[place], 0), cellAlong(sy_[place], 1), cellAlong(sz_[place], 2)};
  }

  // sorted places, images of periodic neighbours among them, and one more far away from all
  Vec3 low_ = Vec3::Zero();
  double cell_m_ = 1, support_m_ = 0, skin_m_ = 0;
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  std::vector<int> cellStart_, owner_, self_;  // owner: [place] slot; self: [count] place of a slot
  std::vector<Vec3> shift_;                    // [place] of an image
  std::vector<float> sx_, sy_, sz_;            // [place] when built, from the low corner
  Floats3 places_;                             // [place] now
  std::vector<Vec3> builtAt_;                  // [count]
  std::vector<Found> found_;
  std::vector<int> candidates_;  // places, as `index`
};
}  // namespace swallowclip::bolus
