// SPDX-License-Identifier: MIT
// A swallow with known answers: a straight channel along y (s = y), flat roof at z = 0, floor at
// z = -gap(s,t), and particles whose s is given by a function. No anatomy, no fluid.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "frame/history.h"
#include "scene/rules_file.h"

namespace swallowclip::scoring::testing {

inline constexpr double kMm = 1e-3;

/// The rules as shipped.
inline const ScoringRules& testRules() {
  static const ScoringRules rules =
      scene::loadScoringRules(SWALLOWCLIP_SOURCE_DIR "/scenes/scoring_rules.json").value();
  return rules;
}

inline double ramp(double t, double a, double b) {
  return std::clamp((t - a) / (b - a), 0.0, 1.0);
}

struct FakeSwallow {
  double duration_s = 3.2, fps = 30;
  double cue_s = 0;
  std::vector<double> cues_s = {};
  int particles = 200;  ///< 0: no bolus
  double stationStep_m = 1.5 * kMm, length_m = 195 * kMm;
  std::function<double(double s_m, double t_s)> gap_m = [](double, double) { return 8 * kMm; };
  /// s of a particle that starts at s0.
  std::function<double(double s0_m, double t_s)> particle_m = [](double s0, double) { return s0; };
};

inline frame::Wall lowerWall(double s_m) {
  if (s_m < 0.110) return frame::Wall::tongue;
  return s_m < 0.1499 ? frame::Wall::larynx : frame::Wall::esophagus;
}
inline frame::Wall upperWall(double s_m) {
  if (s_m < 0.050) return frame::Wall::palate;
  if (s_m < 0.080) return frame::Wall::velum;
  return s_m < 0.1499 ? frame::Wall::posterior : frame::Wall::esophagus;
}
inline frame::Region regionAt(double s_m) {
  if (s_m < 0.072) return frame::Region::oral;
  if (s_m < 0.122) return frame::Region::oropharynx;
  if (s_m < 0.150) return frame::Region::hypopharynx;
  return s_m < 0.180 ? frame::Region::esophagus : frame::Region::swallowed;
}

inline constexpr int kColumns = 9, kHalfWidthColumns = 4;

/// Two grids, lower then upper, sewn at u = +-1.
inline frame::SkinTrack fakeSkinTopology(const FakeSwallow& f) {
  frame::SkinTrack skin;
  const int rows = static_cast<int>(std::lround(f.length_m / f.stationStep_m)) + 1;
  for (int sheet = 0; sheet < 2; ++sheet)
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < kColumns; ++c) {
        const double s_m = r * f.stationStep_m;
        skin.s_m.push_back(static_cast<float>(s_m));
        skin.u.push_back(static_cast<float>(c - kHalfWidthColumns) / kHalfWidthColumns);
        skin.wall.push_back(sheet == 0 ? lowerWall(s_m) : upperWall(s_m));
      }
  auto id = [&](int sheet, int r, int c) { return (sheet * rows + r) * kColumns + c; };
  auto quad = [&](int a, int b, int c, int d) {
    skin.triangles.push_back({a, b, c});
    skin.triangles.push_back({a, c, d});
  };
  for (int r = 0; r + 1 < rows; ++r) {
    for (int c = 0; c + 1 < kColumns; ++c) {
      quad(id(0, r, c), id(0, r + 1, c), id(0, r + 1, c + 1), id(0, r, c + 1));
      quad(id(1, r, c), id(1, r, c + 1), id(1, r + 1, c + 1), id(1, r + 1, c));
    }
    for (int c : {0, kColumns - 1})
      quad(id(0, r, c), id(1, r, c), id(1, r + 1, c), id(0, r + 1, c));
  }
  return skin;
}

inline void addFakeBolus(const FakeSwallow& f, frame::History& h) {
  h.bolus.particleVolume_m3 = 5e-6 / f.particles;
  using frame::ParticleState;
  for (double t : h.time_s) {
    auto& s = h.bolus.s_m.emplace_back();
    auto& state = h.bolus.state.emplace_back();
    auto& region = h.bolus.region.emplace_back();
    auto& x = h.bolus.positions.emplace_back();
    frame::LedgerRow row{.start = f.particles};
    for (int k = 0; k < f.particles; ++k) {
      const double s_m = f.particle_m(0.020 + 0.025 * k / (f.particles - 1), t);
      s.push_back(static_cast<float>(s_m));
      region.push_back(regionAt(s_m));
      const bool gone = s_m > 0.180;
      state.push_back(gone ? ParticleState::swallowed : ParticleState::fluid);
      (gone ? row.swallowed : row.fluid) += 1;
      x.push_back(Vec3f(0, static_cast<float>(s_m), -0.001f));
    }
    h.bolus.velocities.emplace_back(x.size(), Vec3f::Zero());
    h.bolus.densityRatio.emplace_back(x.size(), 1.0f);
    h.ledger.push_back(row);
  }
}

inline frame::History makeHistory(const FakeSwallow& f) {
  frame::History h;
  h.meta.fps = f.fps;
  h.meta.cue_s = f.cue_s;
  h.meta.cues_s = f.cues_s;
  const int frames = static_cast<int>(std::lround(f.duration_s * f.fps)) + 1;
  for (int k = 0; k < frames; ++k) h.time_s.push_back(k / f.fps);

  h.skin = fakeSkinTopology(f);
  const std::size_t half = h.skin.s_m.size() / 2;
  for (double t : h.time_s) {
    auto& x = h.skin.positions.emplace_back();
    for (std::size_t v = 0; v < h.skin.s_m.size(); ++v) {
      const double s_m = h.skin.s_m[v];
      const double z = v < half ? -f.gap_m(s_m, t) : 0.0;
      x.push_back(Vec3f(10e-3f * h.skin.u[v], static_cast<float>(s_m), static_cast<float>(z)));
    }
    h.skin.velocities.emplace_back(x.size(), Vec3f::Zero());
  }
  if (f.particles > 0) addFakeBolus(f, h);
  return h;
}

/// Mouth whose contact ends at front(t) (gap 1 mm there, 0.1 mm before, 8 mm far behind), rest
/// open.
inline double sweptGap_m(double s_m, double front_m) {
  return std::clamp(1 * kMm + 0.5 * (s_m - front_m), 0.1 * kMm, 8 * kMm);
}

/// Contact front: 10 mm until t0, then to 110 mm at v.
inline double sweep_m(double t_s, double onset_s, double v_ms) {
  return std::clamp(0.010 + v_ms * (t_s - onset_s), 0.010, 0.110);
}

/// A particle that lies still until the front pushes it; the last of the sweep throws all of them
/// on, past the UES.
inline double pushed_m(double s0_m, double front_m) {
  if (front_m >= 0.110 - 1e-9) return 0.185;
  return std::max(s0_m, front_m + 0.002 + 0.6 * (s0_m - 0.020));
}

/// A clean sweep.
inline FakeSwallow sweepSwallow(double onset_s, double v_ms, double duration_s) {
  FakeSwallow f;
  f.duration_s = duration_s;
  f.gap_m = [=](double s, double t) { return sweptGap_m(s, sweep_m(t, onset_s, v_ms)); };
  f.particle_m = [=](double s0, double t) { return pushed_m(s0, sweep_m(t, onset_s, v_ms)); };
  return f;
}

/// `cycles` of forward-and-back of the front by `range_m` at 1.2 Hz from onset, the bolus with
/// `bolusRange_m`, then a sweep at v.
inline FakeSwallow rockingSwallow(double onset_s, int cycles, double range_m, double bolusRange_m,
                                  double v_ms, double duration_s) {
  constexpr double kRate_Hz = 1.2;
  const double sweep_s = onset_s + cycles / kRate_Hz;
  auto rock = [=](double t) {
    if (t < onset_s || t > sweep_s) return 0.0;
    return 0.5 * (1 - std::cos(2 * 3.14159265358979323846 * kRate_Hz * (t - onset_s)));
  };
  auto front = [=](double t) { return sweep_m(t, sweep_s, v_ms) + range_m * rock(t); };
  FakeSwallow f;
  f.duration_s = duration_s;
  f.gap_m = [=](double s, double t) { return sweptGap_m(s, front(t)); };
  f.particle_m = [=](double s0, double t) {
    return pushed_m(s0, sweep_m(t, sweep_s, v_ms)) + bolusRange_m * rock(t);
  };
  return f;
}

/// A landmark on a given course.
inline void addLandmark(frame::History& h, const char* name, auto course) {
  frame::LandmarkTrack track{name, {}};
  for (double t : h.time_s) track.positions.push_back(Vec3(course(t)).cast<float>());
  h.landmarks.push_back(track);
}

/// Channel along z downwards: the tongue in front (y = 0) and the wall behind it (y = gap).
inline frame::History uprightPharynx(const std::function<double(double s_m, double t_s)>& gap_m,
                                     const std::function<double(double s_m, double t_s)>& wall_m,
                                     double duration_s = 2) {
  FakeSwallow f;
  f.duration_s = duration_s, f.particles = 0;
  auto h = makeHistory(f);
  const std::size_t half = h.skin.s_m.size() / 2;
  for (int k = 0; k < h.frames(); ++k)
    for (std::size_t v = 0; v < h.skin.s_m.size(); ++v) {
      const double s = h.skin.s_m[v], t = h.time_s[k];
      const double y = 0.030 - wall_m(s, t) - (v < half ? gap_m(s, t) : 0);
      // s 92 lies at z = -39 and s 112 at -59, level with C2 and C3.
      h.skin.positions[k][v] = Vec3(0.010 * h.skin.u[v], y, 0.053 - s).cast<float>();
    }
  addLandmark(h, "C2_anterior_inferior", [](double) { return Vec3(0, 0.035, -0.048); });
  addLandmark(h, "C3_anterior_superior", [](double) { return Vec3(0, 0.035, -0.050); });
  addLandmark(h, "C4_anterior_inferior", [](double) { return Vec3(0, 0.035, -0.085); });
  return h;
}
}  // namespace swallowclip::scoring::testing
