// SPDX-License-Identifier: MIT
// One compressed frame of a DICOM object. RLE is decompressed here; what goes to GDCM's codecs must
// first say the size that the header says, because they size their buffers by the latter.
// Private to this room.
#pragma once
#include <string>
#include <string_view>

#include "study/dicom_header.h"

namespace swallowclip::study {

/// PS3.5 annex G; samples in the order of the header's planar configuration, little-endian.
Result<std::string> decodeRle(std::string_view coded, const DicomHeader& header, int frame);

/// Size, samples and bits in the frame header of JPEG and JPEG-LS (ITU-T T.81 B.2.2, T.87 C.2.2).
Result<void> checkJpeg(std::string_view coded, const DicomHeader& header, int frame);
/// The same in the SIZ segment of JPEG 2000 (ITU-T T.800 A.5.1).
Result<void> checkJpeg2000(std::string_view coded, const DicomHeader& header, int frame);
}  // namespace swallowclip::study
