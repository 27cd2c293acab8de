// SPDX-License-Identifier: MIT
#include "bolus/neighbours.h"

#include <algorithm>
#include <cmath>

#include "bolus/cubic_spline.h"
#include "core/simd.h"

namespace swallowclip::bolus {
namespace {
// Lists that lie one behind the other, without the gaps of who is no longer near, are read in half
// the time by this many particles (40,000: 20 ns for 45); a round of the threads is worth it.
constexpr int kGapsMatter = 4000;
const Eigen::Vector3i kOne = Eigen::Vector3i::Ones();

/// Sorted points that one cell's own look at, as flat arrays of whole vectors.
struct Block {
  std::vector<float> x, y, z;
  std::vector<int> place;
  int count = 0;
  void reserve(int more) {
    const std::size_t n = count + more + simd::kLanes;
    if (place.size() >= n) return;
    for (auto* a : {&x, &y, &z}) a->resize(2 * n);
    place.resize(2 * n);
  }
};

struct Points {
  const float *x, *y, *z;
};
/// Appends the points of [begin, end) within reach of a box, by the square.
SC_CLONES void nearBox(const Points& p, int begin, int end, const float* low, const float* high,
                       float reach2, Block& out) {
  using namespace simd;
  out.reserve(end - begin);
  int* place = out.place.data();
  int n = out.count;
  for (int k = begin; k < end; k += kLanes) {
    const F8 x = load(p.x + k), y = load(p.y + k), z = load(p.z + k), none = all(0);
    const F8 dx = largest(largest(all(low[0]) - x, x - all(high[0])), none);
    const F8 dy = largest(largest(all(low[1]) - y, y - all(high[1])), none);
    const F8 dz = largest(largest(all(low[2]) - z, z - all(high[2])), none);
    const I8 near = (dx * dx + dy * dy + dz * dz < all(reach2)) & (kCount < allInt(end - k));
    n += putLanes(near, k, place + n);
  }
  for (int e = out.count; e < n; ++e) {
    out.x[e] = p.x[place[e]];
    out.y[e] = p.y[place[e]];
    out.z[e] = p.z[place[e]];
  }
  out.count = n;
}

/// Places of a block (filled up with points far away) within reach of (x, y, z); returns how many.
SC_CLONES int within(const Block& b, float x, float y, float z, float reach2, int* out) {
  using namespace simd;
  int found = 0;
  for (int k = 0; k < b.count; k += kLanes) {
    const F8 dx = all(x) - load(&b.x[k]), dy = all(y) - load(&b.y[k]), dz = all(z) - load(&b.z[k]);
    found +=
        putValues(dx * dx + dy * dy + dz * dz < all(reach2), loadInt(&b.place[k]), out + found);
  }
  return found;
}

/// The candidates (whole vectors) within reach of `own`; returns how many.
SC_CLONES int stillWithin(const float* places, const float* own, const int* candidates, int length,
                          float reach2, int* out) {
  using namespace simd;
  int found = 0;
  for (int k = 0; k < length; k += kLanes) {
    const F8x3 o = gather3(places, candidates + k);
    const F8 dx = all(own[0]) - o.x, dy = all(own[1]) - o.y, dz = all(own[2]) - o.z;
    const I8 near = dx * dx + dy * dy + dz * dz < all(reach2);
    found += putValues(near, loadInt(candidates + k), out + found);
  }
  return found;
}

/// One list of whole vectors.
struct List {
  const float *places, *own;
  const int* neighbours;  ///< places
  int length;
  float *r, *gx, *gy, *gz;  ///< gradients V W'(r) / r d
  float *sumG, *moment;     ///< as in Neighbours
};
/// Fills a list's gradients and sums; returns the sum of V W. What fills the list up is so far away
/// that it adds zeros.
SC_CLONES double gradients(const KernelTable& table, float volume, const List& l) {
  using namespace simd;
  const float perHalfSupport = static_cast<float>(2 / table.support_m());
  const float w0 = static_cast<float>(table.selfW());
  const float scale = volume * w0 * perHalfSupport * perHalfSupport;
  // one name for each sum: an array of them would live in memory
  F8 total = all(0), sumX = all(0), sumY = all(0), sumZ = all(0);
  F8 xx = all(0), yy = all(0), zz = all(0), xy = all(0), xz = all(0), yz = all(0);
  for (int k = 0; k < l.length; k += kLanes) {
    const F8x3 o = gather3(l.places, l.neighbours + k);
    const F8 x = all(l.own[0]) - o.x, y = all(l.own[1]) - o.y, z = all(l.own[2]) - o.z;
    const F8 distance = root(x * x + y * y + z * z);
    store(l.r + k, distance);
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
    const F8 gx = slope * x, gy = slope * y, gz = slope * z;
    store(l.gx + k, gx);
    store(l.gy + k, gy);
    store(l.gz + k, gz);
    total += value;
    sumX += gx;
    sumY += gy;
    sumZ += gz;
    // r |g| n n = -g d
    xx -= gx * x;
    yy -= gy * y;
    zz -= gz * z;
    xy -= gx * y;
    xz -= gx * z;
    yz -= gy * z;
  }
  store4(l.sumG, sum3(sumX, sumY, sumZ));
  store4(l.moment, sum3(xx, yy, zz));
  store4(l.moment + 4, sum3(xy, xz, yz));
  return static_cast<double>(volume) * sum(total);
}
}  // namespace

// All of a cell look at the same points, which are picked out once.
void Neighbours::search(int begin, int end, float reach, Found& out) const {
  using simd::kLanes;
  thread_local Block block;
  out.length.clear();
  std::vector<int>& places = out.places;
  std::size_t n = 0;
  for (int i = begin; i < end;) {
    const int first = self_[i];
    const Eigen::Vector3i cell = cellOf(first);
    float low[3] = {sx_[first], sy_[first], sz_[first]}, high[3] = {low[0], low[1], low[2]};
    int last = i + 1;  // of this cell's
    for (; last < end && cellOf(self_[last]) == cell; ++last) {
      const float at[3] = {sx_[self_[last]], sy_[self_[last]], sz_[self_[last]]};
      for (int a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], at[a]);
        high[a] = std::max(high[a], at[a]);
      }
    }
    block.count = 0;
    const Eigen::Vector3i from = (cell.array() - 1).max(0),
                          to = (cell + kOne).cwiseMin(size_ - kOne);
    for (int rz = from.z(); rz <= to.z(); ++rz)
      for (int ry = from.y(); ry <= to.y(); ++ry) {
        const int row = (rz * size_.y() + ry) * size_.x();
        nearBox({sx_.data(), sy_.data(), sz_.data()}, cellStart_[row + from.x()],
                cellStart_[row + to.x() + 1], low, high, reach * reach, block);
      }
    block.reserve(0);
    for (int k = block.count; k < block.count + kLanes; ++k)
      block.x[k] = block.y[k] = block.z[k] = kFarAway;
    for (; i < last; ++i) {
      const std::size_t old = n;
      const int self = self_[i];
      places.resize(std::max(places.size(), n + block.count + 2 * kLanes));
      n += within(block, sx_[self], sy_[self], sz_[self], reach * reach, &places[n]);
      const auto own = std::find(places.begin() + old, places.begin() + n, self);
      std::copy(own + 1, places.begin() + n, own);
      for (--n; (n - old) % kLanes != 0; ++n)
        places[n] = static_cast<int>(shift_.size());  // far away
      out.length.push_back(static_cast<int>(n - old));
    }
  }
}

void Neighbours::collect(std::span<const Vec3> points, std::span<const std::uint8_t> take,
                         double reach_m, double skin_m, const Vec3& period_m, ThreadPool& pool) {
  support_m_ = reach_m;
  skin_m_ = skin_m;
  sortIntoCells(points, take, support_m_ + skin_m, period_m, pool);
  candidateStart_.assign(count + 1, 0);
  found_.resize((count + kChunk - 1) / kChunk);
  pool.forChunks(count, kChunk, [&](int begin, int end, int chunk) {
    search(begin, end, static_cast<float>(support_m_ + skin_m), found_[chunk]);
    for (int i = begin; i < end; ++i) candidateStart_[i + 1] = found_[chunk].length[i - begin];
  });
  for (int i = 0; i < count; ++i) candidateStart_[i + 1] += candidateStart_[i];
  candidates_.resize(candidateStart_[count]);
  pool.forChunks(count, kChunk, [&](int begin, int end, int chunk) {
    std::copy_n(found_[chunk].places.begin(), candidateStart_[end] - candidateStart_[begin],
                candidates_.begin() + candidateStart_[begin]);
  });
}

void Neighbours::build(std::span<const Vec3> points, std::span<const std::uint8_t> take,
                       const KernelTable& kernel, double volume_m3, const Vec3& period_m,
                       double skin_m, ThreadPool& pool, const Range& then) {
  collect(points, take, kernel.support_m(), skin_m, period_m, pool);
  const int most = candidateStart_[count];
  for (auto* a : {&near_, &index}) a->resize(most);
  for (auto* a : {&r, &gx, &gy, &gz}) a->resize(most);
  for (auto* a : {&start, &stop}) a->resize(count);
  sumW.resize(count);
  sumG.shape(count, 0);
  moment.shape(count, 0);
  measure(kernel, volume_m3, pool, then);
}

bool Neighbours::carry(std::span<const Vec3> points, std::span<const std::uint8_t> take,
                       ThreadPool& pool) {
  const double most2 = skin_m_ * skin_m_ / 4;
  if (most2 == 0 || slot.size() != points.size()) return false;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if ((take.empty() || take[p]) != (slot[p] >= 0)) return false;
    if (slot[p] >= 0 && !((points[p] - builtAt_[slot[p]]).squaredNorm() < most2)) return false;
  }
  pool.forChunks(
      static_cast<int>(shift_.size()), kChunk,
      [&](int begin, int end, int) {
        for (int s = begin; s < end; ++s) places_.set(s, points[id[owner_[s]]] + shift_[s] - low_);
      },
      kPlacesAlone);
  return true;
}

bool Neighbours::follow(std::span<const Vec3> points, std::span<const std::uint8_t> take,
                        const KernelTable& kernel, double volume_m3, ThreadPool& pool,
                        const Range& then) {
  if (!carry(points, take, pool)) return false;
  measure(kernel, volume_m3, pool, then);
  return true;
}

// Of a chunk, to near_ where its candidates start; returns how many, `stop` [slot] how far each
// goes.
int Neighbours::pickNear(int begin, int end) {
  const float reach = static_cast<float>(support_m_);
  int n = 0;
  if (skin_m_ == 0) {  // candidates are no others
    for (int i = begin; i < end; ++i) stop[i] = n = candidateStart_[i + 1] - candidateStart_[begin];
    return n;
  }
  int* const out = near_.data() + candidateStart_[begin];
  for (int i = begin; i < end; ++i) {
    const int first = candidateStart_[i];
    n += stillWithin(places_.data(), places_[self_[i]], candidates_.data() + first,
                     candidateStart_[i + 1] - first, reach * reach, out + n);
    for (; n % simd::kLanes != 0; ++n) out[n] = static_cast<int>(shift_.size());  // far away
    stop[i] = n;
  }
  return n;
}

// Gradients and sums of who is within the kernel's support.
void Neighbours::measure(const KernelTable& kernel, double volume_m3, ThreadPool& pool,
                         const Range& then) {
  const float volume = static_cast<float>(volume_m3);
  const bool images = static_cast<int>(shift_.size()) > count;  // else slots are places
  const auto measureAt = [&](int begin, int end, int at) {
    const int* const near = (skin_m_ == 0 ? candidates_ : near_).data() + candidateStart_[begin];
    for (int i = begin, from = 0; i < end; ++i) {
      const int first = at + from, n = stop[i] - from;
      if (images)
        for (int k = 0; k < n; ++k) index[first + k] = owner_[near[from + k]];
      else
        std::copy_n(near + from, n, index.begin() + first);
      sumW[i] =
          volume_m3 * kernel.selfW() +
          gradients(kernel, volume,
                    {places_.data(), places_[self_[i]], near + from, n, r.data() + first,
                     gx.data() + first, gy.data() + first, gz.data() + first, sumG[i], moment[i]});
      from = stop[i];
      start[i] = first;
      stop[i] = first + n;
    }
    if (then) then(begin, end);
  };
  if (count < kGapsMatter) {
    pool.forChunks(count, kChunk, [&](int begin, int end, int) {
      pickNear(begin, end);
      measureAt(begin, end, candidateStart_[begin]);
    });
    return;
  }
  std::vector<int> at((count + kChunk - 1) / kChunk + 1, 0);
  pool.forChunks(count, kChunk,
                 [&](int begin, int end, int chunk) { at[chunk + 1] = pickNear(begin, end); });
  for (std::size_t c = 1; c < at.size(); ++c) at[c] += at[c - 1];
  pool.forChunks(count, kChunk,
                 [&](int begin, int end, int chunk) { measureAt(begin, end, at[chunk]); });
}
}  // namespace swallowclip::bolus
