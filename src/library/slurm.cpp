// SPDX-License-Identifier: MIT
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>

#include "core/digest.h"
#include "core/file.h"
#include "library/engine.h"
#include "library/process.h"
#include "pipeline/interrupt.h"

namespace swallowclip::library {
namespace {
constexpr std::size_t kMaxTasks = 1000;  // Slurm's default MaxArraySize is 1001
constexpr int kLook_s = 2;               // between looks at the queue; light for any controller

/// One name per library, by which its jobs are found again.
std::string jobName(const Root& root) {
  return "swallowclip-" + sha256Hex(root.path.string()).substr(0, 10);
}

/// Standard output of a Slurm command in one piece.
Result<std::string> ask(const std::vector<std::string>& words) {
  if (auto found = findProgram(words[0], "slurm-client (and slurm-wlm munge for a cluster)");
      !found)
    return std::unexpected(found.error());
  std::string all;
  auto code = runChild(words, [&](const std::string& line) { all += line + "\n"; });
  if (!code) return std::unexpected(code.error());
  if (*code != 0)
    return failure(words[0], fmt::format("ended with code {}: {}", *code, all),
                   "Is the cluster up? `sinfo` tells.");
  while (all.ends_with('\n')) all.pop_back();
  return all;
}

/// "123;cluster" or "123", after whatever warnings.
Result<std::string> submit(std::vector<std::string> words) {
  auto answer = ask(words);
  if (!answer) return answer;
  std::string id = answer->substr(answer->rfind('\n') + 1);
  id = id.substr(0, id.find(';'));
  if (id.empty() || id.find_first_not_of("0123456789") != std::string::npos)
    return failure("sbatch", "unexpected answer: " + *answer, "Submit the script by hand.");
  return id;
}

std::string arrayScript(const Root& root, const std::string& program) {
  // Task N takes line N of the list. Every key is a process of its own: one that crashes does not
  // take the others with it. What was done before a requeue is not done again.
  return fmt::format(
      "#!/bin/sh\nstatus=0\n"
      "for key in $(sed -n \"${{SLURM_ARRAY_TASK_ID}}p\" {0}/slurm-tasks.txt); do\n"
      "  {1} job \"$key\" --out {2} >{0}/logs/\"$key\".log 2>&1 || status=1\ndone\n"
      "exit $status\n",
      shellQuoted(root.run().string()), shellQuoted(program), shellQuoted(root.path.string()));
}
}  // namespace

std::vector<std::vector<std::string>> slurmTasks(const Plan& plan) {
  std::vector<int> place(plan.jobs.size());
  const std::vector<int> order = plan.order();
  for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = static_cast<int>(k);
  // Jobs of a clip belong together; clips of one history share a task (and a bake two of them).
  std::map<int, std::set<std::pair<int, int>>> tasks;  // simulate job -> (place, job)
  for (const PlannedClip& clip : plan.clips)
    for (const int k : clip.jobs)
      if (plan.jobs[k].stale()) tasks[clip.jobs[1]].insert({place[k], k});
  std::vector<std::pair<int, std::vector<std::string>>> sorted;
  for (const auto& [history, jobs] : tasks) {
    auto& task = sorted.emplace_back(jobs.begin()->first, std::vector<std::string>{}).second;
    for (const auto& [at, k] : jobs) task.push_back(plan.jobs[k].job.key);
  }
  std::ranges::sort(sorted);
  // Past Slurm's limit tasks are dealt out round and round.
  std::vector<std::vector<std::string>> lists(std::min(kMaxTasks, sorted.size()));
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    auto& list = lists[k % lists.size()];
    list.insert(list.end(), sorted[k].second.begin(), sorted[k].second.end());
  }
  return lists;
}

Result<void> checkSlurmIdle(const Root& root) {
  auto queue = ask({"squeue", "--noheader", "--format=%i %T", "--name=" + jobName(root)});
  if (!queue) return std::unexpected(queue.error());
  if (queue->empty()) return {};
  return failure(root.path.string(),
                 fmt::format("another night is in Slurm's queue (job {})",
                             queue->substr(0, queue->find('\n'))),
                 fmt::format("Wait for it, or end it: scancel --name={}", jobName(root)));
}

Result<std::string> submitSlurm(const Plan& plan, const Root& root, const std::string& finish) {
  const auto tasks = slurmTasks(plan);
  std::string list;
  for (const auto& keys : tasks) list += fmt::format("{}\n", fmt::join(keys, " "));
  const auto run = root.run();
  if (auto done = writeFile(run / "slurm-tasks.txt", list); !done)
    return std::unexpected(done.error());
  if (auto done = writeFile(run / "slurm-jobs.sh", arrayScript(root, ownProgram())); !done)
    return std::unexpected(done.error());
  if (auto done = writeFile(run / "slurm-finish.sh", "#!/bin/sh\nexec " + finish + "\n"); !done)
    return std::unexpected(done.error());
  const std::vector<std::string> common{"sbatch",
                                        "--parsable",
                                        "--requeue",
                                        "--job-name=" + jobName(root),
                                        "--open-mode=append",
                                        "--ntasks=1",
                                        "--cpus-per-task=1",
                                        "--chdir=" + run.string()};
  std::string after;
  if (!tasks.empty()) {
    auto words = common;
    words.insert(words.end(), {fmt::format("--array=1-{}", tasks.size()),
                               "--output=" + (run / "slurm-task-%a.log").string(),
                               (run / "slurm-jobs.sh").string()});
    auto id = submit(words);
    if (!id) return id;
    after = "--dependency=afterany:" + *id;
  }
  auto words = common;
  if (!after.empty()) words.push_back(after);
  words.insert(words.end(), {"--output=" + (run / "slurm-finish.log").string(),
                             (run / "slurm-finish.sh").string()});
  return submit(words);
}

Result<void> waitForSlurm(const std::string& id, const Plan& plan, const Root& root,
                          pipeline::Progress& progress) {
  const int all = plan.staleCount();
  progress.stage(fmt::format("{} jobs in Slurm", all));
  for (;;) {
    auto queue = ask({"squeue", "--noheader", "--format=%i", "--name=" + jobName(root)});
    if (!queue) return std::unexpected(queue.error());
    if (("\n" + *queue + "\n").find("\n" + id + "\n") == std::string::npos) return {};
    double all_s = 0, done_s = 0;
    std::error_code ec;
    for (const PlannedJob& p : plan.jobs) {
      if (!p.stale()) continue;
      all_s += p.cost_s;
      if (std::filesystem::exists(root.product(p.job.key) / "done.json", ec)) done_s += p.cost_s;
    }
    progress.update(done_s / std::max(all_s, 1e-9));
    if (pipeline::interrupted()) {
      progress.note(fmt::format("The night goes on in Slurm as {}; scancel --name={} ends it.", id,
                                jobName(root)));
      return std::unexpected(pipeline::interruptedError());
    }
    std::this_thread::sleep_for(std::chrono::seconds(kLook_s));
  }
}
}  // namespace swallowclip::library
