// SPDX-License-Identifier: MIT
#include "library/process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "pipeline/interrupt.h"

extern char** environ;

namespace swallowclip::library {
namespace {
/// Whole lines out of a pipe until its other end is closed.
void listen(int fd, pid_t child, const std::function<void(const std::string&)>& line) {
  std::string pending;
  bool toldToStop = false;
  for (char buffer[4096];;) {
    const ssize_t count = ::read(fd, buffer, sizeof buffer);
    if (pipeline::interrupted() && !toldToStop) {
      ::kill(child, SIGTERM);
      toldToStop = true;
    }
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    pending.append(buffer, static_cast<std::size_t>(count));
    for (std::size_t end; (end = pending.find('\n')) != std::string::npos;) {
      line(pending.substr(0, end));
      pending.erase(0, end + 1);
    }
  }
  if (!pending.empty()) line(pending);
}
}  // namespace

Result<int> runChild(const std::vector<std::string>& words,
                     const std::function<void(const std::string&)>& line) {
  // setpriv (util-linux) sets the death signal between fork and exec.
  std::vector<std::string> all{"setpriv", "--pdeathsig", "TERM"};
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> argv;
  for (std::string& word : all) argv.push_back(word.data());
  argv.push_back(nullptr);
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    return failure(words[0], std::strerror(errno), "Close other programs.");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 2);
  pid_t child = 0;
  const int failed = ::posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (failed != 0) {
    ::close(ends[0]);
    return failure(words[0], fmt::format("can't be started ({})", std::strerror(failed)),
                   "Install util-linux, which brings setpriv.");
  }
  listen(ends[0], child, line);
  ::close(ends[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

Result<void> findProgram(const std::string& program, const std::string& package) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "/usr/local/bin:/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((std::filesystem::path(folder) / program).c_str(), X_OK) == 0) return {};
  return usageError(program, "is not installed",
                    fmt::format("Debian: apt-get install {}", package));
}

std::string shellQuoted(const std::string& word) {
  std::string inner;
  for (const char c : word) inner += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return "'" + inner + "'";
}

std::string ownProgram() {
  std::error_code ec;
  return std::filesystem::read_symlink("/proc/self/exe", ec).string();
}
}  // namespace swallowclip::library
