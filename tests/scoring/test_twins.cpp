// SPDX-License-Identifier: MIT
// Slow twins: what the measures of components 4, 8, 13 and 15 say of random motions, found anew by
// brute force from the words of the rules.
#include <gtest/gtest.h>

#include <random>

#include "fake_swallow.h"
#include "scoring/component13.h"
#include "scoring/component15.h"
#include "scoring/component4.h"
#include "scoring/component8.h"

namespace swallowclip::scoring {
namespace {
using namespace testing;

/// A smooth random course over [0, 1]: a few waves, no sharper than 1/4 long.
struct Course {
  double a[4], phase[4];
  explicit Course(std::mt19937& random) {
    std::uniform_real_distribution<double> size(-1, 1), turn(0, 2 * kPi);
    for (int k = 0; k < 4; ++k) a[k] = size(random) / (k + 1), phase[k] = turn(random);
  }
  double operator()(double x) const {
    double sum = 0;
    for (int k = 0; k < 4; ++k) sum += a[k] * std::sin(2 * kPi * (k + 1) * x + phase[k]);
    return sum;
  }
};

TEST(Twin, ReversalsAreTheLongestZigzag) {
  ScoringRules rules = testRules();
  rules.accommodationRun_m = 0;
  std::mt19937 random(4);
  int seen[8] = {};
  for (int trial = 0; trial < 300; ++trial) {
    const Course course(random);
    std::vector<double> t, x;
    for (int k = 0; k < 90; ++k) t.push_back(k / 30.0), x.push_back(0.008 * course(k / 90.0));
    // Most points that can be chosen so that neighbours differ by 4 mm, up and down in turn.
    int most = 1;
    std::vector<std::array<int, 2>> ending(x.size(), {1, 1});  // [last one way up, down]
    for (std::size_t b = 0; b < x.size(); ++b)
      for (std::size_t a = 0; a < b; ++a) {
        if (x[b] - x[a] >= 0.004) ending[b][0] = std::max(ending[b][0], ending[a][1] + 1);
        if (x[a] - x[b] >= 0.004) ending[b][1] = std::max(ending[b][1], ending[a][0] + 1);
        most = std::max({most, ending[b][0], ending[b][1]});
      }
    const int turns = std::max(0, most - 2);
    EXPECT_EQ(countReversals(t, x, 90, 0.004, rules), turns) << "trial " << trial;
    ++seen[std::min(turns, 7)];
  }
  EXPECT_TRUE(seen[0] && seen[1] && seen[2] && seen[3]) << "the courses are too much alike";
}

TEST(Twin, LarynxIsJudgedWhereTheWordsSay) {
  const ScoringRules& r = testRules();
  const double lean = 8 * kPi / 180;
  const Vec3 up(0, std::sin(lean), std::cos(lean)), back(0, std::cos(lean), -std::sin(lean));
  std::mt19937 random(8);
  std::uniform_real_distribution<double> rise_mm(0, 25), most_deg(20, 150), shut(0, 1);
  for (int trial = 0; trial < 60; ++trial) {
    auto h = makeHistory({.duration_s = 2, .cue_s = 0.2, .particles = 0});
    const Course wobble(random);
    const double high_m = rise_mm(random) * kMm, turn_deg = most_deg(random), left = shut(random);
    const auto hump = [](double t) { return std::pow(std::sin(kPi * ramp(t, 0.3, 1.7)), 2); };
    addLandmark(h, "C4_anterior_inferior", [&](double) { return Vec3(0, 0.02, -0.09); });
    addLandmark(h, "C2_anterior_inferior",
                [&](double) { return Vec3(Vec3(0, 0.02, -0.09) + 0.037 * up); });
    const auto degrees = [&](double t) {
      return 24 + (turn_deg - 24) * hump(t) + 4 * hump(t) * wobble(t / 2);
    };
    addLandmark(h, "thyroid_notch", [&](double t) {
      return Vec3(high_m * (hump(0.95 * t) * up - 0.2 * hump(t) * back));
    });
    addLandmark(h, "epiglottis_petiole", [&](double t) { return Vec3(high_m * hump(t) * up); });
    addLandmark(h, "epiglottis_tip_cartilage", [&](double t) {
      const double a = degrees(t) * kPi / 180;
      return Vec3(high_m * hump(t) * up + 0.03 * (std::cos(a) * up + std::sin(a) * back));
    });
    for (const char* name : {"arytenoid_apex_L", "arytenoid_apex_R"})
      addLandmark(h, name, [&](double t) {
        return Vec3(high_m * hump(t) * up + 0.012 * (1 - left * hump(t)) * back);
      });
    const MeasuredEvent hyb{"HYB", h.time_s[12], 12, "", ""};
    const ComponentReport report = measureComponent8(h, {}, hyb, r);

    const int cue = 6, last = h.frames() - 1;
    std::vector<double> off, moved;
    for (double t : h.time_s) {
      off.push_back(std::abs(degrees(t) - 90));
      moved.push_back(std::abs(degrees(t) - degrees(h.time_s[cue])));
    }
    int far = cue;
    for (int f = cue; f <= last; ++f) far = moved[f] > moved[far] ? f : far;
    const double levelest = *std::min_element(off.begin() + cue, off.begin() + far + 1);
    int frame = cue;
    double normal_mm = 0;
    if (levelest <= 15) {
      while (off[frame] > levelest + 5) ++frame;
      normal_mm = r.normalRiseHorizontal_m * 1e3;
    } else if (moved[far] >= 10) {
      while (moved[frame] < moved[far] - 5) ++frame;
      normal_mm = r.normalRiseInverted_m * 1e3;
    } else {
      frame = 15;  // 0.1 s after the burst
      normal_mm = r.normalRiseOnset_m * 1e3;
    }
    const double t = h.time_s[frame], rest = h.time_s[cue];
    const double rise = high_m * 1e3 * (hump(0.95 * t) - hump(0.95 * rest)) / normal_mm;
    EXPECT_EQ(report.frame, frame) << "trial " << trial;
    EXPECT_NEAR(*report.quantities[0].value, rise, 1e-4) << "trial " << trial;
    EXPECT_NEAR(*report.quantities[1].value, (1 - left * hump(t)) / (1 - left * hump(rest)), 1e-4)
        << "trial " << trial;
  }
}

TEST(Twin, TongueBaseGapFromItsFormula) {
  std::mt19937 random(15);
  for (int trial = 0; trial < 20; ++trial) {
    const Course shape(random), bulge(random);
    const auto at = [](double s) { return (s - 0.070) / 0.060; };
    const auto gap = [&](double s, double t) {
      return 0.010 - ramp(t, 0.4, 1.1) * (0.006 + 0.001 * shape(at(s)));
    };
    const auto wall = [&](double s, double t) {
      return ramp(t, 0.5, 1.2) * (0.002 + 0.0005 * bulge(at(s)));
    };
    const auto h = uprightPharynx(gap, wall, 1.6);
    const TongueBase measured = measureTongueBase(h, 0, testRules());
    for (int f = 0; f < h.frames(); f += 6) {
      // C2 and C3 lie at z = -48 and -50 mm; the channel's s is 53 mm - z.
      std::vector<double> gaps, ways;
      for (int level = 0; level <= 17; ++level) {  // the tongue's tissue ends at s = 109.5 mm
        const double s = 0.092 + 0.001 * level, t = h.time_s[f];
        gaps.push_back(gap(s, t));
        ways.push_back(gap(s, 0) + wall(s, 0) - gap(s, t) - wall(s, t));
      }
      const auto median = [](std::vector<double> x) {
        std::ranges::sort(x);
        return 0.5 * (x[(x.size() - 1) / 2] + x[x.size() / 2]);
      };
      // Straight edges of 1.5 mm stay within 0.03 mm of the sharpest of these courses.
      EXPECT_NEAR(measured.gap_m[f], median(gaps), 0.04e-3) << "trial " << trial << " frame " << f;
      EXPECT_NEAR(measured.travel_m[f], median(ways), 0.05e-3) << "trial " << trial;
    }
  }
}

/// Nearest of many points of the moving sheet (tongue and larynx).
double sampledDepth_m(const frame::SkinTrack& skin, int frame, const Vec3& p) {
  constexpr int kSteps = 12;
  double best = 1;
  for (const Triangle& t : skin.triangles) {
    const auto moving = [&](int v) {
      return skin.wall[v] == frame::Wall::tongue || skin.wall[v] == frame::Wall::larynx;
    };
    if (!moving(t[0]) && !moving(t[1]) && !moving(t[2])) continue;
    const Vec3 a = skin.positions[frame][t[0]].cast<double>(),
               b = skin.positions[frame][t[1]].cast<double>(),
               c = skin.positions[frame][t[2]].cast<double>();
    if ((a - p).norm() > best + 0.010) continue;
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; i + j <= kSteps; ++j)
        best = std::min(best, (a + (b - a) * i / kSteps + (c - a) * j / kSteps - p).norm());
  }
  return best;
}

TEST(Twin, SideWallsBulgesAndPouches) {
  const ScoringRules& r = testRules();
  std::mt19937 random(13);
  for (int trial = 0; trial < 4; ++trial) {
    FakeSwallow f{.duration_s = 0.1, .particles = 0};
    auto h = makeHistory(f);
    const Course left(random), right(random), depth(random);
    const auto at = [](double s) { return (s - 0.080) / 0.080; };
    for (auto& x : h.skin.positions)
      for (std::size_t v = 0; v < x.size(); ++v) {
        const double s = h.skin.s_m[v], u = h.skin.u[v];
        if (&x == &h.skin.positions.front()) continue;  // the cue: as it is
        x[v].x() *= static_cast<float>(1 + 0.3 * (u > 0 ? left : right)(at(s)));
        // The roof stays; the floor comes up towards the edges, so that the lumen ends inside them.
        x[v].z() *= static_cast<float>((1 - 0.95 * u * u) * (0.8 + 0.2 * depth(at(s))));
      }
    const SideWalls walls(h.skin, r);
    const Outline rest = walls.at(0), now = walls.at(2);
    const auto& levels = walls.levels_m();
    ASSERT_GT(levels.size(), 30u);
    std::vector<double> edge[2], still[2];
    for (double level : levels)
      for (const int frame : {0, 2})
        for (const int side : {0, 1}) {
          // Outermost point of the fixed row that is 0.5 mm deep, in steps of a twentieth column.
          std::vector<Vec3> row;
          for (std::size_t v = h.skin.s_m.size() / 2; v < h.skin.s_m.size(); ++v)
            if (std::abs(h.skin.s_m[v] - level) < 1e-5)
              row.push_back(h.skin.positions[frame][v].cast<double>());
          std::vector<double> deep;
          for (const Vec3& p : row) deep.push_back(sampledDepth_m(h.skin, frame, p));
          double outermost = 0;
          for (int k = 0; k <= 20 * (static_cast<int>(row.size()) - 1); ++k) {
            const int c = std::min(k / 20, static_cast<int>(row.size()) - 2);
            const double w = k / 20.0 - c;
            const double x = (side ? -1 : 1) * ((1 - w) * row[c].x() + w * row[c + 1].x());
            if ((1 - w) * deep[c] + w * deep[c + 1] >= r.visibleChord_m)
              outermost = std::max(outermost, x);
          }
          (frame ? edge : still)[side].push_back(outermost);
        }
    // A twentieth of a column is 0.13 to 0.17 mm.
    for (std::size_t k = 0; k < levels.size(); ++k) {
      EXPECT_NEAR(now.left_m[k], edge[0][k], 0.25e-3) << "level " << levels[k];
      EXPECT_NEAR(now.right_m[k], edge[1][k], 0.25e-3) << "level " << levels[k];
    }
    for (const int side : {0, 1}) {
      const std::vector<double>&w = side ? now.right_m : now.left_m,
            &w0 = side ? rest.right_m : rest.left_m;
      double best = -1;
      for (std::size_t a = 0; a < levels.size(); ++a)  // every stretch of ten steps of 1.5 mm
        for (std::size_t b = a; b < levels.size(); ++b) {
          if (std::abs(levels[b] - levels[a] - 0.015) > 1e-4) continue;
          double sum = 0;
          for (std::size_t k = a; k <= b; ++k) sum += edge[side][k] / still[side][k] - 1;
          best = std::max(best, sum / static_cast<double>(b - a + 1));
        }
      EXPECT_NEAR(bulge(levels, w, w0, r.bestHeight_m), best, 0.05) << "side " << side;
    }
  }
}
}  // namespace
}  // namespace swallowclip::scoring
