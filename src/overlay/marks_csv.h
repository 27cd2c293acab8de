// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "overlay/marks.h"

namespace swallowclip::overlay {

/// A table as spreadsheets save it: columns kind, name, frame, x_px, y_px (any order, further ones
/// ignored), separated by comma, semicolon (then decimal commas may stand) or tab; quoted cells,
/// CRLF, byte order mark and empty rows are fine. kind is event, landmark or calibration (two rows,
/// `name` then holds the length in mm).
Result<Marks> readCsv(const std::string& text);
}  // namespace swallowclip::overlay
