// SPDX-License-Identifier: MIT
#include "bolus/neighbours.h"

#include <algorithm>
#include <cmath>

#include "bolus/cubic_spline.h"
#include "core/simd.h"

namespace swallowclip::bolus {
namespace {
constexpr int kChunk = 128;         // particles per work item
constexpr float kFarAway = 1e18f;   // m; fills vectors up, its square is still a number
constexpr int kMaxCells = 1 << 21;  // a stray particle must not cost the memory of a continent
}  // namespace

Eigen::Vector3i PointGrid::cellOf(const Vec3& p) const {
  // clamped to one cell outside the box, so that far queries visit nothing
  Eigen::Vector3i c;
  for (int k = 0; k < 3; ++k)
    c[k] =
        static_cast<int>(std::floor(std::clamp((p[k] - low_[k]) / cell_m_, -2.0, size_[k] + 1.0)));
  return c;
}

void PointGrid::build(std::span<const Vec3> points, std::span<const std::uint8_t> take,
                      double cell_m) {
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  auto taken = [&](std::size_t i) { return take.empty() || take[i] != 0; };
  int count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!taken(i)) continue;
    low = low.cwiseMin(points[i]);
    high = high.cwiseMax(points[i]);
    ++count;
  }
  order_.assign(count, 0);
  if (count == 0) return;
  low_ = low;
  cell_m_ = cell_m;
  for (;;) {
    const Vec3 n = ((high - low) / cell_m_).array().floor() + 1;
    if (n.prod() <= kMaxCells) {
      size_ = n.cast<int>();
      break;
    }
    cell_m_ *= 2;
  }
  start_.assign(size_.prod() + 1, 0);
  cell_.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!taken(i)) continue;
    const Eigen::Vector3i c =
        cellOf(points[i]).cwiseMin(size_.array().matrix() - Eigen::Vector3i::Ones());
    cell_[i] = (c.z() * size_.y() + c.y()) * size_.x() + c.x();
    ++start_[cell_[i] + 1];
  }
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  std::vector<int> next(start_.begin(), start_.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (taken(i)) order_[next[cell_[i]]++] = static_cast<int>(i);
}

// Slots in the order of cells, images behind them in the same sort.
void Neighbours::sortIntoCells(std::span<const Vec3> points, std::span<const std::uint8_t> take,
                               double cell_m, const Vec3& period_m) {
  struct Point {
    Vec3 x;
    int id;
    bool image;
  };
  std::vector<Point> all;
  all.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    if (take.empty() || take[i]) all.push_back({points[i], static_cast<int>(i), false});
  count = static_cast<int>(all.size());
  for (int axis = 0; axis < 3; ++axis) {
    if (period_m[axis] <= 0) continue;
    for (std::size_t i = 0, n = all.size(); i < n; ++i)
      for (const double shift : {-period_m[axis], period_m[axis]}) {
        Point p = all[i];
        p.x[axis] += shift;
        p.image = true;
        if (p.x[axis] > -cell_m && p.x[axis] < period_m[axis] + cell_m) all.push_back(p);
      }
  }
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (const Point& p : all) {
    low = low.cwiseMin(p.x);
    high = high.cwiseMax(p.x);
  }
  if (all.empty()) low = high = Vec3::Zero();
  low_ = low;
  for (cell_m_ = cell_m;; cell_m_ *= 2) {
    const Vec3 n = ((high - low) / cell_m_).array().floor() + 1;
    if (n.prod() > kMaxCells && cell_m_ < 1e6) continue;
    size_ = n.cast<int>();
    break;
  }
  const int total = static_cast<int>(all.size());
  std::vector<int> cell(total);
  cellStart_.assign(size_.prod() + 1, 0);
  for (int i = 0; i < total; ++i) {
    const Eigen::Vector3f f = (all[i].x - low_).cast<float>();
    cell[i] =
        (cellAlong(f.z(), 2) * size_.y() + cellAlong(f.y(), 1)) * size_.x() + cellAlong(f.x(), 0);
    ++cellStart_[cell[i] + 1];
  }
  for (std::size_t c = 1; c < cellStart_.size(); ++c) cellStart_[c] += cellStart_[c - 1];
  std::vector<int> next(cellStart_.begin(), cellStart_.end() - 1), order(total);
  for (int i = 0; i < total; ++i) order[next[cell[i]]++] = i;

  id.resize(count);
  self_.resize(count);
  slot.assign(points.size(), -1);
  owner_.resize(total);
  for (auto* s : {&sx_, &sy_, &sz_}) s->assign(total + simd::kLanes, kFarAway);
  for (auto* s : {&x, &y, &z}) s->assign(count + simd::kLanes, 0.f);
  int k = 0;
  for (int s = 0; s < total; ++s) {
    const Point& p = all[order[s]];
    if (!p.image) {
      id[k] = p.id;
      self_[k] = s;
      slot[p.id] = k++;
    }
    const Eigen::Vector3f f = (p.x - low_).cast<float>();
    sx_[s] = f.x();
    sy_[s] = f.y();
    sz_[s] = f.z();
  }
  for (int s = 0; s < total; ++s) owner_[s] = slot[all[order[s]].id];
  for (int i = 0; i < count; ++i) {
    x[i] = sx_[self_[i]];
    y[i] = sy_[self_[i]];
    z[i] = sz_[self_[i]];
  }
}

void Neighbours::around(const Vec3& p, std::vector<Near>& out) const {
  out.clear();
  if (count == 0) return;
  const Vec3 at = p - low_;
  Eigen::Vector3i from, to;
  for (int a = 0; a < 3; ++a) {
    const int cell =
        static_cast<int>(std::floor(std::clamp(at[a] / cell_m_, -2.0, size_[a] + 1.0)));
    from[a] = std::max(cell - 1, 0);
    to[a] = std::min(cell + 1, size_[a] - 1);
  }
  if (from.x() > to.x()) return;
  for (int cz = from.z(); cz <= to.z(); ++cz)
    for (int cy = from.y(); cy <= to.y(); ++cy) {
      const int row = (cz * size_.y() + cy) * size_.x();
      for (int k = cellStart_[row + from.x()]; k < cellStart_[row + to.x() + 1]; ++k)
        out.push_back({id[owner_[k]], (Vec3(sx_[k], sy_[k], sz_[k]) - at).norm()});
    }
}

namespace {
/// Places within reach of (x, y, z) among the sorted points [begin, end); returns how many.
SC_CLONES int within(const float* sx, const float* sy, const float* sz, int begin, int end, float x,
                     float y, float z, float reach2, int* out) {
  using namespace simd;
  int found = 0;
  for (int k = begin; k < end; k += kLanes) {
    const F8 dx = all(x) - load(sx + k), dy = all(y) - load(sy + k), dz = all(z) - load(sz + k);
    const I8 near = dx * dx + dy * dy + dz * dz < all(reach2);
    if (!any(near)) continue;
    const int lanes = std::min(kLanes, end - k);
    for (int lane = 0; lane < lanes; ++lane) {
      out[found] = k + lane;
      found -= near[lane];  // true is -1
    }
  }
  return found;
}

/// Gradients V W'(r) / r d and the sum of V W of one list of whole vectors; padding has d = 2 H.
SC_CLONES double gradients(const KernelTable& table, float volume, int length, const float* dx,
                           const float* dy, const float* dz, float* r, float* gx, float* gy,
                           float* gz) {
  using namespace simd;
  const float perHalfSupport = static_cast<float>(2 / table.support_m());
  const float w0 = static_cast<float>(table.selfW());
  const float scale = volume * w0 * perHalfSupport * perHalfSupport;
  F8 total = all(0);
  for (int k = 0; k < length; k += kLanes) {
    const F8 x = load(dx + k), y = load(dy + k), z = load(dz + k);
    const F8 distance = root(x * x + y * y + z * z);
    store(r + k, distance);
    F8 value, slope;
    if (table.isCubicSpline()) {
      const F8 q = distance * all(perHalfSupport);
      value = all(w0) * cubic::w(q);
      slope = all(scale) * cubic::slopePerQ(q);
    } else {
      const F8 at = smallest(distance * all(table.nodesPerMetre()),
                             all(static_cast<float>(KernelTable::kIntervals)));
      const I8 node = __builtin_convertvector(at, I8);
      const F8 part = at - __builtin_convertvector(node, F8);
      F8 w, wStep, s, sStep;
      for (int lane = 0; lane < kLanes; ++lane) {
        const KernelTable::Pair& e = table.pairs()[node[lane]];
        w[lane] = e.w;
        wStep[lane] = e.wStep;
        s[lane] = e.slope;
        sStep[lane] = e.slopeStep;
      }
      value = w + part * wStep;
      slope = all(volume) * (s + part * sStep);
    }
    store(gx + k, slope * x);
    store(gy + k, slope * y);
    store(gz + k, slope * z);
    total += value;
  }
  return static_cast<double>(volume) * sum(total);
}
}  // namespace

void Neighbours::search(int begin, int end, const KernelTable& kernel, double volume_m3,
                        Found& out) {
  using simd::kLanes;
  out.index.clear();
  out.length.clear();
  const float reach = static_cast<float>(kernel.support_m());
  std::vector<int>& places = out.places;
  for (int i = begin; i < end; ++i) {
    const int cx = cellAlong(x[i], 0), cy = cellAlong(y[i], 1), cz = cellAlong(z[i], 2);
    std::size_t n = 0;
    for (int rz = std::max(cz - 1, 0); rz <= std::min(cz + 1, size_.z() - 1); ++rz)
      for (int ry = std::max(cy - 1, 0); ry <= std::min(cy + 1, size_.y() - 1); ++ry) {
        const int row = (rz * size_.y() + ry) * size_.x();
        const int first = cellStart_[row + std::max(cx - 1, 0)];
        const int last = cellStart_[row + std::min(cx + 1, size_.x() - 1) + 1];
        places.resize(std::max(places.size(), n + last - first + kLanes));
        n += within(sx_.data(), sy_.data(), sz_.data(), first, last, x[i], y[i], z[i],
                    reach * reach, &places[n]);
      }
    const std::size_t old = out.index.size();
    const std::size_t length = (n - 1 + kLanes - 1) / kLanes * kLanes;  // without itself
    out.index.resize(old + length, count);
    for (auto* d : {&out.dx, &out.dy, &out.dz}) d->resize(old + length);
    for (auto* g : {&out.r, &out.gx, &out.gy, &out.gz}) g->resize(old + length);
    std::size_t k = old;
    for (std::size_t e = 0; e < n; ++e) {
      const int p = places[e];
      if (p == self_[i]) continue;
      out.index[k] = owner_[p];
      out.dx[k] = x[i] - sx_[p];
      out.dy[k] = y[i] - sy_[p];
      out.dz[k++] = z[i] - sz_[p];
    }
    for (; k < old + length; ++k) {
      out.index[k] = count;
      out.dx[k] = 2 * reach;
      out.dy[k] = out.dz[k] = 0;
    }
    const float volume = static_cast<float>(volume_m3);
    sumW[i] = volume_m3 * kernel.selfW() +
              gradients(kernel, volume, static_cast<int>(length), &out.dx[old], &out.dy[old],
                        &out.dz[old], &out.r[old], &out.gx[old], &out.gy[old], &out.gz[old]);
    out.length.push_back(static_cast<int>(length));
  }
}

void Neighbours::build(std::span<const Vec3> points, std::span<const std::uint8_t> take,
                       const KernelTable& kernel, double volume_m3, const Vec3& period_m,
                       ThreadPool& pool) {
  sortIntoCells(points, take, kernel.support_m(), period_m);
  sumW.assign(count, 0.0);
  start.assign(count + 1, 0);
  found_.resize((count + kChunk - 1) / kChunk);
  pool.forChunks(count, kChunk, [&](int begin, int end, int chunk) {
    search(begin, end, kernel, volume_m3, found_[chunk]);
    for (int i = begin; i < end; ++i) start[i + 1] = found_[chunk].length[i - begin];
  });
  for (int i = 0; i < count; ++i) start[i + 1] += start[i];
  index.resize(start[count]);
  for (auto* g : {&r, &gx, &gy, &gz}) g->resize(start[count]);
  pool.forChunks(count, kChunk, [&](int begin, int, int chunk) {
    const Found& f = found_[chunk];
    const int at = start[begin];
    std::copy(f.index.begin(), f.index.end(), index.begin() + at);
    std::copy_n(f.r.begin(), f.index.size(), r.begin() + at);
    std::copy_n(f.gx.begin(), f.index.size(), gx.begin() + at);
    std::copy_n(f.gy.begin(), f.index.size(), gy.begin() + at);
    std::copy_n(f.gz.begin(), f.index.size(), gz.begin() + at);
  });
}
}  // namespace swallowclip::bolus
