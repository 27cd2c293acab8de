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
#include "bolus/point_grid.h"
#include "bolus/sweeps.h"
#include "core/parallel.h"
#include "core/vec.h"

namespace swallowclip::bolus {

/// The active particles in the order of their cells, so that neighbours lie near each other in
/// memory: "slots". Lists are as long as whole vectors; what fills them up names the slot `count`
/// and has gradient zero. Gradients are floats and exactly antisymmetric.
struct Neighbours {
  int count = 0;                  ///< slots
  std::vector<int> id;            ///< [count] particle of a slot
  std::vector<int> slot;          ///< [particle] its slot, or -1
  std::vector<int> start, stop;   ///< [count] of each list, in whole vectors (kLanes)
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

  /// The first half of build, and of follow: who might be a neighbour, within reach_m + skin_m, and
  /// where all are, but no gradients. For sweeps that go through candidates once.
  void collect(std::span<const Vec3> points, std::span<const std::uint8_t> take, double reach_m,
               double skin_m, const Vec3& period_m, ThreadPool& pool);
  bool carry(std::span<const Vec3> points, std::span<const std::uint8_t> take, ThreadPool& pool);
  PlaceLists candidates() const {
    return {places_.data(), self_.data(), candidateStart_.data(), candidates_.data()};
  }
  double skin_m() const { return skin_m_; }
  /// What was collected serves no more.
  void forget() { slot.clear(); }

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
  static constexpr int kChunk = 64;          // particles per work item
  static constexpr int kPlacesAlone = 1000;  // are set sooner than a thread wakes, assumed (500 to
                                             // 2000)
  static constexpr float kFarAway = 1e18f;   // m; fills vectors up, its square is still a number

  struct Found {
    std::vector<int> places, length;
  };
  void sortIntoCells(std::span<const Vec3> points, std::span<const std::uint8_t> take,
                     double cell_m, const Vec3& period_m, ThreadPool& pool);
  void search(int begin, int end, float reach_m, Found& out) const;
  int pickNear(int begin, int end);
  void measure(const KernelTable& kernel, double volume_m3, ThreadPool& pool, const Range& then);

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
  // places: who might be a neighbour, from candidateStart_ [count + 1] on; who is, of a chunk one
  // behind the other
  std::vector<int> candidates_, candidateStart_, near_;
};
}  // namespace swallowclip::bolus
