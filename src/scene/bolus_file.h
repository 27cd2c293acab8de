// SPDX-License-Identifier: MIT
// Boluses by name: scenes/boluses.json holds {"boluses": {"NAME": {...}}}; a file of one's own
// holds one such object with a "name" beside its numbers.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "bolus/fluid.h"
#include "core/error.h"
#include "scene/json_reader.h"

namespace swallowclip::scene {

/// Surface of a fluid for which nothing else is given.
struct Surface {
  double tension_Nm = 0;  ///< 0: none
  double contactAngle_rad = bolus::Fluid{}.contactAngle_rad;
};

/// Density, rheology, surface and coating out of any object that holds their keys; other keys are
/// left alone.
bolus::Fluid readFluid(const JsonNode& node, const Surface& usual = {});

struct BolusDef {
  std::string name;         ///< as in file names: lower-case letters, digits, '-'
  std::string description;  ///< for captions and lists
  bolus::Fluid fluid;
  double bariumSulfate_kgm3 = 0;  ///< contrast, seen by fluoroscopy only; 400 = 40 % w/v
};

/// All boluses of scenes/boluses.json, in file order.
Result<std::vector<BolusDef>> loadBoluses(const std::filesystem::path& scenesFolder);

/// A name from scenes/boluses.json, or (if it ends in ".json") the path of a bolus file.
Result<BolusDef> loadBolus(const std::filesystem::path& scenesFolder,
                           const std::string& nameOrFile);

/// By path, whatever the files are called.
Result<std::vector<BolusDef>> loadBolusList(const std::filesystem::path& path);
Result<BolusDef> loadBolusFile(const std::filesystem::path& path);
}  // namespace swallowclip::scene
