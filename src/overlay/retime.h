// SPDX-License-Identifier: MIT
// The model's time as a function of the patient's: a monotone C1 piecewise cubic (Fritsch &
// Carlson 1980) through the events that both have; unit speed before the first and after the last.
#pragma once
#include <string>
#include <vector>

#include "core/curve.h"
#include "core/error.h"
#include "frame/history.h"
#include "overlay/marks.h"
#include "scoring/metrics.h"
#include "study/study.h"

namespace swallowclip::overlay {

struct EventPair {
  std::string name;
  double study_s = 0, model_s = 0;
  double correction_s = 0;  ///< by how much later a moved motion is asked for it; not for the warp
};

constexpr double kSameTime_s = 1e-6;  ///< study times are decimal fractions of a second

/// Events marked in the study and measured in the model, by study time.
std::vector<EventPair> pairEvents(const Marks& marks, const study::StudyInfo& study,
                                  const scoring::Metrics& metrics);

class TimeWarp {
 public:
  /// Pairs at one study time (within kSameTime_s) share a knot at their mean model time, as long as
  /// each stays within half of `frame_s`. Refused: no pair, pairs whose order differs, pairs that
  /// can't share a knot.
  static Result<TimeWarp> make(std::vector<EventPair> pairs, double frame_s);
  /// model = study - shift
  static TimeWarp shift(double shift_s);

  double model_s(double study_s) const { return curve_(study_s); }
  /// The inverse; where the model stands still, the middle of that span.
  double study_s(double model_s) const;

 private:
  Curve curve_;
};

/// Every frame of the model at the study's times: structures, skin and particles between their two
/// neighbouring frames (rigid ones by slerp), which is smooth at any playing speed.
frame::History retimed(const frame::History& model, const TimeWarp& warp,
                       const std::vector<double>& study_s, double fps);
}  // namespace swallowclip::overlay
