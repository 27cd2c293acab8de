// SPDX-License-Identifier: MIT
#include "scoring/lumen.h"

#include <algorithm>
#include <cmath>

#include "scoring/sheet_distance.h"

namespace swallowclip::scoring {
namespace {

using frame::SkinTrack;

/// Triangles that touch a column and none of the vertices of another.
std::vector<Triangle> trianglesAlong(const SkinTrack& skin, const std::vector<int>& column,
                                     const std::vector<int>& other) {
  std::vector<char> mark(skin.u.size(), 0);
  for (int v : column) mark[v] = 1;
  for (int v : other) mark[v] = 2;
  std::vector<Triangle> out;
  for (const Triangle& t : skin.triangles) {
    const auto has = [&](char m) {
      return std::any_of(t.begin(), t.end(), [&](int v) { return mark[v] == m; });
    };
    if (has(1) && !has(2)) out.push_back(t);
  }
  return out;
}

std::string sizeProblem(const SkinTrack& skin) {
  const std::size_t n = skin.wall.size();
  if (n == 0) return "the history has no airway-skin";
  if (skin.s_m.size() != n || skin.u.size() != n)
    return fmt::format("{} wall labels, {} s and {} u values", n, skin.s_m.size(), skin.u.size());
  for (std::size_t f = 0; f < skin.positions.size(); ++f)
    if (skin.positions[f].size() != n)
      return fmt::format("frame {} has {} skin positions for {} vertices", f,
                         skin.positions[f].size(), n);
  for (const Triangle& t : skin.triangles)
    for (int v : t)
      if (v < 0 || v >= static_cast<int>(n)) return fmt::format("triangle names vertex {}", v);
  return skin.positions.empty() ? "the skin has no frames" : "";
}

/// [frame][front vertex] distance from a branch's front column to its back one.
std::vector<std::vector<double>> branchGaps(const SkinTrack& skin, const std::vector<int>& front,
                                            const std::vector<int>& behind) {
  std::vector<std::vector<double>> out;
  auto back = trianglesAlong(skin, behind, front);
  if (front.empty() || back.empty()) return out;
  SheetDistance distance(std::move(back), front.size());
  for (const auto& x : skin.positions) {
    distance.setFrame(x);
    auto& gaps = out.emplace_back();
    for (std::size_t k = 0; k < front.size(); ++k)
      gaps.push_back(distance(k, x[front[k]].cast<double>()));
  }
  return out;
}

std::vector<double> narrowest(const std::vector<std::vector<double>>& gaps) {
  std::vector<double> out;
  for (const auto& g : gaps) out.push_back(*std::min_element(g.begin(), g.end()));
  return out;
}
}  // namespace

Result<LumenProfile> midlineGaps(const SkinTrack& skin) {
  if (const std::string problem = sizeProblem(skin); !problem.empty())
    return failure("history /skin", problem, "simulate again");
  const MidlineColumns mid = findMidline(skin);
  std::vector<Triangle> upper = trianglesAlong(skin, mid.upper, mid.lower);
  if (mid.lower.empty() || upper.empty())
    return failure("history /skin", "no midline column (u = 0) on both sheets of the lumen",
                   "use a scene whose airway-skin has path coordinates");

  LumenProfile out;
  for (int v : mid.lower) {
    const double s_m = skin.s_m[v];
    if (out.stations.empty() || s_m - out.stations.back().s_m > kSameStation_m)
      out.stations.push_back({s_m, v, skin.wall[v]});
  }
  SheetDistance distance(std::move(upper), out.stations.size());
  for (const auto& x : skin.positions) {
    distance.setFrame(x);
    auto& g = out.gap_m.emplace_back(out.stations.size());
    for (std::size_t k = 0; k < out.stations.size(); ++k)
      g[k] = distance(k, x[out.stations[k].vertex].cast<double>());
  }
  out.vestibuleFront = mid.vestibuleFront;
  out.vestibuleGap_m = branchGaps(skin, mid.vestibuleFront, mid.vestibuleBack);
  out.vestibule_m = narrowest(out.vestibuleGap_m);
  out.port_m = narrowest(branchGaps(skin, mid.portFront, mid.portBack));
  return out;
}

double LumenProfile::gapAt(int frame, double s_m) const {
  const auto& g = gap_m[frame];
  const auto after = std::lower_bound(stations.begin(), stations.end(), s_m,
                                      [](const Station& a, double s) { return a.s_m < s; });
  if (after == stations.begin()) return g.front();
  if (after == stations.end()) return g.back();
  const std::size_t k = after - stations.begin();
  const double w = (s_m - stations[k - 1].s_m) / (stations[k].s_m - stations[k - 1].s_m);
  return (1 - w) * g[k - 1] + w * g[k];
}

std::pair<int, int> LumenProfile::range(double from_m, double to_m) const {
  int a = 0;
  const int n = static_cast<int>(stations.size());
  while (a < n && stations[a].s_m < from_m - kSameStation_m) ++a;
  int b = a;
  while (b < n && stations[b].s_m <= to_m + kSameStation_m) ++b;
  return {a, b};
}

double midlineArea_m2(const LumenProfile& lumen, const SkinTrack& skin, int frame, double from_m,
                      double to_m) {
  const auto [a, b] = lumen.range(from_m, to_m);
  const auto& x = skin.positions[frame];
  double area = 0;
  for (int k = a + 1; k < b; ++k) {
    // No tissue between two stations (the laryngeal inlet): not part of this area.
    if (lumen.stations[k].s_m - lumen.stations[k - 1].s_m > kColumnStep_m) continue;
    const double length =
        (x[lumen.stations[k].vertex] - x[lumen.stations[k - 1].vertex]).cast<double>().norm();
    area += 0.5 * (lumen.gap_m[frame][k] + lumen.gap_m[frame][k - 1]) * length;
  }
  return area;
}
}  // namespace swallowclip::scoring
