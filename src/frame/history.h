// SPDX-License-Identifier: MIT
// Everything one simulated swallow leaves behind: written once, then measured, drawn and exported
// without simulating again. Metres, seconds; float32 arrays. Frame k is at time_s[k]; time 0 is
// the cue. The file form is HDF5 with an XDMF side file (history_file.h).
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/tri_mesh.h"
#include "core/vec.h"

namespace swallowclip::frame {

inline constexpr int kHistoryVersion = 1;

enum class ParticleState : std::uint8_t { fluid = 0, film = 1, swallowed = 2, coating = 3 };
/// Neither swallowed nor lent to the walls' coating as a whole.
constexpr bool isThere(ParticleState state) {
  return state == ParticleState::fluid || state == ParticleState::film;
}
enum class Region : std::uint8_t {
  oral = 0,
  oropharynx,
  nasopharynx,
  hypopharynx,
  larynx,
  esophagus,
  swallowed
};
const char* name(Region region);

/// Which side of the lumen a skin vertex belongs to.
enum class Wall : std::uint8_t {
  palate = 0,  ///< hard palate (maxilla)
  velum,       ///< soft palate, both faces
  posterior,   ///< pharyngeal wall, posterior and lateral
  tongue,
  larynx,     ///< epiglottis, aryepiglottic folds, vestibule, post-cricoid
  esophagus,  ///< UES and below
};

/// One anatomical structure. Rigid: `poses[frame]` on `rest`; soft: `positions[frame][vertex]`.
struct StructureTrack {
  std::string name;      ///< tongue, mandible, hyoid, ... (scene name)
  std::string material;  ///< muscle, bone, cartilage, enamel, mucosa
  bool rigid = true;
  std::vector<Triangle> triangles;
  std::vector<Vec3f> rest;
  std::vector<Pose> poses;
  std::vector<std::vector<Vec3f>> positions;

  /// Vertex positions at a frame, whichever kind it is.
  std::vector<Vec3f> at(int frame) const;
};

/// The airway-skin. `s_m` and `u` are material coordinates: arc length along the bolus path at
/// rest, and -1 (right edge) .. 1 (left edge) across it. Triangles face out of the lumen.
struct SkinTrack {
  std::vector<Triangle> triangles;
  std::vector<Wall> wall;  ///< [vertex]
  std::vector<float> s_m, u;
  std::vector<std::vector<Vec3f>> positions, velocities;  ///< [frame][vertex]
  std::vector<std::vector<float>> film_m;                 ///< [frame][triangle], may be empty
};

/// [frame][particle]; particle k is the same one in every frame; a swallowed one stays where it
/// crossed the UES plane, one that has become coating where it did so.
struct BolusTrack {
  double particleVolume_m3 = 0;
  std::vector<std::vector<Vec3f>> positions, velocities;
  std::vector<std::vector<float>> densityRatio;  ///< rho / rho0
  std::vector<std::vector<ParticleState>> state;
  std::vector<std::vector<Region>> region;
  std::vector<std::vector<float>> s_m;  ///< path coordinate of the nearest skin point
  /// Share of its volume that lies on the walls (SkinTrack::film_m); empty when they are not
  /// coated.
  std::vector<std::vector<float>> lentShare;

  /// What a particle still has.
  double volume_m3(int frame, std::size_t particle) const {
    return particleVolume_m3 * (lentShare.empty() ? 1.0 : 1.0 - lentShare[frame][particle]);
  }
};

struct LandmarkTrack {
  std::string name;
  std::vector<Vec3f> positions;  ///< [frame]
};

/// A planned (from the swallow file) or measured event. ASPEKT names where there is one.
struct Event {
  std::string name;
  double time_s = 0;
};

/// Fluid accounting of one frame, in particle counts.
struct LedgerRow {
  std::int32_t start = 0, fluid = 0, film = 0, swallowed = 0, escaped = 0;
};

struct Meta {
  int version = kHistoryVersion;
  std::string scene, swallow, bolus, solver, program;
  std::string inputsSha256;
  int component = 0, score = -1;  ///< what the clip is meant to show; 0/-1 when nothing
  double fps = 30;
  double cue_s = 0;
  std::vector<double> cues_s;  ///< all cues, the first one first
  double density_kgm3 = 0, viscosity_Pas = 0;
  double bariumSulfate_kgm3 = 0;  ///< in the bolus; 400 kg/m3 = 40 % w/v
  double particleSpacing_m = 0;
  double meanDensityError = 0, maxDensityError = 0;  ///< over all particles and steps, film apart
  double shareAboveTenPercent = 0;                   ///< particle-steps with density error > 10 %
  double maxSpeed_ms = 0;
  std::int64_t steps = 0;           ///< of the bolus solver
  std::int64_t velocityClamps = 0;  ///< particle-steps slowed down because they outran their step
};

struct History {
  Meta meta;
  std::vector<double> time_s;
  std::vector<StructureTrack> structures;
  SkinTrack skin;
  BolusTrack bolus;  ///< empty arrays when there is no bolus
  std::vector<LandmarkTrack> landmarks;
  std::vector<Event> plannedEvents;
  std::vector<LedgerRow> ledger;  ///< [frame]

  int frames() const { return static_cast<int>(time_s.size()); }
  const StructureTrack* find(const std::string& name) const;
  const LandmarkTrack* landmark(const std::string& name) const;
  /// "" when sizes agree and every number is finite, else what is wrong.
  std::string validate() const;
  /// Digest of all state (positions, velocities, fluid) of one frame.
  std::uint64_t digest(int frame) const;
};
}  // namespace swallowclip::frame
