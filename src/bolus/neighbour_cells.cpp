// SPDX-License-Identifier: MIT
// Particles by the cells that they lie in.
#include <algorithm>
#include <cmath>

#include "bolus/neighbours.h"
#include "core/simd.h"

namespace swallowclip::bolus {

// Slots in the order of cells, images among them in the same sort.
void Neighbours::sortIntoCells(std::span<const Vec3> points, std::span<const std::uint8_t> take,
                               double cell_m, const Vec3& period_m, ThreadPool& pool) {
  struct Image {
    int id;
    Vec3 shift;
  };
  std::vector<int> taken;  // then come the images
  taken.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    if (take.empty() || take[i]) taken.push_back(static_cast<int>(i));
  count = static_cast<int>(taken.size());
  std::vector<Image> images;
  const auto idOf = [&](int k) { return k < count ? taken[k] : images[k - count].id; };
  const auto shiftOf = [&](int k) {
    return k < count ? Vec3::Zero().eval() : images[k - count].shift;
  };
  const auto placeOf = [&](int k) -> Vec3 { return points[idOf(k)] + shiftOf(k); };
  for (int axis = 0; axis < 3; ++axis) {
    if (period_m[axis] <= 0) continue;
    for (int k = 0, n = count + static_cast<int>(images.size()); k < n; ++k)
      for (const double shift : {-period_m[axis], period_m[axis]}) {
        Image image{idOf(k), shiftOf(k)};
        image.shift[axis] += shift;
        const double x = (points[image.id] + image.shift)[axis];
        if (x > -cell_m && x < period_m[axis] + cell_m) images.push_back(image);
      }
  }
  const int total = count + static_cast<int>(images.size());
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (int k = 0; k < total; ++k) {
    const Vec3 x = placeOf(k);
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  if (total == 0) low = high = Vec3::Zero();
  low_ = low;
  for (cell_m_ = cell_m;; cell_m_ *= 2) {
    const Vec3 n = ((high - low) / cell_m_).array().floor() + 1;
    if (n.prod() > kMaxCells && cell_m_ < 1e6) continue;
    size_ = n.cast<int>();
    break;
  }
  std::vector<int> cell(total), order(total);
  const auto each = [&](const std::function<void(int, int, int)>& body) {
    pool.forChunks(total, kChunk, body, kPlacesAlone);
  };
  each([&](int begin, int end, int) {
    for (int k = begin; k < end; ++k) {
      const Eigen::Vector3f f = (placeOf(k) - low_).cast<float>();
      cell[k] =
          (cellAlong(f.z(), 2) * size_.y() + cellAlong(f.y(), 1)) * size_.x() + cellAlong(f.x(), 0);
    }
  });
  cellStart_.assign(size_.prod() + 1, 0);
  for (const int c : cell) ++cellStart_[c + 1];
  for (std::size_t c = 1; c < cellStart_.size(); ++c) cellStart_[c] += cellStart_[c - 1];
  std::vector<int> next(cellStart_.begin(), cellStart_.end() - 1);
  for (int k = 0; k < total; ++k) order[next[cell[k]]++] = k;

  id.resize(count);
  self_.resize(count);
  builtAt_.resize(count);
  slot.assign(points.size(), -1);
  int slots = 0;
  for (int s = 0; s < total; ++s)
    if (order[s] < count) {
      id[slots] = taken[order[s]];
      self_[slots] = s;
      slot[id[slots]] = slots;
      ++slots;
    }
  owner_.resize(total + 1);
  owner_[total] = count;
  shift_.resize(total);
  for (auto* s : {&sx_, &sy_, &sz_}) {
    s->resize(total + simd::kLanes);
    std::fill(s->begin() + total, s->end(), kFarAway);
  }
  places_.shape(total, 1);
  places_.set(total, Vec3::Constant(-kFarAway));
  each([&](int begin, int end, int) {
    for (int s = begin; s < end; ++s) {
      const int k = order[s];
      const Vec3 x = placeOf(k);
      owner_[s] = slot[idOf(k)];
      if (k < count) builtAt_[owner_[s]] = x;
      shift_[s] = shiftOf(k);
      places_.set(s, x - low_);
      sx_[s] = places_[s][0];
      sy_[s] = places_[s][1];
      sz_[s] = places_[s][2];
    }
  });
}

void Neighbours::around(const Vec3& p, std::vector<Near>& out) const {
  out.clear();
  if (count == 0) return;
  const Vec3 at = p - low_;
  Eigen::Vector3i from, to;
  for (int a = 0; a < 3; ++a) {
    // in their cells particles lie where they were built
    const double reach = support_m_ + skin_m_ / 2;
    const auto cell = [&](double x) {
      return static_cast<int>(std::floor(std::clamp(x / cell_m_, -2.0, size_[a] + 1.0)));
    };
    from[a] = std::max(cell(at[a] - reach), 0);
    to[a] = std::min(cell(at[a] + reach), size_[a] - 1);
  }
  if (from.x() > to.x()) return;
  for (int cz = from.z(); cz <= to.z(); ++cz)
    for (int cy = from.y(); cy <= to.y(); ++cy) {
      const int row = (cz * size_.y() + cy) * size_.x();
      for (int k = cellStart_[row + from.x()]; k < cellStart_[row + to.x() + 1]; ++k) {
        const double away_m = (places_.at(k).cast<double>() - at).norm();
        if (away_m < support_m_) out.push_back({id[owner_[k]], away_m});
      }
    }
}

void Neighbours::renumber() {
  for (int k = 0; k < static_cast<int>(slot.size()); ++k) slot[k] = k < count ? k : -1;
  for (int k = 0; k < count; ++k) id[k] = k;
}
}  // namespace swallowclip::bolus
