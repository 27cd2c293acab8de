// SPDX-License-Identifier: MIT
#include "scoring/component13.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "scoring/events.h"
#include "scoring/midline.h"
#include "scoring/sheet_distance.h"
#include "scoring/spine.h"

namespace swallowclip::scoring {
namespace {
using frame::History;
using frame::Wall;

constexpr double kStill = 0.5;      // levels narrower than this share of a millimetre have no ratio
constexpr double kReach_m = 15e-3;  // opposite sheet beyond the judged levels; assumed, 10-30 mm

const MeasuredEvent* eventNamed(const std::vector<MeasuredEvent>& events, std::string_view name) {
  for (const auto& e : events)
    if (e.name == name && e.time_s) return &e;
  return nullptr;
}

double total(const std::vector<double>& x) {
  return std::accumulate(x.begin(), x.end(), 0.0);
}

/// Rise of the back wall's lower end since the cue, along the spine. [frame]
std::vector<double> shortening_m(const History& h, const ScoringRules& rules, int rest) {
  int lowest = -1;
  for (int v : findMidline(h.skin).upper)
    if (h.skin.wall[v] == Wall::posterior && h.skin.s_m[v] <= rules.pharynxEnd_m) lowest = v;
  std::vector<double> out;
  if (lowest < 0) return out;
  const double still = spineAt(h, rest).height_m(h.skin.positions[rest][lowest].cast<double>());
  for (int f = 0; f < h.frames(); ++f)
    out.push_back(spineAt(h, f).height_m(h.skin.positions[f][lowest].cast<double>()) - still);
  return out;
}

struct Judged {
  Component13Measures m;
  int leftFrame = -1, rightFrame = -1, pouchFrame = -1, mpc = -1, shortFrame = -1;
};

Judged judgeWalls(const History& h, const SideWalls& walls, int ueso, int uesc, int mpc, int rest,
                  const ScoringRules& rules) {
  Judged j;
  const Outline still = walls.at(rest);
  j.m.bulgeLeft = j.m.bulgeRight = -1;
  for (int f = ueso; f <= uesc; ++f) {
    const Outline now = walls.at(f);
    const double left = bulge(walls.levels_m(), now.left_m, still.left_m, rules.bestHeight_m);
    const double right = bulge(walls.levels_m(), now.right_m, still.right_m, rules.bestHeight_m);
    if (left > j.m.bulgeLeft) j.m.bulgeLeft = left, j.leftFrame = f;
    if (right > j.m.bulgeRight) j.m.bulgeRight = right, j.rightFrame = f;
    const double pouch =
        std::max(pouchDepth_m(walls.levels_m(), now.left_m, still.left_m, rules),
                 pouchDepth_m(walls.levels_m(), now.right_m, still.right_m, rules));
    if (pouch > j.m.pouch_m || j.pouchFrame < 0) j.m.pouch_m = pouch, j.pouchFrame = f;
  }
  const Outline narrowest = walls.at(mpc);
  j.mpc = mpc;
  j.m.residualWidth = (total(narrowest.left_m) + total(narrowest.right_m)) /
                      (total(still.left_m) + total(still.right_m));
  const std::vector<double> shortening = shortening_m(h, rules, rest);
  const auto most = std::max_element(shortening.begin() + rest, shortening.end());
  j.shortFrame = static_cast<int>(most - shortening.begin());
  j.m.shortening = *most / rules.normalShortening_m;
  return j;
}
}  // namespace

SideWalls::SideWalls(const frame::SkinTrack& skin, const ScoringRules& rules)
    : skin_(skin), visible_m_(rules.visibleChord_m) {
  std::vector<int> fixed;
  for (std::size_t v = 0; v < skin.wall.size(); ++v)
    if (skin.wall[v] == Wall::posterior && skin.s_m[v] >= rules.wallTop_m - kSameStation_m &&
        skin.s_m[v] <= rules.wallEnd_m + kSameStation_m)
      fixed.push_back(static_cast<int>(v));
  std::stable_sort(fixed.begin(), fixed.end(),
                   [&](int a, int b) { return skin.s_m[a] < skin.s_m[b]; });
  for (int v : fixed) {
    if (levels_m_.empty() || skin.s_m[v] - levels_m_.back() > kSameStation_m) {
      levels_m_.push_back(skin.s_m[v]);
      rows_.emplace_back();
    }
    rows_.back().push_back(v);
  }
  for (auto& row : rows_)
    std::stable_sort(row.begin(), row.end(), [&](int a, int b) { return skin.u[a] < skin.u[b]; });
  // Opposite: every triangle of the moving sheet, its branch included; the seam belongs to both.
  const auto moving = [&](int v) {
    return skin.wall[v] == Wall::tongue || skin.wall[v] == Wall::larynx;
  };
  for (const Triangle& t : skin.triangles)
    if (std::any_of(t.begin(), t.end(), moving) && std::all_of(t.begin(), t.end(), [&](int v) {
          return skin.s_m[v] > rules.wallTop_m - kReach_m &&
                 skin.s_m[v] < rules.wallEnd_m + kReach_m;
        }))
      opposite_.push_back(t);
  if (opposite_.empty()) levels_m_.clear(), rows_.clear();
}

Outline SideWalls::at(int frame) const {
  Outline out;
  std::size_t askers = 0;
  for (const auto& row : rows_) askers += row.size();
  SheetDistance distance(opposite_, askers);
  distance.setFrame(skin_.positions[frame]);
  const auto& x = skin_.positions[frame];
  std::size_t asker = 0;
  for (const auto& row : rows_) {
    std::vector<double> depth;
    for (int v : row) depth.push_back(distance(asker++, x[v].cast<double>()));
    // From one edge inwards to the first open column, its border interpolated.
    const auto edge = [&](int first, int step, double sign) {
      const int n = static_cast<int>(row.size());
      for (int c = first; c >= 0 && c < n; c += step) {
        if (depth[c] < visible_m_) continue;
        const double here = sign * x[row[c]].x();
        const int out_c = c - step;
        if (out_c < 0 || out_c >= n) return std::max(0.0, here);
        const double w = (depth[c] - visible_m_) / (depth[c] - depth[out_c]);
        return std::max(0.0, here + w * (sign * x[row[out_c]].x() - here));
      }
      return 0.0;
    };
    out.left_m.push_back(edge(static_cast<int>(row.size()) - 1, -1, 1));
    out.right_m.push_back(edge(0, 1, -1));
  }
  return out;
}

double bulge(const std::vector<double>& levels, const std::vector<double>& width,
             const std::vector<double>& rest, double height_m) {
  double best = -1;
  for (std::size_t a = 0; a < levels.size(); ++a) {
    double sum = 0;
    int n = 0;
    std::size_t b = a;
    for (; b < levels.size() && levels[b] - levels[a] <= height_m + kSameStation_m; ++b) {
      if (rest[b] < kStill * kMetrePerMm) continue;
      sum += width[b] / rest[b] - 1, ++n;
    }
    const bool whole = levels[b - 1] - levels[a] >= 0.9 * height_m;
    if (n > 0 && (whole || a == 0)) best = std::max(best, sum / n);
  }
  return best;
}

double pouchDepth_m(const std::vector<double>& levels, const std::vector<double>& width,
                    const std::vector<double>& rest, const ScoringRules& rules) {
  const int n = static_cast<int>(levels.size());
  std::vector<double> outward(n), bump(n);
  for (int k = 0; k < n; ++k) outward[k] = std::max(0.0, width[k] - rest[k]);
  for (int k = 0; k < n; ++k) {
    double sum = 0;
    int count = 0;
    for (int j = 0; j < n; ++j)
      if (std::abs(levels[j] - levels[k]) <= 0.5 * rules.outlineSmooth_m)
        sum += outward[j], ++count;
    bump[k] = outward[k] - sum / count;
  }
  double deepest = 0;
  for (int k = 0; k < n; ++k) {
    if (bump[k] <= deepest) continue;
    // Its height: where the outline stands out by more than half of the bump.
    const double half = outward[k] - 0.5 * bump[k];
    int a = k, b = k;
    while (a > 0 && outward[a - 1] >= half) --a;
    while (b + 1 < n && outward[b + 1] >= half) ++b;
    if (levels[b] - levels[a] <= rules.pouchHeight_m) deepest = bump[k];
  }
  return deepest;
}

std::optional<int> scoreComponent13(const Component13Measures& m, const ScoringRules& r) {
  const bool left = m.bulgeLeft >= r.bowing, right = m.bulgeRight >= r.bowing;
  const bool uneven = std::abs(m.bulgeLeft - m.bulgeRight) >= r.asymmetry;
  if (left && right) return 3;
  if ((left || right) && uneven) return 2;
  if (m.pouch_m >= r.pouch_m || m.residualWidth > r.residualWidth ||
      m.shortening < r.shorteningLeast)
    return 1;
  if (uneven) return std::nullopt;
  return 0;
}

ComponentReport measureComponent13(const History& h, const std::vector<MeasuredEvent>& events,
                                   const ScoringRules& rules) {
  ComponentReport out;
  const int rest = cueFrame(h);
  const MeasuredEvent *ueso = eventNamed(events, "UESO"), *uesc = eventNamed(events, "UESC"),
                      *mpc = eventNamed(events, "MPC");
  const SideWalls walls(h.skin, rules);
  const std::string lack = !ueso || !uesc                ? "the UES does not open and close again"
                           : !mpc                        ? "the pharynx never narrows"
                           : walls.levels_m().size() < 3 ? "the skin has no posterior wall there"
                                                         : "";
  const std::string where = fmt::format(
      "largest mean over the best {:g} mm of open half-width over "
      "its value at the cue, less 1, UESO to UESC: ",
      rules.bestHeight_m * 1e3);
  Quantity left{"side_wall_bulge_left", {}, "ratio", -1, where + "patient's left", lack, {}};
  Quantity right{"side_wall_bulge_right", {}, "ratio", -1, where + "patient's right", lack, {}};
  Quantity uneven{
      "side_wall_asymmetry", {}, "ratio", -1, "AI: difference of the two bulges", lack, {}};
  Quantity pouch{
      "pouch",
      {},
      "mm",
      -1,
      fmt::format("deepest outward bump up to {:g} mm tall beyond the outline at the cue "
                  "smoothed over {:g} mm, UESO to UESC",
                  rules.pouchHeight_m * 1e3, rules.outlineSmooth_m * 1e3),
      lack,
      {}};
  Quantity width{"residual_width",
                 {},
                 "ratio",
                 -1,
                 "K: open width at MPC over that at the cue, both sides, all levels",
                 lack,
                 {}};
  Quantity shorter{"shortening_ratio",
                   {},
                   "ratio",
                   -1,
                   fmt::format("largest rise of the pharynx' lower end since the cue over {:g} mm",
                               rules.normalShortening_m * 1e3),
                   lack,
                   {}};
  if (lack.empty()) {
    const Judged j = judgeWalls(h, walls, ueso->frame, uesc->frame, mpc->frame, rest, rules);
    const Component13Measures& m = j.m;
    set(left, m.bulgeLeft, j.leftFrame), set(right, m.bulgeRight, j.rightFrame);
    set(uneven, std::abs(m.bulgeLeft - m.bulgeRight)), set(pouch, m.pouch_m * 1e3, j.pouchFrame);
    set(width, m.residualWidth, j.mpc), set(shorter, m.shortening, j.shortFrame);
    out.decision = decide(
        [&](const ScoringRules& r) { return scoreComponent13(m, r); }, rules,
        fmt::format("bulge left {:.2f}, right {:.2f}; residual width {:.2f}, pouch "
                    "{:.1f} mm, shortening {:.2f}",
                    m.bulgeLeft, m.bulgeRight, m.residualWidth, m.pouch_m * 1e3, m.shortening));
    out.frame = j.mpc;
    if (!out.decision.score)
      out.decision.reason += ": the sides differ though neither bows, no score says so";
  } else {
    out.decision.reason = "pharyngeal contraction: " + lack;
  }
  out.quantities = {left, right, uneven, pouch, width, shorter};
  return out;
}
}  // namespace swallowclip::scoring
