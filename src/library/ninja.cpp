// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdlib>

#include "core/file.h"
#include "library/engine.h"
#include "library/process.h"
#include "pipeline/interrupt.h"

namespace swallowclip::library {
namespace {
std::string ninjaQuoted(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '$' ? std::string("$$") : std::string(1, c);
  return out;
}
}  // namespace

Result<void> writeJobFiles(const Plan& plan, const Root& root) {
  std::error_code ec;
  for (const PlannedJob& p : plan.jobs) {
    if (!p.stale()) continue;
    if (auto done = writeFile(root.jobFile(p.job.key), jobText(p.job)); !done) return done;
    std::filesystem::remove(root.log(p.job.key), ec);
  }
  return {};
}

// `exec` and setpriv: the job is Ninja's own child and dies with it, so that nothing of a killed
// night goes on in the dark. Descriptor 3 keeps Ninja's pipe open: once a job's pipe is closed
// Ninja does nothing but wait for that job, starts no other and hears no signal.
std::string ninjaText(const Plan& plan, const Root& root, const std::string& program) {
  std::string text = fmt::format(
      "ninja_required_version = 1.8\nbuilddir = {}\n\nrule job\n"
      "  command = exec setpriv --pdeathsig KILL {} job $out --out {} 3>&1 >{}/$out.log 2>&1\n"
      "  description = $job\n\n",
      ninjaQuoted(root.run().string()), ninjaQuoted(shellQuoted(program)),
      ninjaQuoted(shellQuoted(root.path.string())),
      ninjaQuoted(shellQuoted((root.run() / "logs").string())));
  for (const int k : plan.order()) {
    const PlannedJob& p = plan.jobs[k];
    std::string needs;
    for (const int n : p.needs)
      if (plan.jobs[n].stale()) needs += " " + plan.jobs[n].job.key;
    text += fmt::format("build {}: job{}{}\n  job = {}\n", p.job.key, needs.empty() ? "" : " |",
                        needs, p.job.name);
  }
  return text;
}

Result<void> runNinja(const Plan& plan, const Root& root, int jobs, pipeline::Progress& progress) {
  if (auto found = findProgram("ninja", "ninja-build"); !found) return found;
  const auto file = root.run() / "build.ninja";
  if (auto done = writeFile(file, ninjaText(plan, root, ownProgram())); !done) return done;
  std::error_code ec;
  std::filesystem::remove(root.run() / ".ninja_log", ec);  // of no use: nothing is decided by it
  double all_s = 0, done_s = 0;
  std::map<std::string, double> costs;
  for (const int k : plan.order()) {
    costs[plan.jobs[k].job.name] = plan.jobs[k].cost_s;
    all_s += plan.jobs[k].cost_s;
  }
  int failures = 0, ended = 0;
  progress.stage(fmt::format("{} jobs", costs.size()));
  // A line "[3/60] NAME" comes when a job has ended, well or not.
  const auto line = [&](const std::string& text) {
    failures += text.starts_with("FAILED: ");
    if (text.starts_with("ninja: error:") || text.starts_with("ninja: fatal:")) progress.note(text);
    if (!text.starts_with('[')) return;
    const std::string job = text.substr(std::min(text.size(), text.find("] ") + 2));
    const auto cost = costs.find(job);
    if (cost == costs.end()) return;
    done_s += cost->second;
    ++ended;
    progress.update(done_s / std::max(all_s, 1e-9));
  };
  ::setenv("NINJA_STATUS", "[%f/%t] ", 1);
  auto code =
      runChild({"ninja", "-f", file.string(), "-k", "0", "-j", fmt::format("{}", jobs)}, line);
  if (!code) return std::unexpected(code.error());
  if (pipeline::interrupted()) return std::unexpected(pipeline::interruptedError());
  if (*code != 0 && failures == 0)
    return failure("ninja", fmt::format("ended with code {} after {} jobs", *code, ended),
                   fmt::format("Run it by hand: ninja -f {}", shellQuoted(file.string())));
  return {};
}
}  // namespace swallowclip::library
