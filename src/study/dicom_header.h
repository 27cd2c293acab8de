// SPDX-License-Identifier: MIT
// The few attributes of a DICOM object that a moving picture needs. Names as in PS3.3. Private to
// this room; never handed out as text, since any attribute may hold what it should not.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "study/dicom_elements.h"

namespace swallowclip::study {

struct DicomHeader {
  int rows = 0, columns = 0, frames = 1, samples = 1;
  int bitsAllocated = 8, bitsStored = 8, planarConfiguration = 0;
  bool isSigned = false;
  std::string photometric;          ///< MONOCHROME1, MONOCHROME2, RGB, YBR_FULL, YBR_FULL_422, ...
  double slope = 1, intercept = 0;  ///< modality rescale
  std::optional<double> windowCentre, windowWidth;  ///< VOI, PS3.3 C.11.2
  double pixelAspect = 1;                           ///< height of a pixel over its width
  std::string kind;                                 ///< "DICOM XA" ...
  BurnedIn burnedIn = BurnedIn::unknown;
  std::vector<double> time_s;
  std::string timing;
  std::vector<std::string> warnings;

  /// Values of one pixel picture: rows x columns x samples.
  std::size_t frameValues() const { return static_cast<std::size_t>(rows) * columns * samples; }
};

/// Refuses what is no moving picture, and times that would have to be guessed.
Result<DicomHeader> readHeader(const DataSet& set, double frameRate_hz);
}  // namespace swallowclip::study
