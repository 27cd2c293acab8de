// SPDX-License-Identifier: MIT
#include "scoring/midline.h"

#include <algorithm>
#include <cmath>

namespace swallowclip::scoring {
namespace {

using frame::SkinTrack;
using frame::Wall;

bool onMidline(const SkinTrack& skin, int v) {
  return std::abs(skin.u[v]) <= kMidlineU;
}
bool isLower(Wall w) {
  return w == Wall::tongue || w == Wall::larynx;
}
bool isUpper(Wall w) {
  return w == Wall::palate || w == Wall::velum || w == Wall::posterior;
}

/// Neighbours along a column, per vertex.
std::vector<std::vector<int>> columnEdges(const SkinTrack& skin) {
  std::vector<std::vector<int>> next(skin.u.size());
  for (const Triangle& t : skin.triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      if (!onMidline(skin, a) || !onMidline(skin, b)) continue;
      const double step_m = std::abs(double(skin.s_m[a]) - double(skin.s_m[b]));
      if (step_m <= kSameStation_m || step_m > kColumnStep_m) continue;
      next[a].push_back(b);
      next[b].push_back(a);
    }
  return next;
}

/// All vertices that hang together with `start`, marked in `reached`.
std::vector<int> walk(const std::vector<std::vector<int>>& next, int start,
                      std::vector<char>& reached) {
  std::vector<int> found{start};
  reached[start] = 1;
  for (std::size_t k = 0; k < found.size(); ++k)
    for (int v : next[found[k]])
      if (!reached[v]) reached[v] = 1, found.push_back(v);
  return found;
}

void sortByS(const SkinTrack& skin, std::vector<int>& column) {
  std::sort(column.begin(), column.end(), [&](int a, int b) {
    return skin.s_m[a] != skin.s_m[b] ? skin.s_m[a] < skin.s_m[b] : a < b;
  });
}

/// A walked stretch belongs to one sheet; its labelled vertices say to which, and the esophagus'
/// vertices go with them.
void assign(const SkinTrack& skin, const std::vector<int>& stretch, MidlineColumns& out) {
  auto any = [&](bool (*of)(Wall)) {
    return std::any_of(stretch.begin(), stretch.end(), [&](int v) { return of(skin.wall[v]); });
  };
  const bool lower = any(isLower), upper = any(isUpper);
  for (int v : stretch) {
    const bool toLower = isLower(skin.wall[v]) || (!isUpper(skin.wall[v]) && lower && !upper);
    const bool toUpper = isUpper(skin.wall[v]) || (!isLower(skin.wall[v]) && upper && !lower);
    if (toLower) out.lower.push_back(v);
    if (toUpper) out.upper.push_back(v);
  }
}

/// The branch's two midline columns carry the s of the inlet's front and back rim.
void findVestibule(const SkinTrack& skin, const std::vector<int>& mid,
                   const std::vector<char>& reached, MidlineColumns& out) {
  std::vector<int> inside;
  for (int v : mid)
    if (!reached[v] && skin.wall[v] == Wall::larynx) inside.push_back(v);
  if (inside.empty()) return;
  sortByS(skin, inside);
  const double front_m = skin.s_m[inside.front()], back_m = skin.s_m[inside.back()];
  if (back_m - front_m <= kColumnStep_m) return;
  for (int v : inside) {
    if (skin.s_m[v] - front_m <= kSameStation_m) out.vestibuleFront.push_back(v);
    if (back_m - skin.s_m[v] <= kSameStation_m) out.vestibuleBack.push_back(v);
  }
}

/// The same for the port behind the velum; the branch's far end carries an s between its rims'.
void findPort(const SkinTrack& skin, const std::vector<int>& mid, const std::vector<char>& reached,
              MidlineColumns& out) {
  double back_m = 0;
  for (int v : mid) {
    if (reached[v]) continue;
    if (skin.wall[v] == Wall::velum) out.portFront.push_back(v);
    if (skin.wall[v] == Wall::posterior) back_m = std::max(back_m, double(skin.s_m[v]));
  }
  for (int v : mid)
    if (!reached[v] && skin.wall[v] == Wall::posterior && back_m - skin.s_m[v] <= kSameStation_m)
      out.portBack.push_back(v);
}
}  // namespace

MidlineColumns findMidline(const SkinTrack& skin) {
  std::vector<int> mid;
  for (std::size_t v = 0; v < skin.u.size(); ++v)
    if (onMidline(skin, static_cast<int>(v))) mid.push_back(static_cast<int>(v));
  MidlineColumns out;
  if (mid.empty()) return out;
  sortByS(skin, mid);

  const double first_m = skin.s_m[mid.front()], last_m = skin.s_m[mid.back()];
  const auto next = columnEdges(skin);
  std::vector<char> reached(skin.u.size(), 0);
  for (int v : mid) {
    const bool atEnd =
        skin.s_m[v] - first_m <= kSameStation_m || last_m - skin.s_m[v] <= kSameStation_m;
    if (atEnd && !reached[v]) assign(skin, walk(next, v, reached), out);
  }
  findVestibule(skin, mid, reached, out);
  findPort(skin, mid, reached, out);
  sortByS(skin, out.lower);
  sortByS(skin, out.upper);
  return out;
}
}  // namespace swallowclip::scoring
