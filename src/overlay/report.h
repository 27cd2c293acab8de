// SPDX-License-Identifier: MIT
// What a clip's side file says: how well times and places agree. No text of the study in it.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "overlay/demo.h"
#include "overlay/film.h"
#include "overlay/registration.h"
#include "overlay/retime.h"
#include "scoring/metrics.h"

namespace swallowclip::overlay {

/// One event in the study, in the model, and in the model as retimed.
struct EventRow {
  std::string name;
  double study_s = 0;
  std::optional<double> model_s;    ///< measured in the model's own time
  std::optional<double> retimed_s;  ///< study time at which the retimed model shows that moment
};

/// `warp` is what the clip was made with.
std::vector<EventRow> eventRows(const Marks& marks, const study::StudyInfo& study,
                                const scoring::Metrics& model, const TimeWarp& warp);

/// Registration against the truth of a demonstration, over the study's frames.
struct TruthReport {
  double rms_px = 0;         ///< over the fixed landmarks' true places
  double scale_percent = 0;  ///< relative error
  double angle_deg = 0;      ///< largest error
  double turned_deg = 0;     ///< rotation found from the first to the last frame
};
TruthReport compare(const Registration& found, const DemoTruth& truth, const frame::History& model,
                    const Clock& clock);

std::string sideText(const study::StudyInfo& study, const Clock& clock,
                     const std::vector<EventRow>& rows, const Registration& registration,
                     const frame::Meta& model, bool resimulated,
                     const std::optional<TruthReport>& truth);

/// The same as lines for a person.
std::vector<std::string> noteLines(const std::vector<EventRow>& rows,
                                   const Registration& registration, double frame_s,
                                   const std::optional<TruthReport>& truth);
}  // namespace swallowclip::overlay
