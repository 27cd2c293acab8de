// SPDX-License-Identifier: MIT
// What the library is to hold: scenes/nightly.json, or a file of that form.
//
//   {"scene": "adult", "solver": "dfsph", "spacing_mm": 2,
//    "boluses": ["thin", "honey"], "views": ["oblique", "ap", "si"], "presets": ["small"],
//    "sheet": {"columns": 4, "rows": 3, "width_px": 320},
//    "swallows": [{"component": 4, "scores": "all"},
//                 {"component": 13, "scores": [0, 2], "views": ["ap"]},
//                 {"component": 4, "scores": [1], "swallow": "mine.json", "boluses": ["nectar"]}],
//    "publish": {"labels": "confirmed", "missing_clips_allowed": 0, "keep_nights": 14,
//                "keep_gb": 50}}
//
// An entry of "swallows" may name boluses, views and presets of its own. Paths of swallow files are
// relative to the spec.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "pipeline/run_options.h"

namespace swallowclip::library {

/// A contact sheet of a finished clip: evenly spaced frames in a grid.
struct SheetDef {
  int columns = 4, rows = 3;
  int width_px = 320;  ///< of one frame
};

/// One score, shown by one swallow file.
struct SwallowEntry {
  int component = 0, score = 0;
  std::filesystem::path file;
  std::vector<std::string> boluses, views, presets;
};

/// When a night is good enough, and how many are kept.
struct PublishDef {
  bool labelsConfirmed = true;  ///< false: a draft, clips of unconfirmed label included
  int missingClipsAllowed = 0;  ///< a night with more failed clips is not published
  int keepNights = 14;          ///< newest ones; the published one always stays
  double keep_gb = 50;          ///< of old nights, and again of products no longer in the plan
};

struct SpecDef {
  std::filesystem::path file;
  std::string scene = "adult", solver = "dfsph";
  double spacing_mm = 2;
  SheetDef sheet;
  std::vector<SwallowEntry> swallows;
  PublishDef publish;
};

/// Reads and checks everything the spec names: scene, swallow files, boluses, presets, views. All
/// problems are told at once, each with its place.
Result<SpecDef> loadSpec(const std::filesystem::path& file, const pipeline::RunOptions& options);
}  // namespace swallowclip::library
