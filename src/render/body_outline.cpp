// SPDX-License-Identifier: MIT
#include "render/body_outline.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace swallowclip::render {
namespace {
// Horizontal sections: height, front and back on the midline, half breadth, millimetres. Assumed:
// a typical adult profile (nose, lips, chin, submental angle, nape) around the scene's bones; neck
// 113 mm broad, head 136 mm.
struct Section {
  double z, front, back, half;
};
constexpr Section kSections[] = {
    {90, -70, 118, 68},   {45, -73, 119, 68},   {22, -86, 118, 67},   {14, -88, 117, 67},
    {5, -76, 116, 66},    {-6, -76, 114, 65},   {-14, -78, 113, 64},  {-20, -74, 112, 63},
    {-26, -76, 111, 62},  {-36, -69, 110, 61},  {-50, -71, 108, 60},  {-62, -70, 107, 59},
    {-72, -62, 106, 58},  {-80, -44, 105, 57},  {-88, -24, 105, 57},  {-100, -14, 105, 56},
    {-120, -13, 106, 56}, {-145, -12, 108, 58}, {-165, -12, 111, 64}, {-190, -14, 116, 80}};
constexpr int kLevels = 140, kAround = 72;
constexpr double kSquareness = 2.4;  // superellipse exponent of a section; 2 = ellipse

// Catmull-Rom between sections, at t in section counts.
double along(double t, double Section::*value) {
  const int last = static_cast<int>(std::size(kSections)) - 1;
  const int k = std::clamp(static_cast<int>(t), 0, last - 1);
  const auto at = [&](int i) { return kSections[std::clamp(i, 0, last)].*value; };
  const double f = t - k, a = at(k - 1), b = at(k), c = at(k + 1), d = at(k + 2);
  return b + 0.5 * f * (c - a + f * (2 * a - 5 * b + 4 * c - d + f * (3 * (b - c) + d - a)));
}
}  // namespace

ClosedSurface bodyOutline() {
  ClosedSurface s;
  const double last = static_cast<double>(std::size(kSections)) - 1;
  for (int i = 0; i < kLevels; ++i) {
    const double t = last * i / (kLevels - 1);
    const double front = along(t, &Section::front), back = along(t, &Section::back);
    for (int k = 0; k < kAround; ++k) {
      const double a = 2 * kPi * k / kAround, c = std::cos(a), n = std::sin(a);
      const auto round = [](double v) {
        return std::copysign(std::pow(std::abs(v), 2 / kSquareness), v);
      };
      const Vec3 p(along(t, &Section::half) * round(c),
                   0.5 * (front + back) + 0.5 * (back - front) * round(n), along(t, &Section::z));
      s.positions.push_back((p * kMetrePerMm).cast<float>());
    }
  }
  const int top = static_cast<int>(s.positions.size()), bottom = top + 1;
  for (int level : {0, kLevels - 1}) {
    Vec3f mean = Vec3f::Zero();
    for (int k = 0; k < kAround; ++k) mean += s.positions[level * kAround + k] / float(kAround);
    s.positions.push_back(mean);
  }
  const auto at = [](int i, int k) { return i * kAround + k % kAround; };
  for (int k = 0; k < kAround; ++k) {
    s.triangles.push_back({top, at(0, k), at(0, k + 1)});
    s.triangles.push_back({bottom, at(kLevels - 1, k + 1), at(kLevels - 1, k)});
    for (int i = 0; i + 1 < kLevels; ++i) {
      s.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      s.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  }
  return s;
}
}  // namespace swallowclip::render
