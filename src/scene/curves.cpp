// SPDX-License-Identifier: MIT
#include "scene/curves.h"

namespace swallowclip::scene {
namespace {
template <class Points>
bool increasing(const JsonNode& node, std::string_view key, const Points& points) {
  if (points.empty()) {
    if (node.has(key)) node.member(key).fail("the list is empty", "Give at least one point.");
    return false;
  }
  for (std::size_t i = 1; i < points.size(); ++i)
    if (!(points[i][0] > points[i - 1][0])) {
      node.member(key).fail(fmt::format("point {} does not come after point {} ({} after {})",
                                        i + 1, i, points[i][0], points[i - 1][0]),
                            "Sort the points by their first number, each one once.");
      return false;
    }
  return true;
}
}  // namespace

Curve readCurve(const JsonNode& node, std::string_view key, double xScale, double valueScale) {
  const std::vector<Vec2> points = node.points2(key);
  if (!increasing(node, key, points)) return Curve({0}, {0});
  std::vector<double> x, y;
  for (const Vec2& p : points) {
    x.push_back(p[0] * xScale);
    y.push_back(p[1] * valueScale);
  }
  return Curve(x, y);
}

std::array<Curve, 2> readCurvePair(const JsonNode& node, std::string_view key, double xScale,
                                   double valueScale) {
  const std::vector<Vec3> points = node.points3(key);
  if (!increasing(node, key, points)) return {Curve({0}, {0}), Curve({0}, {0})};
  std::vector<double> x, a, b;
  for (const Vec3& p : points) {
    x.push_back(p[0] * xScale);
    a.push_back(p[1] * valueScale);
    b.push_back(p[2] * valueScale);
  }
  return {Curve(x, a), Curve(x, b)};
}
}  // namespace swallowclip::scene
