// SPDX-License-Identifier: MIT
// What one night did, as one line of JSON for cron and as one line of a table for the trends.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "library/plan.h"

namespace swallowclip::library {

/// What was stale when the night began; kept in run/tonight.tsv, since with Slurm another process
/// ends the night.
struct Tonight {
  std::vector<std::pair<std::string, std::string>> jobs;  ///< key, why
  double started_s = 0;                                   ///< system clock
  bool has(const std::string& key) const;
};
Result<void> saveTonight(const Tonight& tonight, const Root& root);
Tonight loadTonight(const Root& root);

enum class Outcome {
  published,  ///< a new night is shown
  unchanged,  ///< the one shown is still right
  kept,       ///< not good enough: the last one stays
};

struct Summary {
  Outcome outcome = Outcome::kept;
  std::string when;                     ///< "2026-11-23 19:30" UTC, from the system clock
  std::string night;                    ///< the one shown now; "" when there is none
  int clips = 0;                        ///< shown now
  int missing = 0;                      ///< of the plan's clips, left out or in the way
  int jobs = 0, run = 0, failed = 0;    ///< in the plan; stale at the start; still stale
  double wall_s = 0;                    ///< of the engine
  int processors = 0;                   ///< that the engine was given; 0: not known
  double overhead_s = 0;                ///< processor time that went into no product
  std::map<std::string, double> cpu_s;  ///< of this night's products, by stage
  std::string problem;                  ///< why it was kept

  double cpuSum_s() const;
  /// Share of the processors' time that went into products; nothing when no job ran.
  std::optional<double> efficiency() const;
};

std::string summaryJson(const Summary& summary, const Root& root);

/// run/nights.tsv: one line per night, oldest first. Lines that can't be read are left out.
std::vector<Summary> loadNights(const Root& root);
Result<void> appendNight(const Summary& summary, const Root& root);
}  // namespace swallowclip::library
