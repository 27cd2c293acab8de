// SPDX-License-Identifier: MIT
#include "study/protect.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace swallowclip::study {
namespace {
constexpr int kBlock = 8;   // pixels a side; the block of JPEG and H.264, so noise stays inside
constexpr int kPairs = 24;  // of neighbouring frames looked at; assumed, range 8 to 60
constexpr double kAlive =
    0.25;  // share of the liveliest tenth's change; assumed, range 0.15 to 0.4
constexpr double kSilent = 0.3;      // grey levels: less is coding noise; assumed, range 0.1 to 0.6
constexpr double kLeastShare = 0.1;  // of the picture that an opening covers; assumed, 0.05 to 0.2

struct Blocks {
  int columns = 0, rows = 0;
  std::vector<double> change;  ///< [row * columns + column] mean |difference| in grey levels
};

int grey(const std::uint8_t* p) {
  return (p[0] + 2 * p[1] + p[2]) / 4;
}

void addChange(const Image& a, const Image& b, Blocks& blocks) {
  for (int y = 0; y < a.height; ++y) {
    const std::uint8_t *p = a.row(y), *q = b.row(y);
    double* row = &blocks.change[static_cast<std::size_t>(y / kBlock) * blocks.columns];
    for (int x = 0; x < a.width; ++x)
      row[x / kBlock] += std::abs(grey(p + 4 * x) - grey(q + 4 * x));
  }
}

/// The largest group of live blocks that touch by their sides.
std::vector<char> largestGroup(const Blocks& b, const std::vector<char>& alive) {
  std::vector<int> group(alive.size(), -1), best, members;
  for (std::size_t start = 0; start < alive.size(); ++start) {
    if (!alive[start] || group[start] >= 0) continue;
    members.assign(1, static_cast<int>(start));
    group[start] = static_cast<int>(start);
    for (std::size_t i = 0; i < members.size(); ++i) {
      const int c = members[i] % b.columns, r = members[i] / b.columns;
      for (const auto& [dc, dr] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const int nc = c + dc, nr = r + dr;
        if (nc < 0 || nr < 0 || nc >= b.columns || nr >= b.rows) continue;
        const int n = nr * b.columns + nc;
        if (!alive[n] || group[n] >= 0) continue;
        group[n] = static_cast<int>(start);
        members.push_back(n);
      }
    }
    if (members.size() > best.size()) best = members;
  }
  std::vector<char> in(alive.size(), 0);
  for (const int i : best) in[i] = 1;
  return in;
}

struct Point {
  int x, y;
};

/// Convex hull (Andrew's monotone chain) of the corners of the blocks.
std::vector<Point> hull(const Blocks& b, const std::vector<char>& in, int width, int height) {
  std::vector<Point> points;
  for (int r = 0; r < b.rows; ++r)
    for (int c = 0; c < b.columns; ++c) {
      if (!in[static_cast<std::size_t>(r) * b.columns + c]) continue;
      const int x0 = c * kBlock, x1 = std::min(width, x0 + kBlock);
      const int y0 = r * kBlock, y1 = std::min(height, y0 + kBlock);
      points.insert(points.end(), {{x0, y0}, {x1, y0}, {x0, y1}, {x1, y1}});
    }
  std::ranges::sort(points, [](Point a, Point p) { return a.x != p.x ? a.x < p.x : a.y < p.y; });
  const auto turn = [](Point o, Point a, Point p) {
    return static_cast<long>(a.x - o.x) * (p.y - o.y) - static_cast<long>(a.y - o.y) * (p.x - o.x);
  };
  std::vector<Point> chain;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t base = chain.size();
    for (const Point p : points) {
      while (chain.size() >= base + 2 && turn(chain[chain.size() - 2], chain.back(), p) <= 0)
        chain.pop_back();
      chain.push_back(p);
    }
    chain.pop_back();
    std::ranges::reverse(points);
  }
  return chain;
}

/// Pixels whose centres lie inside a convex outline.
void fillConvex(const std::vector<Point>& outline, int width, int height,
                std::vector<std::uint8_t>& inside) {
  for (int y = 0; y < height; ++y) {
    double low = 1e9, high = -1e9;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Point a = outline[i], b = outline[(i + 1) % outline.size()];
      const double at = y + 0.5;
      if ((a.y > at) == (b.y > at)) continue;
      const double x = a.x + (at - a.y) * (b.x - a.x) / (b.y - a.y);
      low = std::min(low, x);
      high = std::max(high, x);
    }
    for (int x = 0; x < width; ++x)
      inside[static_cast<std::size_t>(y) * width + x] = x + 0.5 > low && x + 0.5 < high;
  }
}
}  // namespace

Result<void> Protector::findOpening(Study& study) {
  const int frames = study.info().frames();
  Blocks b{(width_ + kBlock - 1) / kBlock, (height_ + kBlock - 1) / kBlock, {}};
  b.change.assign(static_cast<std::size_t>(b.columns) * b.rows, 0);
  const int step = std::max(1, (frames - 1) / kPairs);
  int pairs = 0;
  for (int k = 0; k + 1 < frames; k += step, ++pairs) {
    auto first = study.frame(k);
    if (!first) return std::unexpected(first.error());
    auto second = study.frame(k + 1);
    if (!second) return std::unexpected(second.error());
    addChange(*first, *second, b);
  }
  for (int r = 0; r < b.rows; ++r)
    for (int c = 0; c < b.columns; ++c)
      b.change[static_cast<std::size_t>(r) * b.columns + c] /=
          std::max(1, pairs) * std::min(kBlock, width_ - c * kBlock) *
          std::min(kBlock, height_ - r * kBlock);
  std::vector<double> sorted = b.change;
  std::ranges::sort(sorted);
  const double lively = sorted[sorted.size() * 9 / 10];
  std::vector<char> alive(b.change.size());
  for (std::size_t i = 0; i < alive.size(); ++i)
    alive[i] = b.change[i] > std::max(kSilent, kAlive * lively);
  const std::vector<char> in = largestGroup(b, alive);
  if (static_cast<double>(std::ranges::count(in, 1)) <
      kLeastShare * static_cast<double>(in.size())) {
    notes_.push_back("no opening of the X-ray was found: the border is not blacked out");
    return {};
  }
  fillConvex(hull(b, in, width_, height_), width_, height_, visible_);
  return {};
}

Result<Protector> Protector::make(Study& study, const ProtectDef& def) {
  const StudyInfo& info = study.info();
  if (info.burnedIn != BurnedIn::no && def.masks.empty() && !def.noBurnedInText)
    return refuse(info.burnedIn == BurnedIn::yes
                      ? "says that patient text is burned into its pixels"
                      : "does not say whether patient text is burned into its pixels",
                  "Cover the text with --mask X,Y,WIDTH,HEIGHT, or vouch that there is none with "
                  "--no-burned-in-text.");
  Protector p;
  p.width_ = info.width;
  p.height_ = info.height;
  p.visible_.assign(static_cast<std::size_t>(p.width_) * p.height_, 1);
  if (info.burnedIn == BurnedIn::yes && def.masks.empty())
    p.notes_.push_back(
        "the study says that patient text is burned in; --no-burned-in-text overrides");
  if (!def.keepBorder)
    if (auto found = p.findOpening(study); !found) return std::unexpected(found.error());
  for (const Rectangle& m : def.masks) {
    if (m.x < 0 || m.y < 0 || m.width < 1 || m.height < 1 || m.x + m.width > p.width_ ||
        m.y + m.height > p.height_)
      return usageError("--mask",
                        fmt::format("{},{},{},{} does not lie in the picture of {} x {}", m.x, m.y,
                                    m.width, m.height, p.width_, p.height_),
                        "Count pixels of the study from its upper left corner.");
    for (int y = m.y; y < m.y + m.height; ++y)
      std::fill_n(p.visible_.begin() + static_cast<long>(y) * p.width_ + m.x, m.width,
                  std::uint8_t{0});
  }
  int x0 = p.width_, y0 = p.height_, x1 = -1, y1 = -1;
  for (int y = 0; y < p.height_; ++y)
    for (int x = 0; x < p.width_; ++x)
      if (p.visible_[static_cast<std::size_t>(y) * p.width_ + x]) {
        x0 = std::min(x0, x);
        x1 = std::max(x1, x);
        y0 = std::min(y0, y);
        y1 = std::max(y1, y);
      }
  if (x1 < x0) return usageError("--mask", "covers the whole picture", "Give smaller rectangles.");
  p.opening_ = {x0, y0, x1 - x0 + 1, y1 - y0 + 1};
  return p;
}

void Protector::apply(Image& image) const {
  for (std::size_t i = 0; i < visible_.size() && 4 * i + 2 < image.rgba.size(); ++i)
    if (!visible_[i]) image.rgba[4 * i] = image.rgba[4 * i + 1] = image.rgba[4 * i + 2] = 0;
}
}  // namespace swallowclip::study
