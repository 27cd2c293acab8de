// SPDX-License-Identifier: MIT
#include "library/nightly.h"

#include <fmt/chrono.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <ctime>

#include "core/file.h"
#include "library/engine.h"
#include "library/process.h"
#include "library/publish.h"
#include "library/report.h"
#include "library/summary.h"
#include "pipeline/interrupt.h"

namespace swallowclip::library {
namespace fs = std::filesystem;
namespace {
using Clock = std::chrono::steady_clock;

double since_s(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}
double now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Of this process and of all that it has waited for.
double processorTime_s() {
  double sum = 0;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage u{};
    ::getrusage(who, &u);
    for (const timeval& t : {u.ru_utime, u.ru_stime})
      sum += static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  }
  return sum;
}

struct Evening {
  const pipeline::RunOptions& options;
  pipeline::Progress& progress;
  Root root;
  SpecDef spec;
  Stamps stamps;
  Memory memory;
  Plan plan;

  Result<void> prepare(bool repair) {
    auto made = makePlan(spec, options);
    if (!made) return std::unexpected(made.error());
    plan = std::move(*made);
    Store store(root, stamps);
    if (repair) {  // a full disk may be full of leftovers
      pruneNights(root, spec.publish);
      store.prune(wanted(), spec.publish.keep_gb);
    }
    lookUp(plan, store, memory, repair);
    return {};
  }

  std::vector<std::string> wanted() const {
    std::vector<std::string> keys;
    for (const PlannedJob& p : plan.jobs) keys.push_back(p.job.key);
    return keys;
  }

  /// Products again, after the engine.
  void lookAgain() {
    Store store(root, stamps);
    for (PlannedJob& p : plan.jobs)
      if (p.stale()) {
        auto state = store.check(p.job.key, false);
        p.marker = std::move(state.marker);
      }
  }

  Result<void> runLocal() {
    if (auto ready = writeJobFiles(plan, root); !ready) return ready;
    return runNinja(plan, root, options.jobs, progress);
  }

  Result<void> finish(const Tonight& tonight, double wall_s);
  Result<void> runSlurm(std::optional<Lock> lock);
};

/// The end of a night, whoever ran the jobs: publish or keep, prune, report, remember.
Result<void> Evening::finish(const Tonight& tonight, double wall_s) {
  lookAgain();
  Summary s;
  s.when = fmt::format("{:%Y-%m-%d %H:%M}", fmt::gmtime(std::time(nullptr)));
  s.jobs = static_cast<int>(plan.jobs.size());
  s.run = static_cast<int>(tonight.jobs.size());
  s.failed = plan.staleCount();
  s.wall_s = wall_s;
  s.processors = options.library.publish ? 0 : options.jobs;
  for (const PlannedJob& p : plan.jobs)
    if (p.marker && tonight.has(p.job.key)) s.cpu_s[name(p.job.stage)] += p.marker->cpu_s;
  Night night = gatherNight(plan, root);
  s.missing = static_cast<int>(night.missing.size());
  const std::optional<Night> last = publishedNight(root);
  const std::vector<Change> changes = changesSince(last, night, plan, root);
  const bool allowed = s.missing <= spec.publish.missingClipsAllowed && !night.clips.empty();
  if (!allowed) {
    s.problem = fmt::format("{} of {} clips missing, {} allowed", s.missing, plan.clips.size(),
                            spec.publish.missingClipsAllowed);
  } else if (last && last->content() == night.content() && nightHolds(root, *last, stamps)) {
    s.outcome = Outcome::unchanged;
  } else if (auto done = publishNight(night, last, plan, root, stamps); !done) {
    s.problem = done.error().text();
  } else {
    s.outcome = Outcome::published;
  }
  const std::optional<Night> shown = publishedNight(root);
  s.night = shown ? shown->name : "";
  s.clips = shown ? static_cast<int>(shown->clips.size()) : 0;
  pruneNights(root, spec.publish);
  Store(root, stamps).prune(wanted(), spec.publish.keep_gb);
  memory.keep(plan);
  s.overhead_s = std::max(0.0, processorTime_s() - s.cpuSum_s());
  // From here on the night is what it is; what can't be written now is told, and no more.
  for (const auto& done :
       {appendNight(s, root), writeReport({s, plan, night, shown, changes, tonight}, root),
        memory.save(), (stamps.refresh(), stamps.save()),
        writeFile(root.run() / "summary.json", summaryJson(s, root))})
    if (!done) progress.note(done.error().text());
  progress.print(summaryJson(s, root));
  if (s.outcome != Outcome::kept) return {};
  return failure(root.path.string(), s.problem,
                 fmt::format("The last night stays published. See {}",
                             (root.report() / "index.html").string()));
}

Result<void> Evening::runSlurm(std::optional<Lock> lock) {
  if (auto ready = writeJobFiles(plan, root); !ready) return ready;
  std::error_code ec;
  fs::remove(root.run() / "summary.json", ec);
  const std::string finish = fmt::format(
      "{} nightly --publish --spec {} --out {} --jobs {}", shellQuoted(ownProgram()),
      shellQuoted(fs::absolute(spec.file).string()), shellQuoted(root.path.string()), options.jobs);
  const std::string data = "SWALLOWCLIP_DATA=" + shellQuoted(fs::absolute(options.data).string());
  auto id = submitSlurm(plan, root, "env " + data + " " + finish);
  if (!id) return std::unexpected(id.error());
  lock.reset();  // the last job takes it; until then Slurm's queue is what keeps others out
  progress.note(fmt::format("Slurm job {} will end the night", *id));
  if (auto waited = waitForSlurm(*id, plan, root, progress); !waited) return waited;
  auto text = readFile(root.run() / "summary.json");
  if (!text)
    return failure(root.path.string(), "the last Slurm job left no summary",
                   fmt::format("See {}", (root.run() / "slurm-finish.log").string()));
  progress.print(*text);
  if (text->find("\"outcome\": \"kept\"") == std::string::npos) return {};
  return failure(root.path.string(), "not published",
                 fmt::format("See {}", (root.report() / "index.html").string()));
}
}  // namespace

Result<void> nightly(const pipeline::RunOptions& options, pipeline::Progress& progress) {
  const pipeline::LibraryOptions& asked = options.library;
  const fs::path file = asked.spec.empty() ? options.scenesFolder() / "nightly.json" : asked.spec;
  auto spec = loadSpec(file, options);
  if (!spec) return std::unexpected(spec.error());
  auto root = openRoot(asked.out, !asked.plan);
  if (!root) return std::unexpected(root.error());
  const bool slurm = asked.engine == "slurm";
  for (const auto& [program, package] :
       {std::pair{slurm ? "sbatch" : "ninja", slurm ? "slurm-wlm munge" : "ninja-build"}})
    if (auto found = findProgram(program, package); !found && !asked.plan && !asked.publish)
      return found;
  std::optional<Lock> lock;
  if (!asked.plan) {
    auto taken = Lock::take(*root, asked.publish);
    if (!taken) return std::unexpected(taken.error());
    lock.emplace(std::move(*taken));
  }
  if (slurm && !asked.plan && !asked.publish)
    if (auto idle = checkSlurmIdle(*root); !idle) return idle;
  Evening evening{options,
                  progress,
                  *root,
                  *spec,
                  Stamps(root->run() / "stamps.tsv"),
                  Memory(root->run() / "memory.tsv"),
                  {}};
  progress.stage("planning");
  if (auto ready = evening.prepare(!asked.plan && !asked.publish); !ready) return ready;
  if (asked.plan) {
    progress.print(planText(evening.plan));
    return {};
  }
  if (asked.publish) {
    const Tonight tonight = loadTonight(*root);
    return evening.finish(tonight,
                          tonight.started_s > 0 ? std::max(0.0, now_s() - tonight.started_s) : 0);
  }
  Tonight tonight;
  tonight.started_s = now_s();
  for (const PlannedJob& p : evening.plan.jobs)
    if (p.stale()) tonight.jobs.emplace_back(p.job.key, p.job.name + ": " + p.why);
  if (auto saved = saveTonight(tonight, *root); !saved) return saved;
  if (slurm) return evening.runSlurm(std::move(lock));
  const auto start = Clock::now();
  if (!tonight.jobs.empty())
    if (auto ran = evening.runLocal(); !ran) return ran;
  return evening.finish(tonight, since_s(start));
}
}  // namespace swallowclip::library
