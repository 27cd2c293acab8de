// SPDX-License-Identifier: MIT
#include "frame/sample_history.h"

#include <cmath>

namespace swallowclip::frame {
namespace {
/// Numerical Recipes' quick linear congruential sequence; only variety matters here.
struct Noise {
  std::uint32_t state = 1;
  float next() {
    state = state * 1664525u + 1013904223u;
    return static_cast<float>(state >> 8) / 16777216.0f - 0.5f;
  }
  Vec3f vector(float scale) {
    const float x = next(), y = next(), z = next();
    return Vec3f(x, y, z) * scale;
  }
};

void makeGrid(int grid, std::vector<Triangle>& triangles, std::vector<Vec3f>& rest, Noise& noise) {
  for (int j = 0; j < grid; ++j)
    for (int i = 0; i < grid; ++i)
      rest.push_back(Vec3f(0.002f * static_cast<float>(i), 0.002f * static_cast<float>(j), 0) +
                     noise.vector(0.0005f));
  for (int j = 0; j + 1 < grid; ++j)
    for (int i = 0; i + 1 < grid; ++i) {
      const int a = j * grid + i;
      triangles.push_back({a, a + 1, a + grid});
      triangles.push_back({a + 1, a + grid + 1, a + grid});
    }
}
std::vector<Vec3f> moved(const std::vector<Vec3f>& rest, float by, Noise& noise) {
  std::vector<Vec3f> out = rest;
  for (Vec3f& p : out) p += Vec3f(0, by, -by) + noise.vector(1e-4f);
  return out;
}
}  // namespace

History sampleHistory(int frames, int grid, int particles) {
  Noise noise;
  History h;
  h.meta = {.version = kHistoryVersion,
            .scene = "adult",
            .swallow = "c04-s0",
            .bolus = "honey",
            .solver = "dfsph",
            .program = "swallowclip 0.1.0",
            .inputsSha256 = std::string(64, 'a'),
            .component = 4,
            .score = 0,
            .fps = 30,
            .cue_s = 0.1,
            .cues_s = {0.1, 1.0 / 3},
            .density_kgm3 = 1000,
            .viscosity_Pas = 1.0,
            .bariumSulfate_kgm3 = 400,
            .particleSpacing_m = 0.002,
            .meanDensityError = 0.001,
            .maxDensityError = 0.03,
            .shareAboveTenPercent = 1e-5,
            .maxSpeed_ms = 0.4};
  StructureTrack jaw{.name = "mandible",
                     .material = "bone",
                     .rigid = true,
                     .triangles = {},
                     .rest = {},
                     .poses = {},
                     .positions = {}};
  makeGrid(grid, jaw.triangles, jaw.rest, noise);
  StructureTrack hyoid = jaw;
  hyoid.name = "hyoid";
  StructureTrack tongue = jaw;
  tongue.name = "tongue";
  tongue.material = "muscle";
  tongue.rigid = false;
  h.skin.triangles = jaw.triangles;
  for (std::size_t v = 0; v < jaw.rest.size(); ++v) {
    h.skin.wall.push_back(static_cast<Wall>(v % 6));
    h.skin.s_m.push_back(0.01f * noise.next());
    h.skin.u.push_back(noise.next());
  }
  h.landmarks = {{"hyoid_anterior", {}}, {"tongue_tip", {}}};
  h.plannedEvents = {{"jaw opens", 0.05}, {"UES opens", 0.11}};
  h.bolus.particleVolume_m3 = 8e-9;
  for (int f = 0; f < frames; ++f) {
    const double t = f / 30.0;
    h.time_s.push_back(t);
    for (StructureTrack* s : {&jaw, &hyoid})
      s->poses.push_back(
          {Quat(Eigen::AngleAxisd(0.1 * std::sin(t + 1), Vec3(1, 2, 3).normalized())),
           Vec3(0.001 * t, std::sin(t) / 300, -0.01)});
    const float by = 0.001f * static_cast<float>(f);
    tongue.positions.push_back(moved(tongue.rest, by, noise));
    h.skin.positions.push_back(moved(jaw.rest, by, noise));
    h.skin.velocities.push_back(moved(jaw.rest, 0.1f, noise));
    h.skin.film_m.emplace_back(h.skin.triangles.size(), 1e-5f * static_cast<float>(f));
    for (LandmarkTrack& l : h.landmarks) l.positions.push_back(noise.vector(0.1f));
    auto& b = h.bolus;
    b.positions.emplace_back(), b.velocities.emplace_back(), b.densityRatio.emplace_back();
    b.state.emplace_back(), b.region.emplace_back(), b.s_m.emplace_back();
    for (int i = 0; i < particles; ++i) {
      b.positions.back().push_back(noise.vector(0.05f));
      b.velocities.back().push_back(noise.vector(0.3f));
      b.densityRatio.back().push_back(1 + 0.01f * noise.next());
      b.state.back().push_back(static_cast<ParticleState>((i + f) % 3));
      b.region.back().push_back(static_cast<Region>((i + f) % 7));
      b.s_m.back().push_back(noise.next());
    }
    h.ledger.push_back({particles, particles - f, f, 0, 0});
  }
  h.structures = {jaw, tongue, hyoid};
  return h;
}
}  // namespace swallowclip::frame
