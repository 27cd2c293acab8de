// SPDX-License-Identifier: MIT
// One swallow as a timeline. Times in seconds; track times count from the planned BPM, which lies
// `bpm_s` after the cue (time 0). Source of the defaults: scenes/swallows/normal.json.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "core/curve.h"
#include "core/vec.h"

namespace swallowclip::kinematics {

/// Rise from 0 at onset to `amplitude * peakValue` at peak, hold, return to 0 at offset (minimum
/// jerk). `peakValue` is a length in m or a ratio, `amplitude` the gain of a score file; `delay_s`
/// shifts and `speed` divides the durations about the onset.
struct Track {
  double onset_s = 0, peak_s = 0, hold_s = 0, offset_s = 0;
  double peakValue = 1, amplitude = 1, delay_s = 0, speed = 1;

  double at(double tau_s) const;
};

/// A place between tongue and palate where they do not meet: the gap that is left once the contact
/// front has passed. Profile across as that of the dorsal groove.
struct Hollow {
  double start_m = 0, end_m = 0;         ///< along s
  double centre_m = 0, halfWidth_m = 0;  ///< along x, patient left positive
  double depth_m = 0;
};

struct SwallowDef {
  std::string name, title;
  int component = 0, score = -1;
  double duration_s = 3.18;
  double bpm_s = 1.2;
  std::vector<double> cues_s{0};
  std::map<std::string, Track> tracks;
  Curve front_m;                  ///< tail of the lumen's contact front (m along s) over tau
  double frontAmplitude = 1;      ///< 0: no wave at all
  double volume_m3 = 5e-6;        ///< V0, the room of the held bolus follows it
  Vec3 gravity_ms2{0, 0, -9.81};  ///< in the head's frame: upright
  double grooveGive = 0;          ///< share of its depth that goes as the seal gives way
  double roomFactor = 1.2;        ///< held room / V0, DESIGN section 3: 1.15-1.3
  double grooveStart_m = 4e-3, grooveEnd_m = 54e-3, grooveHalfWidth_m = 10.5e-3;
  std::vector<Hollow> hollows;
  double rockAmplitude_m = 0, rockRate_hz = 1.2, rockCycles = 0, rockStart_s = 0;

  const Track& track(const std::string& key) const;
  /// What the swallow does for another volume: the held bolus keeps its shape in so far as the
  /// mouth is wide and long enough (its depth makes up for the rest), the UES opens wider, and more
  /// than the file's volume gets more time.
  void offer(double volume_m3);
};

/// The tracks that a swallow may define, and whether their peak is a length (else a ratio 0..1).
struct TrackKind {
  std::string name;
  bool length;
};
const std::vector<TrackKind>& trackKinds();
}  // namespace swallowclip::kinematics
