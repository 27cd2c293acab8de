// SPDX-License-Identifier: MIT
#include "verify/verify.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

#include "core/file.h"
#include "pipeline/interrupt.h"
#include "verify/bench.h"
#include "verify/report.h"
#include "verify/run_case.h"

namespace swallowclip::verify {
namespace {
namespace fs = std::filesystem;

/// The files named, or all that the program brings, by name.
Result<std::vector<fs::path>> caseFiles(const pipeline::RunOptions& options) {
  if (!options.files.empty()) return options.files;
  std::vector<fs::path> files;
  std::error_code error;
  const fs::path folder = options.scenesFolder() / "verify";
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::ranges::sort(files);
  if (files.empty())
    return usageError(folder.string(), "holds no case files",
                      "Name case files, or set SWALLOWCLIP_DATA to the program's own folder.");
  return files;
}

Result<std::vector<CaseDef>> loadCases(const pipeline::RunOptions& options) {
  auto files = caseFiles(options);
  if (!files) return std::unexpected(files.error());
  std::vector<CaseDef> cases;
  std::set<std::string> names;
  for (const fs::path& file : *files) {
    auto def = loadCase(file);
    if (!def) return std::unexpected(def.error());
    if (options.files.empty() && options.verify.subset == "short" && !def->isShort) continue;
    if (!options.verify.solver.empty())
      def->solver = bolus::solverFromName(options.verify.solver).value_or(def->solver);
    if (options.verify.spacing_mm > 0) {
      def->spacing_m = options.verify.spacing_mm * 1e-3;
      std::erase_if(def->refine_m, [&](double x) { return x <= def->spacing_m; });
      if (auto good = checkGeometry(*def); !good) {
        if (good.error().place.empty()) good.error().place = file.string();
        return std::unexpected(good.error());
      }
    }
    if (!names.insert(def->name).second)
      return usageError(file.string(), fmt::format("a second case is named \"{}\"", def->name),
                        "Rename it: results are filed by name.");
    cases.push_back(std::move(*def));
  }
  return cases;
}

std::string replay(const pipeline::RunOptions& options, const CaseDef& def) {
  std::string line = fmt::format("swallowclip verify '{}'", def.file.string());
  if (!options.verify.solver.empty()) line += " --solver " + options.verify.solver;
  if (options.verify.spacing_mm > 0)
    line += fmt::format(" --spacing-mm {}", options.verify.spacing_mm);
  return line;
}
}  // namespace

Result<void> verify(const pipeline::RunOptions& options, pipeline::Progress& progress) {
  if (options.verify.bench) return bench(options, progress);
  auto cases = loadCases(options);
  if (!cases) return std::unexpected(cases.error());
  const fs::path folder = options.verify.out;
  if (auto ok = prepareFolder(folder); !ok) return ok;
  const std::size_t n = cases->size();
  std::vector<std::optional<Result<CaseResult>>> done(n);
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::size_t printed = 0;
  progress.stage("verifying");
  progress.print(tableHead());
  const auto work = [&] {
    for (std::size_t k; (k = next++) < n && !pipeline::interrupted();) {
      Result<CaseResult> result = runCase((*cases)[k]);
      if (result && !result->failure.empty())
        result->failure += "\n  Replay: " + replay(options, (*cases)[k]);
      if (result)
        if (auto ok = writeCharts(*result, folder); !ok) result = std::unexpected(ok.error());
      const std::scoped_lock lock(mutex);
      done[k] = std::move(result);
      for (; printed < n && done[printed] && *done[printed]; ++printed)
        progress.print(tableRows(**done[printed]));
      progress.update(static_cast<double>(printed) / static_cast<double>(n));
    }
  };
  std::vector<std::thread> others;
  for (int k = 1; k < std::min<int>(options.jobs, static_cast<int>(n)); ++k)
    others.emplace_back(work);
  work();
  for (std::thread& thread : others) thread.join();
  if (pipeline::interrupted()) return std::unexpected(pipeline::interruptedError());
  std::vector<CaseResult> results;
  int failed = 0;
  for (auto& result : done) {
    if (!*result) return std::unexpected(result->error());
    failed += !(*result)->pass;
    results.push_back(std::move(**result));
  }
  if (auto ok = writeFile(folder / "verify.json", resultsJson(results)); !ok) return ok;
  progress.print(fmt::format("{} of {} cases passed; charts and verify.json in {}\n",
                             results.size() - failed, results.size(), folder.string()));
  if (failed == 0) return {};
  return failure("verify", fmt::format("{} of {} cases failed", failed, results.size()),
                 "The table marks them; each case file can be run alone.");
}
}  // namespace swallowclip::verify
