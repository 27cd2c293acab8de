// SPDX-License-Identifier: MIT
// What a DICOM multi-frame object says, and its frames as 8-bit pictures. Codecs of GDCM and libav
// are not trusted with a hostile file, so this runs in a process of its own (dicom_study.cpp).
// Private to this room.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "study/study.h"

namespace swallowclip::study {

class DicomDecoder {
 public:
  static Result<std::unique_ptr<DicomDecoder>> open(const StudyDef& def);
  ~DicomDecoder();
  const StudyInfo& info() const;
  /// VOI window and photometric interpretation applied.
  Result<Image> frame(int k);

 private:
  struct State;
  explicit DicomDecoder(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};
}  // namespace swallowclip::study
