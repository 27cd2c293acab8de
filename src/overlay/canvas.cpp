// SPDX-License-Identifier: MIT
#include "overlay/canvas.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace swallowclip::overlay {

void Coverage::stroke(std::span<const Vec2> segments, double width_px) {
  const double r = width_px / 2, reach = r + 1;
  for (std::size_t i = 0; i + 1 < segments.size(); i += 2) {
    const Vec2 &a = segments[i], d = segments[i + 1] - a;
    const double length2 = d.squaredNorm();
    const Vec2 low = a.cwiseMin(segments[i + 1]), high = a.cwiseMax(segments[i + 1]);
    const int x0 = std::max(pane_.x, static_cast<int>(std::floor(low.x() - reach)));
    const int x1 = std::min(pane_.x + pane_.width - 1, static_cast<int>(high.x() + reach));
    const int y0 = std::max(pane_.y, static_cast<int>(std::floor(low.y() - reach)));
    const int y1 = std::min(pane_.y + pane_.height - 1, static_cast<int>(high.y() + reach));
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const Vec2 p = Vec2(x + 0.5, y + 0.5) - a;
        const double t = length2 > 0 ? std::clamp(p.dot(d) / length2, 0.0, 1.0) : 0;
        const double distance = (p - t * d).norm();
        const auto covered = static_cast<float>(std::clamp(r + 0.5 - distance, 0.0, 1.0));
        at(x, y) = std::max(at(x, y), covered);
      }
  }
}

void Coverage::disc(const Vec2& centre, double radius_px) {
  const Vec2 point[2] = {centre, centre};
  stroke(point, 2 * radius_px);
}

void Coverage::fill(std::span<const Vec2> segments) {
  constexpr int kRows = 4;  // scan lines per pixel row; along rows the coverage is exact
  std::vector<double> crossings;
  for (int y = pane_.y; y < pane_.y + pane_.height; ++y)
    for (int sub = 0; sub < kRows; ++sub) {
      const double line = y + (sub + 0.5) / kRows;
      crossings.clear();
      for (std::size_t i = 0; i + 1 < segments.size(); i += 2) {
        const Vec2 &a = segments[i], &b = segments[i + 1];
        if ((a.y() > line) == (b.y() > line)) continue;
        crossings.push_back(a.x() + (line - a.y()) * (b.x() - a.x()) / (b.y() - a.y()));
      }
      std::ranges::sort(crossings);
      for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
        const double from = std::max(crossings[i], static_cast<double>(pane_.x));
        const double to = std::min(crossings[i + 1], static_cast<double>(pane_.x + pane_.width));
        for (int x = static_cast<int>(from); x < to; ++x) {
          const double share = std::min(to, x + 1.0) - std::max(from, static_cast<double>(x));
          float& cell = at(x, y);
          cell = std::min(1.0f, cell + static_cast<float>(share / kRows));
        }
      }
    }
}

void Coverage::blendOnto(Image& image, const Vec3f& colour, float opacity) const {
  for (int y = pane_.y; y < pane_.y + pane_.height; ++y)
    for (int x = pane_.x; x < pane_.x + pane_.width; ++x) {
      const float a =
          opacity * share_[static_cast<std::size_t>(y - pane_.y) * pane_.width + (x - pane_.x)];
      if (a <= 0) continue;
      std::uint8_t* p = image.row(y) + 4 * x;
      for (int k = 0; k < 3; ++k)
        p[k] = static_cast<std::uint8_t>(std::lround(p[k] + a * (255 * colour[k] - p[k])));
    }
}

namespace {
/// Bilinear at a point; outside is black.
void sample(const Image& from, const Vec2& at, double* rgb) {
  const double fx = at.x() - 0.5, fy = at.y() - 0.5;
  const double x0 = std::floor(fx), y0 = std::floor(fy);
  for (int dy = 0; dy < 2; ++dy)
    for (int dx = 0; dx < 2; ++dx) {
      const double w = (dx ? fx - x0 : 1 - fx + x0) * (dy ? fy - y0 : 1 - fy + y0);
      const double x = x0 + dx, y = y0 + dy;
      if (w <= 0 || x < 0 || y < 0 || x >= from.width || y >= from.height) continue;
      const std::uint8_t* p = from.row(static_cast<int>(y)) + 4 * static_cast<int>(x);
      for (int k = 0; k < 3; ++k) rgb[k] += w * p[k];
    }
}
}  // namespace

void lay(Image& onto, const Rectangle& pane, const Image& from,
         const std::function<Vec2(const Vec2&)>& source, double step) {
  const int n = std::clamp(static_cast<int>(std::ceil(step)), 1, 8);  // points per pixel and axis
  // the map is affine: three points tell it
  const Vec2 origin = source(Vec2(0, 0)), alongX = source(Vec2(1, 0)) - origin,
             alongY = source(Vec2(0, 1)) - origin;
  for (int y = pane.y; y < pane.y + pane.height; ++y)
    for (int x = pane.x; x < pane.x + pane.width; ++x) {
      double rgb[3] = {0, 0, 0};
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
          sample(from, origin + (x + (i + 0.5) / n) * alongX + (y + (j + 0.5) / n) * alongY, rgb);
      std::uint8_t* p = onto.row(y) + 4 * x;
      for (int k = 0; k < 3; ++k)
        p[k] = static_cast<std::uint8_t>(std::lround(std::min(255.0, rgb[k] / (n * n))));
    }
}

void paste(Image& onto, const Image& from, int x, int y) {
  const int width = std::min(from.width, onto.width - x);
  for (int row = 0; row < from.height && y + row < onto.height; ++row)
    std::memcpy(onto.row(y + row) + 4 * x, from.row(row), 4 * static_cast<std::size_t>(width));
}
}  // namespace swallowclip::overlay
