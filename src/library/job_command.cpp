// SPDX-License-Identifier: MIT
#include <sys/resource.h>
#include <sys/utsname.h>

#include <chrono>
#include <cstdlib>
#include <sstream>

#include "core/file.h"
#include "library/perform.h"
#include "library/store.h"

namespace swallowclip::library {
namespace fs = std::filesystem;
namespace {
std::string processorName() {
  std::istringstream lines(readFile("/proc/cpuinfo").value_or(std::string()));
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

std::string hostName() {
  utsname names{};
  return ::uname(&names) == 0 ? names.nodename : "unknown";
}

/// Removes what a job has begun unless it was published.
struct Part {
  fs::path folder;
  ~Part() {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
};

/// The files that the key stands for must be what they are now: a file saved during the night, or
/// a node with other packages, would put a product under a wrong key.
Result<void> checkKey(const Job& job) {
  Job now = job;
  Inputs inputs;
  if (auto cooked = cook(now, inputs); !cooked) return cooked;
  if (now.key == job.key) return {};
  return failure(
      job.name,
      fmt::format("the inputs or libraries here make the key {}, not {}", now.key, job.key),
      "Files were changed since the plan was made, or this machine has other packages. "
      "Run nightly again.");
}

Result<Job> loadJob(const Root& root, const std::string& key) {
  const bool plain = key.size() == 32 && key.find_first_not_of("0123456789abcdef") == key.npos;
  std::error_code ec;
  if (!plain || !fs::exists(root.jobFile(key), ec))
    return usageError("job", fmt::format("no job \"{}\" in {}", key, root.path.string()),
                      "`swallowclip nightly --plan` shows the keys; `swallowclip nightly` makes "
                      "the job files.");
  auto job = readJob(root.jobFile(key));
  if (job && job->key != key)
    return failure(root.jobFile(key).string(), "belongs to another key", "Run nightly again.");
  return job;
}

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}
}  // namespace

Result<void> job(const pipeline::RunOptions& options, pipeline::Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  auto root = openRoot(options.library.out, false);
  if (!root) return std::unexpected(root.error());
  auto job = loadJob(*root, options.library.key);
  if (!job) return std::unexpected(job.error());
  if (readMarker(root->product(job->key) / "done.json")) {
    progress.note(fmt::format("{}: done before", job->name));
    return {};
  }
  for (const std::string& key : job->needs)
    if (auto there = readMarker(root->product(key) / "done.json"); !there)
      return failure(job->name, fmt::format("needs the product {}, which is not there", key),
                     "Run that job first, or nightly.");
  if (auto same = checkKey(*job); !same) return same;
  // One thread per job; must be set before Mesa looks. The engine starts one job per processor.
  ::setenv("LP_NUM_THREADS", "1", 1);
  const Part part{partFolder(*root, job->key)};
  if (auto ready = prepareFolder(part.folder); !ready) return ready;
  progress.stage(job->name);
  if (auto done = perform(*job, *root, part.folder, progress); !done) return done;
  if (auto same = checkKey(*job); !same) return same;
  Marker marker;
  marker.key = job->key;
  marker.stage = name(job->stage);
  marker.name = job->name;
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  marker.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  marker.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  marker.peak_MB = static_cast<double>(usage.ru_maxrss) / 1024;
  marker.host = hostName();
  marker.processor = processorName();
  if (auto done = publishProduct(*root, part.folder, marker); !done) return done;
  progress.note(fmt::format("{}: done, {:.1f} s", job->name, marker.wall_s));
  return {};
}
}  // namespace swallowclip::library
