// SPDX-License-Identifier: MIT
// One product of the plan: what makes it, and the recipe whose hash is its key. Products of the
// same key are the same bytes, so nothing is ever made twice.
#pragma once
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "library/spec.h"

namespace swallowclip::library {

enum class Stage { bake, simulate, measure, draw, verify };
inline constexpr std::array kStages{Stage::bake, Stage::simulate, Stage::measure, Stage::draw,
                                    Stage::verify};
const char* name(Stage stage);
std::optional<Stage> stageFromName(const std::string& word);

/// Everything a job is told; which fields matter depends on the stage.
struct Choice {
  std::filesystem::path data;  ///< folder with scenes/, render_presets/ and shaders/
  std::string scene, solver;
  double spacing_mm = 2, fps = 30;
  int component = 0, score = 0;
  std::filesystem::path swallow;
  std::string bolus = "none";
  std::string preset, view;
  SheetDef sheet;

  pipeline::RunOptions options() const;
  std::string stem() const;  ///< "c04-s3-honey"
};

struct RecipeLine {
  std::string what, value;
  bool operator==(const RecipeLine&) const = default;
};
using Recipe = std::vector<RecipeLine>;

struct Job {
  Stage stage = Stage::bake;
  std::string name;  ///< for people: "draw small/c04-s3-honey-oblique"
  Choice choice;
  std::vector<std::string> needs;  ///< keys, in the order bake, simulate, measure, draw
  Recipe recipe;
  std::string key;  ///< 32 hexadecimal digits
};

/// Reads and hashes input files, each once.
class Inputs {
 public:
  /// Digest of a file's meaning (scene::canonicalJson) or, for other files, of its bytes.
  Result<std::string> digest(const std::filesystem::path& file, const std::string& list = "",
                             const std::string& member = "");

 private:
  std::map<std::string, std::string> known_;
};

/// Fills recipe and key from stage, choice and needs, with the files as they are now.
Result<void> cook(Job& job, Inputs& inputs);

/// The job as a file for `swallowclip job KEY`, and back.
std::string jobText(const Job& job);
Result<Job> readJob(const std::filesystem::path& file);
}  // namespace swallowclip::library
