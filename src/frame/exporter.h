// SPDX-License-Identifier: MIT
// A history for other people's programs. Files are named and laid out so that no code of ours is
// needed to read them:
//   csv  particles.csv (frame,time_s,id,x_mm,y_mm,z_mm,region), landmarks.csv
//        (frame,time_s,name,x_mm,y_mm,z_mm), both RFC 4180 with a header line
//   vtp  swallow.pvd (open this in ParaView) and vtp/{structures,skin,bolus}_NNNN.vtp in metres.
//        structures: cell array `structure` (index into the field array `names`); skin: velocity,
//        s_m, u, wall per point, film_m per triangle; bolus: id, velocity, density, density_ratio,
//        state, region, s_m per point
//   obj  obj/NAME_NNNN.obj per structure and frame, and skin_NNNN.obj, in millimetres
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "frame/history.h"

namespace swallowclip::frame {

enum class ExportFormat { csv, vtp, obj };

/// "csv", "vtp", "obj"; anything else is a usage error naming the nearest.
Result<ExportFormat> exportFormat(const std::string& word);

/// Writes into `folder` (made when missing), each file whole or not at all. Returns the number of
/// files written.
Result<int> exportHistory(const History& history, ExportFormat format,
                          const std::filesystem::path& folder);

/// One frame of one part as VTK XML PolyData text (used by the exporter, see vtp.cpp).
std::string structuresVtp(const History& history, int frame);
std::string skinVtp(const History& history, int frame);
std::string bolusVtp(const History& history, int frame);
}  // namespace swallowclip::frame
