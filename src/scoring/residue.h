// SPDX-License-Identifier: MIT
// What is left, how much and where: particles and wall film together, by region (the history's) and
// by location (where the nearest skin lies), once the swallow is over.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "frame/history.h"
#include "scoring/decision.h"

namespace swallowclip::scoring {

/// Locations that readers name, our order; left and right are the patient's.
enum class Location {
  floorOfMouth,
  palate,
  tongue,
  sulcusLeft,
  sulcusRight,
  tongueBase,
  valleculaLeft,
  valleculaRight,
  pharyngealWall,
  folds,
  pyriformLeft,
  pyriformRight,
  elsewhere,  ///< airway, nasopharynx, esophagus
};
inline constexpr int kLocations = static_cast<int>(Location::elsewhere) + 1;
const char* name(Location location);
/// Component 5 or 16; 0 elsewhere. The letter that its readers use ("A" to "E").
int componentOf(Location location);
const char* letterOf(Location location);

/// One drop of what is left: a particle, or the film on a triangle.
struct Deposit {
  Vec3 position = Vec3::Zero();
  double volume_m3 = 0;
  double film_m = 0;  ///< thickness, for film
  Location location = Location::elsewhere;
};

struct Residue {
  int frame = -1;
  std::string when;       ///< how the frame was chosen
  double offered_m3 = 0;  ///< V0
  std::vector<Deposit> deposits;

  double volume_m3(Location location) const;
  double volume_m3(int component) const;
  /// Largest volume per wall area of a component's deposits within `radius_m`, or the thickest
  /// film.
  double thickness_m(int component, double radius_m) const;
};

/// The first frame from `swRest` on at which what is left moves slower than the rules' speed on
/// average; the last frame when there is none, or no rest. Empty without bolus.
std::optional<Residue> measureResidue(const frame::History& history, std::optional<int> swRest,
                                      const ScoringRules& rules);

/// All deposits at a frame.
std::vector<Deposit> depositsAt(const frame::History& history, int frame,
                                const ScoringRules& rules);

struct ResidueMeasures {
  double share = 0, thickness_m = 0;
};
/// The residue rule.
std::optional<int> scoreResidue(const ResidueMeasures& m, const ScoringRules& rules);

/// Component 5 or 16. `residue` empty: no bolus.
ComponentReport measureResidueComponent(int component, const std::optional<Residue>& residue,
                                        const ScoringRules& rules);
}  // namespace swallowclip::scoring
