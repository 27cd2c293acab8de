// SPDX-License-Identifier: MIT
#include "render/edges.h"

#include <algorithm>
#include <cstring>
#include <vector>

namespace swallowclip::render {
namespace {

// What a step of a channel must exceed to be an edge: a tenth of white for red, green, blue; any
// step of alpha.
constexpr std::uint8_t kContrast[4] = {26, 26, 26, 0};

// marks[i] becomes 1 where pixel i of `a` and of `b` lie on two sides of an edge.
void compare(const std::uint8_t* a, const std::uint8_t* b, const std::vector<std::uint8_t>& limit,
             std::size_t pixels, std::vector<std::uint8_t>& excess, std::uint8_t* marks) {
  for (std::size_t j = 0; j < 4 * pixels; ++j) {  // bytes without branches: 16 at a time
    const std::uint8_t high = std::max(a[j], b[j]), low = std::min(a[j], b[j]);
    excess[j] = static_cast<std::uint8_t>(high - low) > limit[j];
  }
  for (std::size_t i = 0; i < pixels; ++i) {
    std::uint32_t any;
    std::memcpy(&any, &excess[4 * i], 4);
    marks[i] = any != 0;
  }
}

// Edges seen along rows, or along columns: `along` and `across` are steps from pixel to pixel.
struct Walk {
  const std::uint8_t* edge;   ///< between a pixel and its neighbour across
  const std::uint8_t* cross;  ///< between a pixel and its neighbour along
  int length;                 ///< pixels along
  std::ptrdiff_t along, across;

  bool crossed(std::ptrdiff_t p) const { return cross[p] || cross[p + across]; }
  /// Where the edge beyond pixel p, which ends between p and its neighbour along, turns to: -1 to
  /// the side of p, 1 to the other, 0 neither or both.
  int turn(std::ptrdiff_t p) const { return cross[p + across] - cross[p]; }
};

// A share, in 255ths, of the pixel at `to` shows the colour of `from`, its neighbour across the
// edge.
struct Mix {
  std::ptrdiff_t to, from;
  int share;
};

// Half of a run of pixels along an edge: the true edge falls from half a pixel at the turn to
// nothing at the middle of the run; pixels under it take the other side's colour.
void mixHalf(const Walk& w, std::ptrdiff_t first, std::ptrdiff_t step, double half, int side,
             std::vector<Mix>& out) {
  for (int k = 0; k < half; ++k, first += step) {
    const double a = k, b = std::min(k + 1.0, half);
    const int share = static_cast<int>(255 * 0.5 * ((b - a) - (b * b - a * a) / (2 * half)) + 0.5);
    const std::ptrdiff_t other = first + w.across;
    out.push_back(side < 0 ? Mix{first, other, share} : Mix{other, first, share});
  }
}

// The run of edge pixels that begins at p, the `i`th along, if one does.
void mixRun(const Walk& w, std::ptrdiff_t p, int i, std::vector<Mix>& out) {
  if (i > 0 && w.edge[p - w.along] && !w.crossed(p - w.along)) return;  // began before
  std::ptrdiff_t last = p;
  int n = 1;
  while (i + n < w.length && !w.crossed(last) && w.edge[last + w.along]) last += w.along, ++n;
  if (i > 0)
    if (const int side = w.turn(p - w.along)) mixHalf(w, p, w.along, 0.5 * n, side, out);
  if (i + n < w.length)
    if (const int side = w.turn(last)) mixHalf(w, last, -w.along, 0.5 * n, side, out);
}
}  // namespace

void smoothEdges(Image& image) {
  const std::size_t width = static_cast<std::size_t>(image.width), all = image.rgba.size() / 4;
  // a row and a column more than there are pixels: no edge beyond the border
  std::vector<std::uint8_t> below(all + width + 8), right(all + width + 8);
  std::vector<std::uint8_t> excess(4 * width), limit(4 * width);
  for (std::size_t j = 0; j < limit.size(); ++j) limit[j] = kContrast[j % 4];
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* row = image.row(y);
    const std::size_t at = static_cast<std::size_t>(y) * width;
    compare(row, row + 4, limit, width - 1, excess, &right[at]);
    if (y + 1 < image.height) compare(row, image.row(y + 1), limit, width, excess, &below[at]);
  }
  const std::ptrdiff_t down = image.width;
  const Walk rows{below.data(), right.data(), image.width, 1, down};
  const Walk columns{right.data(), below.data(), image.height, down, 1};
  std::vector<Mix> mixes[2];
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const std::ptrdiff_t p = y * down + x;
      std::uint64_t next[2];  // most pixels lie on no edge: eight at a time
      std::memcpy(&next[0], &below[p], 8);
      std::memcpy(&next[1], &right[p], 8);
      if (!(next[0] | next[1])) {
        x += 7;
        continue;
      }
      if (below[p]) mixRun(rows, p, x, mixes[0]);
      if (right[p]) mixRun(columns, p, y, mixes[1]);
    }
  // an oblique edge is seen both ways: of the two the one that says more counts
  std::vector<std::uint16_t> total[2] = {std::vector<std::uint16_t>(all),
                                         std::vector<std::uint16_t>(all)};
  for (int k : {0, 1})
    for (const Mix& m : mixes[k]) total[k][m.to] += static_cast<std::uint16_t>(m.share);
  struct Change {
    std::ptrdiff_t to;
    int colour[3];
  };
  std::vector<Change> changes;  // from the picture as it was
  const auto weaker = [&](int k, std::ptrdiff_t p) {
    return total[k][p] < total[1 - k][p] || (k == 1 && total[0][p] == total[1][p]);
  };
  for (int k : {0, 1})
    for (const Mix& m : mixes[k]) {
      if (weaker(k, m.to)) continue;
      Change c{m.to, {}};
      for (int n = 0; n < 3; ++n) {
        const int step = m.share * (image.rgba[4 * m.from + n] - image.rgba[4 * m.to + n]);
        c.colour[n] = (step + (step < 0 ? -127 : 127)) / 255;
      }
      changes.push_back(c);
    }
  for (const Change& c : changes)
    for (int n = 0; n < 3; ++n) {
      std::uint8_t& value = image.rgba[4 * c.to + n];
      value = static_cast<std::uint8_t>(std::clamp(value + c.colour[n], 0, 255));
    }
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
}
}  // namespace swallowclip::render
