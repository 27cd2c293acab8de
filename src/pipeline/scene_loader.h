// SPDX-License-Identifier: MIT
// A scene folder made ready: bones and cartilages (parametric or imported), lumen and soft parts.
#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/soft_parts.h"
#include "core/error.h"
#include "pipeline/run_options.h"

namespace swallowclip::pipeline {

struct LoadedScene {
  anatomy::Anatomy rigid;
  std::unique_ptr<anatomy::Lumen> lumen;  ///< kept at one address: soft parts refer to it
  std::unique_ptr<anatomy::SoftParts> soft;
  std::vector<std::filesystem::path> files;  ///< what was read, for the inputs' hash
  std::vector<std::string> notes;
};

/// An imported scene replaces the bones; its lumen and soft parts are those of scenes/adult.
Result<LoadedScene> loadScene(const RunOptions& options);
}  // namespace swallowclip::pipeline
