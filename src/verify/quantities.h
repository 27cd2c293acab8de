// SPDX-License-Identifier: MIT
// What is measured on the particles, by name.
#pragma once
#include <string>
#include <vector>

#include "bolus/solver.h"
#include "verify/case.h"
#include "verify/film.h"
#include "verify/references.h"

namespace swallowclip::verify {

/// The fluid at one time, in the frame of the walls.
struct Snapshot {
  const CaseDef* def = nullptr;
  double time_s = 0, spacing_m = 0, particleVolume_m3 = 0;
  std::vector<Vec3> positions, velocities;
  std::vector<double> pressure_Pa, densityRatio;
  std::vector<Patch> patches;         ///< walls that the fluid has left
  Vec3 up{0, 0, 1};                   ///< against gravity
  Vec3 firstMomentum = Vec3::Zero();  ///< of the start, kg m/s
  int escaped = 0;
};

std::vector<std::string> quantityNames();    ///< "profile" first
std::vector<std::string> fieldNames();       ///< of profiles
std::vector<std::string> coordinateNames();  ///< of profiles
/// "mm", "mm/s", "Pa", ... and what to multiply SI by, for tables and plots.
struct Unit {
  const char* text;
  double perSi;
};
Unit unitOf(const QuantityDef& quantity);

/// One number of a snapshot (every kind but profile).
double measureSeries(const QuantityDef& quantity, const Snapshot& s);

/// Means over bins of a coordinate, measured and referred to at the same particles, summed over
/// snapshots: what binning does to a curved profile it does to both.
class ProfileSum {
 public:
  void add(const QuantityDef& quantity, const Snapshot& s, const Reference& reference);
  struct Point {
    double along, measured, reference;
  };
  std::vector<Point> points() const;  ///< of bins with particles

 private:
  double low_ = 0, width_ = 0;
  void addPatches(const QuantityDef& quantity, const Snapshot& s, const Reference& reference);
  void addOne(double at, double measured, double wanted);

  std::vector<double> count_, along_, measured_, reference_;
};
}  // namespace swallowclip::verify
