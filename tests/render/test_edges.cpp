// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "core/vec.h"
#include "render/edges.h"

namespace swallowclip::render {
namespace {

constexpr int kSize = 128;
using Shape = std::function<bool(double x, double y)>;

// Share of samples of a pixel that lie inside, 0..255.
template <class Samples>
Image sampled(const Shape& inside, const Samples& samples) {
  Image image(kSize, kSize);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      int hits = 0;
      for (const auto& [sx, sy] : samples) hits += inside(x + sx, y + sy);
      for (int k = 0; k < 3; ++k)
        image.row(y)[4 * x + k] = static_cast<std::uint8_t>(
            std::lround(255.0 * hits / static_cast<double>(samples.size())));
    }
  return image;
}

using Samples = std::vector<std::pair<double, double>>;
const Samples kOne{{0.5, 0.5}};
const Samples kFour{{0.375, 0.125}, {0.875, 0.375}, {0.125, 0.625}, {0.625, 0.875}};
Samples many() {
  Samples s;
  for (int i = 0; i < 256; ++i) s.emplace_back((i % 16 + 0.5) / 16, (i / 16 + 0.5) / 16);
  return s;
}

// Root of the mean squared error against the true coverage, over pixels that an edge crosses.
double error(const Image& image, const Image& truth) {
  double sum = 0;
  int n = 0;
  for (std::size_t i = 0; i < truth.rgba.size(); i += 4) {
    const double d = image.rgba[i] - truth.rgba[i];
    const bool crossed = truth.rgba[i] > 0 && truth.rgba[i] < 255;
    sum += crossed || d != 0 ? d * d : 0;
    n += crossed;
  }
  return std::sqrt(sum / n);
}

struct Errors {
  double ours = 0, four = 0, one = 0;

  void add(const Shape& s, int shapes) {
    const Image truth = sampled(s, many());
    Image smooth = sampled(s, kOne);
    one += error(smooth, truth) / shapes;
    smoothEdges(smooth);
    ours += error(smooth, truth) / shapes;
    four += error(sampled(s, kFour), truth) / shapes;
  }
  void print(const char* what) const {
    std::fprintf(stderr, "%s: levels of 255 from the truth %.1f; four samples %.1f; one %.1f\n",
                 what, ours, four, one);
  }
};

TEST(Edges, StraightOnesLieNearerToTheTruthThanFourSamplesPerPixel) {
  Errors e;
  for (int degree = 1; degree <= 180; degree += 4) {
    const double c = std::cos(degree * kPi / 180), s = std::sin(degree * kPi / 180);
    e.add([=](double x, double y) { return c * (x - 63.3) + s * (y - 64.2) > 0; }, 45);
  }
  e.print("lines");
  EXPECT_LT(e.ours, e.four);
}

// One sample does not tell where within a pixel a curve lies.
TEST(Edges, CurvedOnesAreTwiceAsNearAsWithout) {
  Errors e;
  for (double radius = 10.3; radius < 60; radius += 5)
    e.add([=](double x, double y) { return std::hypot(x - 64.4, y - 63.7) < radius; }, 10);
  e.print("discs");
  EXPECT_LT(e.ours, 0.55 * e.one);
  EXPECT_LT(e.ours, 1.5 * e.four);
}

TEST(Edges, LeaveStraightBordersAndGentleShadesAsTheyAre) {
  Image image(kSize, kSize);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      for (int k = 0; k < 3; ++k)
        image.row(y)[4 * x + k] = static_cast<std::uint8_t>((x < 20 ? 0 : 120) + 2 * (y % 8));
  const auto before = image.rgba;
  smoothEdges(image);
  EXPECT_EQ(image.rgba, before);
}

TEST(Edges, StructuresOfOneColourAreKeptApartByAlphaAndEndOpaque) {
  Image image(kSize, kSize);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      image.row(y)[4 * x] = x + 2 * y < 90 ? 100 : 110;  // too near to be told apart by colour
      image.row(y)[4 * x + 3] = x + 2 * y < 90 ? 1 : 2;
    }
  smoothEdges(image);
  int mixed = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    mixed += image.rgba[i] > 100 && image.rgba[i] < 110;
    ASSERT_EQ(image.rgba[i + 3], 255);
  }
  EXPECT_GT(mixed, 20);
}
}  // namespace
}  // namespace swallowclip::render
