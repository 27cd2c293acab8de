// SPDX-License-Identifier: MIT
// What a person asked for, checked for form by the cli room. Every field has the default of an
// option left out; which fields matter depends on the command (src/cli/option_table.cpp).
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace swallowclip::pipeline {

/// --set track.key=value: one number of the swallow file replaced.
struct TrackSetting {
  std::string track, key;
  double value = 0;
};

/// --set track.key=from:to:step of `sweep`.
struct TrackRange {
  std::string track, key;
  double from = 0, to = 0, step = 0;  ///< all of them, from and to included

  std::vector<double> values() const;
};

/// `verify` has its own defaults: what is left out stays as the case file says.
struct VerifyOptions {
  std::string subset = "all";  ///< or short; only without files
  std::string solver;          ///< empty: of the case
  double spacing_mm = 0;       ///< 0: of the case
  bool bench = false;          ///< time the solver instead
  std::filesystem::path out = "output/verify";
};

/// `events` and `overlay`: a study beside the model.
struct OverlayOptions {
  std::filesystem::path vf;      ///< video or DICOM
  std::filesystem::path events;  ///< marked events and landmarks, JSON or CSV
  std::filesystem::path out;     ///< clip to write; empty: output/overlay/demo.mp4
  std::vector<std::string> views{"oblique"};
  std::string layout = "side-by-side";    ///< side-by-side, superimposed, both
  std::string style = "outlines";         ///< outlines, translucent
  std::vector<std::array<int, 4>> masks;  ///< x, y, width, height in pixels of the study
  double frameRate_hz = 0;                ///< 0: from the file
  bool demo = false, resimulate = false, dicom = false;
  bool noBurnedInText = false, keepBorder = false;
};

/// `nightly` and `job`.
struct LibraryOptions {
  std::filesystem::path spec;    ///< empty: scenes/nightly.json
  std::string engine = "local";  ///< or slurm
  bool plan = false;             ///< show what would be done
  bool publish = false;          ///< run no job, publish what is there
  std::string key;               ///< job
  std::filesystem::path out = "output/library";
};

struct RunOptions {
  int component = 0;                   ///< 1..17; 0: none, the swallow file stands alone
  std::vector<int> scores;             ///< intended scores, ascending; empty: none
  std::string bolus = "thesis-honey";  ///< name, .json file, or "none"
  std::vector<std::string> views{"oblique", "ap", "si"};
  std::string scene = "adult";    ///< folder in scenes/, or a path
  std::filesystem::path swallow;  ///< empty: the file of component and score
  std::vector<TrackSetting> sets;
  std::optional<TrackRange> range;  ///< sweep
  std::filesystem::path compare;    ///< history of the unchanged swallow, for --set
  std::string preset = "training";  ///< name in render_presets/, or a .json file
  double volume_mL = 5;             ///< of the bolus, 1 to 20
  double spacing_mm = 2;            ///< particle spacing; 2 mm = 621 particles in 5 mL
  std::string solver = "dfsph";     ///< dfsph or wcsph
  std::filesystem::path out = "output";
  int jobs = 1;  ///< threads or clips at a time, >= 1; default: all processors

  std::filesystem::path checkpoint;  ///< simulate: kept while it runs, gone on from when it exists
  std::filesystem::path history;     ///< run.h5: written by simulate, read by measure, draw, export
  std::string format = "csv";        ///< export: csv, obj or vtp
  std::filesystem::path plot;        ///< measure: a page of charts, .svg or .png
  bool json = false;                 ///< measure: JSON instead of a table
  std::filesystem::path input;       ///< import: folder or file of meshes
  std::filesystem::path map;         ///< import: mapping file
  std::string topic;                 ///< list: components, scores, views, presets, boluses, scenes
  std::vector<std::filesystem::path> files;  ///< check, verify
  bool bench = false;                        ///< draw: time the frames instead
  VerifyOptions verify;
  OverlayOptions overlay;
  LibraryOptions library;

  /// Folder that holds scenes/, render_presets/ and shaders/.
  std::filesystem::path data;
  /// The command line as typed, for side files and for replaying a failure.
  std::string commandLine;

  bool hasBolus() const { return bolus != "none"; }
  std::filesystem::path scenesFolder() const { return data / "scenes"; }
  std::filesystem::path presetsFolder() const { return data / "render_presets"; }
  /// --scene as a folder: a name in scenes/, else a path.
  std::filesystem::path sceneFolder() const {
    std::error_code ec;
    const std::filesystem::path named = scenesFolder() / scene;
    const bool isPath = scene.find('/') != std::string::npos ||
                        (!std::filesystem::exists(named, ec) && std::filesystem::exists(scene, ec));
    return isPath ? std::filesystem::path(scene) : named;
  }
};
}  // namespace swallowclip::pipeline
