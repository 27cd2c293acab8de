// SPDX-License-Identifier: MIT
// A patient's videofluoroscopy as pictures with their own times: a video file (libav) or a DICOM
// multi-frame object (GDCM). No text of the file leaves this room: messages say "study", never a
// path, a name or a tag's value that could name a patient.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/image.h"

namespace swallowclip::study {

/// Stands in messages where a path would stand: paths of studies often name the patient.
inline constexpr const char* kPlace = "study";

/// Lowest pulse rate at which MBSImP scores are reliable (Bonilha 2013), pulses/s.
inline constexpr double kReliableRate_hz = 30;

/// What the file says about patient text burned into its pixels (DICOM 0028,0301).
enum class BurnedIn { no, yes, unknown };

struct StudyInfo {
  int width = 0, height = 0;   ///< square pixels, upright
  std::vector<double> time_s;  ///< [frame], the first one 0, increasing
  std::string kind;            ///< "video" or "DICOM XA", "DICOM RF" ...
  std::string timing;          ///< where the frame times come from
  BurnedIn burnedIn = BurnedIn::unknown;
  std::vector<std::string> warnings;  ///< to be shown to whoever works with it

  int frames() const { return static_cast<int>(time_s.size()); }
  /// Median frames/s; 0 for a single frame.
  double rate_hz() const;
  /// How long the last frame is shown: as long as the median one.
  double end_s() const;
  /// Frame on show at a time: the last one that has begun (0 before the first).
  int frameAt(double t_s) const;
};

struct StudyDef {
  std::filesystem::path path;
  double frameRate_hz = 0;  ///< given by the user for files that hold no times; 0: none
};

/// Where frames come from. frame(k) with growing k is cheap for all kinds.
class Study {
 public:
  /// Reads the whole file once: every frame is known to be decodable, times are final.
  static Result<std::unique_ptr<Study>> open(const StudyDef& def);
  virtual ~Study() = default;
  const StudyInfo& info() const { return info_; }
  virtual Result<Image> frame(int k) = 0;

 protected:
  StudyInfo info_;
};

/// The message for all that is wrong with a study file.
std::unexpected<Error> refuse(std::string problem, std::string remedy);
}  // namespace swallowclip::study
