// SPDX-License-Identifier: MIT
// The job graph of a spec: bake -> simulate (once per swallow and bolus) -> measure -> draw (per
// view and preset) -> verify; what of it is stale, why, and what it is expected to cost.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "library/job.h"
#include "library/store.h"

namespace swallowclip::library {

struct PlannedJob {
  Job job;
  std::vector<int> needs;        ///< indices into Plan::jobs, all smaller
  std::optional<Marker> marker;  ///< of the finished product; empty: stale
  std::string why;               ///< it is stale
  double cost_s = 0;             ///< last measured processor time, else a guess by its stage
  double path_s = 0;             ///< cost from its start to the end of the night, at least

  bool stale() const { return !marker; }
};

struct PlannedClip {
  std::string name;           ///< "small/c04/c04-s3-honey-oblique"
  std::array<int, 5> jobs{};  ///< by stage, indices into Plan::jobs
};

struct Plan {
  SpecDef spec;
  std::vector<PlannedJob> jobs;  ///< every one after what it needs
  std::vector<PlannedClip> clips;

  int staleCount() const;
  /// Stale jobs, those with the longest way to go first; never before what they need.
  std::vector<int> order() const;
};

/// Recipes and costs of the last night, by job name; a file in the library's run folder.
class Memory {
 public:
  explicit Memory(std::filesystem::path file);
  /// Which inputs of the job differ from last time, "" when it is new or nothing does.
  std::string changes(const Job& job) const;
  double cost_s(const Job& job) const;
  void keep(const Plan& plan);
  Result<void> save() const;

 private:
  struct Entry {
    std::map<std::string, std::string> recipe;  ///< what -> short digest of its value
    double cost_s = 0;
  };
  static std::map<std::string, std::string> digested(const Job& job);
  std::filesystem::path file_;
  std::map<std::string, Entry> entries_;
};

Result<Plan> makePlan(const SpecDef& spec, const pipeline::RunOptions& options);

/// Looks up every product; damaged ones are taken out of the store when `repair`.
void lookUp(Plan& plan, Store& store, const Memory& memory, bool repair);

/// Cells of a file with tabs between them; nothing of a file that can't be read.
std::vector<std::vector<std::string>> readTable(const std::filesystem::path& file);

/// The graph as text, one line per job with its state.
std::string planText(const Plan& plan);
}  // namespace swallowclip::library
