// SPDX-License-Identifier: MIT
// The clip itself: study frames and model frames on one clock, composed, encoded, with chapters, a
// poster and a side file beside it.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "frame/history.h"
#include "overlay/composer.h"
#include "overlay/marks.h"
#include "overlay/registration.h"
#include "overlay/retime.h"
#include "pipeline/progress.h"
#include "render/render_preset.h"
#include "study/protect.h"
#include "study/study.h"

namespace swallowclip::overlay {

/// Output frames/s as a fraction: the least whole multiple of an even study's rate that is at
/// least 30, so that every study frame is shown equally long; 60 for uneven ones.
struct Rate {
  int numerator = 30, denominator = 1;
  double hz() const { return static_cast<double>(numerator) / denominator; }
};
Rate outputRate(const study::StudyInfo& study);

/// One clock for all: frame k of the clip is at k / rate, from the study's first frame to its last.
struct Clock {
  Rate rate;
  std::vector<double> time_s;    ///< [clip frame]
  std::vector<int> studyFrame;   ///< [clip frame] the study frame on show
  std::vector<int> clipFrameOf;  ///< [study frame] the first clip frame that shows it
};
Clock makeClock(const study::StudyInfo& study);

struct FilmDef {
  std::filesystem::path path;  ///< STEM.mp4
  bool dicom = false;          ///< STEM.dcm as well
  std::string title, subtitle;
};

struct FilmTimes {
  double drawing_s = 0, encoding_s = 0;
};

/// `model` is retimed to the clock. Everything is written under the stem of `path`.
Result<FilmTimes> film(const FilmDef& def, study::Study& study, const study::Protector& protector,
                       const Marks& marks, const Clock& clock, const frame::History& model,
                       const Registration& registration, Composer& composer,
                       pipeline::Progress& progress);
}  // namespace swallowclip::overlay
