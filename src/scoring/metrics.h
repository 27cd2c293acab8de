// SPDX-License-Identifier: MIT
// What was measured on one history: numbers with their unit, frame and rule in words, the scores
// they lead to, and why something could not be judged. Values only; render and cli read this.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace swallowclip::scoring {

inline constexpr int kComponents = 17;  ///< MBSImP

/// One measured number. `unit`: "mm", "mm/s", "s", "share", "count", "mm2"; "" for ratios.
struct Quantity {
  std::string name;
  std::optional<double> value;  ///< empty: not judged, see `reason`
  std::string unit;
  int frame = -1;      ///< where it was read; -1 when it belongs to the whole swallow
  std::string rule;    ///< how it is defined, in words
  std::string reason;  ///< why there is no value
  std::vector<double> cuts =
      {};  ///< of the scores that it decides, same unit; filled in by measure()
};

/// Gives a quantity its value; non-finite ones stay empty with their reason.
void set(Quantity& quantity, double value, int frame = -1);

/// A measured event; `frame` is the first frame at or after its time.
struct MeasuredEvent {
  std::string name;
  std::optional<double> time_s;
  int frame = -1;
  std::string rule, reason;
};

/// A curve over time for plots; NaN where it is not defined. [frame]
struct Series {
  std::string name, unit;
  std::vector<double> values;
};

/// Metres over time, as millimetres.
Series inMillimetres(std::string name, const std::vector<double>& values_m);

/// Particle counts at the last frame, and the solver's own error figures.
struct Conservation {
  int particlesStart = 0, particlesEnd = 0, swallowed = 0;
  int leftInOral = 0, leftInPharynx = 0, inAirway = 0, inNasopharynx = 0, inEsophagus = 0;
  int escaped = 0;
  int coated = 0;  ///< particles that lie on the walls as a whole, no longer as particles
  double swallowedFraction = 0, filmFraction = 0;
  double meanDensityError = 0, maxDensityError = 0;
  double shareAboveTenPercent = 0;  ///< of particle-steps
  std::int64_t velocityClamps = 0;  ///< times that a particle would have outrun its contacts

  /// On the walls, thinner than a particle; empty when the bolus coats none. Then swallowedFraction
  /// is one of volume.
  std::optional<double> coating_m3;
  /// Fluid, film, what is swallowed and the coating, against the start, as a share: the worst
  /// frame's. With a coating 1e-7, as single precision keeps it in the history.
  double volumeError = 0;

  /// Every particle that started is somewhere.
  bool balanced() const {
    return particlesStart == swallowed + particlesEnd + coated + escaped &&
           particlesEnd == leftInOral + leftInPharynx + inAirway + inNasopharynx + inEsophagus;
  }
};

struct Metrics {
  int component = 0, score = -1;  ///< what the clip is meant to show (0/-1: nothing)
  std::vector<Quantity> quantities;
  std::vector<MeasuredEvent> events;
  std::vector<Series> series;
  std::map<int, std::optional<int>> scores;  ///< 1..17
  std::map<int, std::string> reasons;        ///< per component: why this score, or why none
  std::map<int, bool> ambiguous;             ///< judged components: too near a cut to ship
  std::map<int, double> margins;             ///< distance to the nearest cut, as a share of it
  std::map<int, std::string> nearestCuts;    ///< which one, "section.key" of the rules
  std::map<int, int> scoredFrames;           ///< at which a component was judged
  std::map<int, std::string> liveSeries;     ///< the series that shows what decides
  /// The intended score was measured and is not ambiguous. Empty when nothing was intended or the
  /// component could not be judged; then `labelReason` says why.
  std::optional<bool> labelConfirmed;
  std::string labelReason;
  std::optional<Conservation> conservation;  ///< empty without bolus

  const Quantity* quantity(std::string_view name) const;
  const MeasuredEvent* event(std::string_view name) const;
  const Series* find(std::string_view seriesName) const;
};

/// All of it as a plain text table.
std::string formatTable(const Metrics& metrics);
}  // namespace swallowclip::scoring
