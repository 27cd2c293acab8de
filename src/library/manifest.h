// SPDX-License-Identifier: MIT
// What a night consists of: manifest.json in its folder, for people and programs, and SHA256SUMS
// for `sha256sum -c`.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "library/plan.h"

namespace swallowclip::library {

/// What was measured on the swallow of a clip, out of its measures.json.
struct Measured {
  bool labelConfirmed = false;
  std::string labelReason;
  std::map<std::string, std::string> scores;  ///< component -> score as JSON (number or null)
  std::map<std::string, double> quantities;   ///< those that have a value
};
Result<Measured> readMeasured(const std::filesystem::path& measuresJson);

/// A clip that is in a night.
struct NightClip {
  std::string name;               ///< "small/c04/c04-s3-honey-oblique"
  std::vector<StoredFile> files;  ///< clip, poster, chapters, measures, sheet, thumbnail; their
                                  ///< names are paths in the night's folder
  std::string key, historyKey;    ///< of the draw and the simulate product
  std::map<std::string, std::string> inputs;  ///< recipe of all stages, files by digest
  Measured measured;
};

/// A clip that should be in the night and isn't.
struct MissingClip {
  std::string name, why;
  std::string job;  ///< key of the job that failed; "" when a label kept it out
};

struct Night {
  std::string name;  ///< "n000012-20261123"
  bool draft = false;
  std::vector<NightClip> clips;
  std::vector<MissingClip> missing;

  /// Equal for nights with the same files and the same gaps.
  std::string content() const;
  /// Every file once, by path.
  std::map<std::string, StoredFile> files() const;
  const NightClip* find(const std::string& clip) const;
};

/// Night as the products stand now: which clips are whole and confirmed.
Night gatherNight(const Plan& plan, const Root& root);

std::string manifestText(const Night& night);
/// Names, files and inputs; of the measures only the verdict.
Result<Night> readManifest(const std::filesystem::path& file);
std::string sumsText(const Night& night);

/// "<clip>.mp4" and the like inside the night's folder.
std::string nightPath(const NightClip& clip, const std::string& kind);
}  // namespace swallowclip::library
