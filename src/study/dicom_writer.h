// SPDX-License-Identifier: MIT
// A derived multi-frame Secondary Capture object (PS3.3 A.8.4 and A.8.5) built from nothing but
// pictures: no attribute comes from any other file. UIDs are new, made from the pixels' digest
// (2.25 and a name-based UUID, PS3.5 B.2), so that the same pictures give the same bytes.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "video/frame_sink.h"

namespace swallowclip::study {

enum class DicomCoding { uncompressed, jpegBaseline, jpeg2000, rle };

struct DicomDef {
  std::filesystem::path path;
  int width = 0, height = 0;
  bool colour = true;  ///< false: grey, the red channel taken
  DicomCoding coding = DicomCoding::jpegBaseline;
  double frameTime_ms = 1000.0 / 30;         ///< Frame Time, unless `frameTimes_ms` is given
  std::vector<double> frameTimes_ms{};       ///< Frame Time Vector: steps, the first one 0
  std::string series = "Synthetic swallow";  ///< Series Description
  std::string derivation = "Synthetic: simulated swallow, drawn for training. Not for diagnosis.";
};

/// Frames go in one by one; the file appears at finish().
Result<std::unique_ptr<video::FrameSink>> makeDicomSink(const DicomDef& def);
}  // namespace swallowclip::study
