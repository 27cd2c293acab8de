// SPDX-License-Identifier: MIT
#include "bolus/neighbours.h"

#include <algorithm>
#include <cmath>

#include "bolus/cubic_spline.h"
#include "core/simd.h"

namespace swallowclip::bolus {
namespace {
constexpr int kChunk = 64;          // particles per work item
constexpr int kPlacesAlone = 1000;  // are set sooner than a thread wakes, assumed (500 to 2000)
constexpr float kFarAway = 1e18f;   // m; fills vectors up, its square is still a number
}  // namespace

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

namespace {
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

void Neighbours::build(std::span<const Vec3> points, std::span<const std::uint8_t> take,
                       const KernelTable& kernel, double volume_m3, const Vec3& period_m,
                       double skin_m, ThreadPool& pool, const Range& then) {
  support_m_ = kernel.support_m();
  skin_m_ = skin_m;
  sortIntoCells(points, take, support_m_ + skin_m, period_m, pool);
  start.assign(count + 1, 0);
  found_.resize((count + kChunk - 1) / kChunk);
  pool.forChunks(count, kChunk, [&](int begin, int end, int chunk) {
    search(begin, end, static_cast<float>(support_m_ + skin_m), found_[chunk]);
    for (int i = begin; i < end; ++i) start[i + 1] = found_[chunk].length[i - begin];
  });
  for (int i = 0; i < count; ++i) start[i + 1] += start[i];
  candidates_.resize(start[count]);
  pool.forChunks(count, kChunk, [&](int begin, int end, int chunk) {
    std::copy_n(found_[chunk].places.begin(), start[end] - start[begin],
                candidates_.begin() + start[begin]);
  });
  stop.resize(count);
  index.resize(start[count]);
  for (auto* g : {&r, &gx, &gy, &gz}) g->resize(start[count]);
  sumW.resize(count);
  sumG.shape(count, 0);
  moment.shape(count, 0);
  measure(kernel, volume_m3, pool, then);
}

bool Neighbours::follow(std::span<const Vec3> points, std::span<const std::uint8_t> take,
                        const KernelTable& kernel, double volume_m3, ThreadPool& pool,
                        const Range& then) {
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
  measure(kernel, volume_m3, pool, then);
  return true;
}

// Gradients and sums of who is within the kernel's support.
void Neighbours::measure(const KernelTable& kernel, double volume_m3, ThreadPool& pool,
                         const Range& then) {
  using simd::kLanes;
  const float reach = static_cast<float>(support_m_), volume = static_cast<float>(volume_m3);
  const int farAway = static_cast<int>(shift_.size());
  pool.forChunks(count, kChunk, [&](int begin, int end, int) {
    thread_local std::vector<int> near;
    const bool images = farAway > count;  // else slots are places
    for (int i = begin; i < end; ++i) {
      const int first = start[i], most = start[i + 1] - first;
      near.resize(std::max<std::size_t>(near.size(), most + kLanes));
      const float* own = places_[self_[i]];
      int n = stillWithin(places_.data(), own, candidates_.data() + first, most, reach * reach,
                          near.data());
      for (; n % kLanes != 0; ++n) near[n] = farAway;
      stop[i] = first + n;
      if (images)
        for (int k = 0; k < n; ++k) index[first + k] = owner_[near[k]];
      else
        std::copy_n(near.begin(), n, index.begin() + first);
      sumW[i] = volume_m3 * kernel.selfW() +
                gradients(kernel, volume,
                          {places_.data(), own, near.data(), n, r.data() + first, gx.data() + first,
                           gy.data() + first, gz.data() + first, sumG[i], moment[i]});
    }
    if (then) then(begin, end);
  });
}
}  // namespace swallowclip::bolus
