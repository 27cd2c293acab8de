// SPDX-License-Identifier: MIT
#include "library/summary.h"

#include <algorithm>
#include <fstream>
#include <sstream>

#include "core/file.h"
#include "scene/json_text.h"

namespace swallowclip::library {
namespace {
constexpr std::size_t kMostNights = 1000;  // lines kept for the trends: almost three years
constexpr const char* kOutcomes[] = {"published", "unchanged", "kept"};

template <class T>
T number(const std::string& cell) {
  T value{};
  std::istringstream(cell) >> value;
  return value;
}
}  // namespace

std::vector<std::vector<std::string>> readTable(const std::filesystem::path& file) {
  std::vector<std::vector<std::string>> rows;
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream in(line);
    auto& row = rows.emplace_back();
    for (std::string cell; std::getline(in, cell, '\t');) row.push_back(cell);
  }
  return rows;
}

Result<void> saveTonight(const Tonight& tonight, const Root& root) {
  std::string text = fmt::format("{:.3f}\n", tonight.started_s);
  for (const auto& [key, why] : tonight.jobs) text += key + "\t" + why + "\n";
  return writeFile(root.run() / "tonight.tsv", text);
}

Tonight loadTonight(const Root& root) {
  Tonight tonight;
  for (const auto& c : readTable(root.run() / "tonight.tsv"))
    if (c.size() == 2)
      tonight.jobs.emplace_back(c[0], c[1]);
    else if (c.size() == 1)
      tonight.started_s = number<double>(c[0]);
  return tonight;
}

bool Tonight::has(const std::string& key) const {
  return std::ranges::any_of(jobs, [&](const auto& job) { return job.first == key; });
}

double Summary::cpuSum_s() const {
  double sum = 0;
  for (const auto& [stage, s] : cpu_s) sum += s;
  return sum;
}

std::optional<double> Summary::efficiency() const {
  if (run == failed || wall_s <= 0 || processors < 1) return std::nullopt;
  return cpuSum_s() / (processors * wall_s);
}

std::string summaryJson(const Summary& s, const Root& root) {
  std::string stages;
  for (const auto& [stage, cpu_s] : s.cpu_s)
    stages += fmt::format("{}\"{}\": {:.1f}", stages.empty() ? "" : ", ", stage, cpu_s);
  const auto efficiency = s.efficiency();
  return fmt::format(
      "{{\"outcome\": \"{}\", \"night\": {}, \"clips\": {}, \"missing\": {}, \"jobs\": {}, "
      "\"run\": {}, \"failed\": {}, \"wall_s\": {:.1f}, \"cpu_s\": {{{}}}, \"overhead_s\": {:.2f}, "
      "\"efficiency\": {}, \"problem\": {}, \"report\": {}}}\n",
      kOutcomes[static_cast<int>(s.outcome)], s.night.empty() ? "null" : scene::quotedJson(s.night),
      s.clips, s.missing, s.jobs, s.run, s.failed, s.wall_s, stages, s.overhead_s,
      efficiency ? fmt::format("{:.3f}", *efficiency) : "null",
      s.problem.empty() ? "null" : scene::quotedJson(s.problem),
      scene::quotedJson((root.report() / "index.html").string()));
}

std::vector<Summary> loadNights(const Root& root) {
  std::vector<Summary> nights;
  for (const auto& c : readTable(root.run() / "nights.tsv")) {
    if (c.size() < 10) continue;
    Summary s;
    s.when = c[0];
    for (int k = 0; k < 3; ++k)
      if (c[1] == kOutcomes[k]) s.outcome = static_cast<Outcome>(k);
    s.night = c[2];
    s.clips = number<int>(c[3]);
    s.missing = number<int>(c[4]);
    s.jobs = number<int>(c[5]);
    s.run = number<int>(c[6]);
    s.failed = number<int>(c[7]);
    s.wall_s = number<double>(c[8]);
    s.processors = number<int>(c[9]);
    for (std::size_t k = 10; k + 1 < c.size(); k += 2) s.cpu_s[c[k]] = number<double>(c[k + 1]);
    nights.push_back(std::move(s));
  }
  return nights;
}

Result<void> appendNight(const Summary& summary, const Root& root) {
  std::vector<Summary> nights = loadNights(root);
  nights.push_back(summary);
  if (nights.size() > kMostNights) nights.erase(nights.begin(), nights.end() - kMostNights);
  std::string text;
  for (const Summary& s : nights) {
    text += fmt::format("{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\t{:.1f}\t{}", s.when,
                        kOutcomes[static_cast<int>(s.outcome)], s.night, s.clips, s.missing, s.jobs,
                        s.run, s.failed, s.wall_s, s.processors);
    for (const auto& [stage, cpu_s] : s.cpu_s) text += fmt::format("\t{}\t{:.1f}", stage, cpu_s);
    text += "\n";
  }
  return writeFile(root.run() / "nights.tsv", text);
}
}  // namespace swallowclip::library
