// SPDX-License-Identifier: MIT
#include "cli/run.h"

#include <gtest/gtest.h>

#include <csignal>

#include "cli/progress.h"
#include "pipeline/interrupt.h"

using namespace swallowclip;
using namespace swallowclip::cli;

namespace {
const std::vector<std::string> kRenderWords{"render", "--component", "4", "--score", "0"};

struct Outcome {
  int code;
  std::string out, err;
};
Outcome call(std::vector<std::string> words, const Handler& handler) {
  Handlers handlers;
  for (const CommandRow& command : commandTable()) handlers[command.bit] = handler;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = run(words, SWALLOWCLIP_SOURCE_DIR, handlers);
  std::string out = testing::internal::GetCapturedStdout();
  return {code, out, testing::internal::GetCapturedStderr()};
}
Outcome call(std::vector<std::string> words) {
  return call(std::move(words), [](const auto&, auto&) { return Result<void>{}; });
}
}  // namespace

TEST(Run, ExitCodes) {
  EXPECT_EQ(call(kRenderWords).code, kDone);
  EXPECT_EQ(call({"render"}).code, kUsage);
  const auto failed = call(kRenderWords, [](const auto&, auto&) -> Result<void> {
    return failure("bolus", "the pocket is sealed at 1.2 s", "Open the velum later.");
  });
  EXPECT_EQ(failed.code, kFailed);
  EXPECT_EQ(failed.err,
            "swallowclip: bolus: the pocket is sealed at 1.2 s\n  Open the velum later.\n");
  EXPECT_EQ(
      call(kRenderWords,
           [](const auto&, auto&) -> Result<void> { return usageError("f.json:1:2", "x", "y"); })
          .code,
      kUsage);
  EXPECT_EQ(
      call(kRenderWords, [](const auto&, auto&) -> Result<void> { throw std::bad_alloc(); }).code,
      kFailed);
}

TEST(Run, NamesAreCheckedBeforeAnyWork) {
  const Handler never = [](const auto&, auto&) -> Result<void> {
    ADD_FAILURE() << "work began";
    return {};
  };
  const auto with = [](const char* option, const char* value) {
    auto words = kRenderWords;
    words.insert(words.end(), {option, value});
    return words;
  };
  const auto bolus = call(with("--bolus", "nectr"), never);
  EXPECT_EQ(bolus.code, kUsage);
  EXPECT_NE(bolus.err.find("Did you mean \"nectar\"?"), std::string::npos) << bolus.err;
  const auto view = call(with("--views", "oblique,latteral"), never);
  EXPECT_EQ(view.code, kUsage);
  EXPECT_NE(view.err.find("Did you mean \"lateral\"?"), std::string::npos) << view.err;
  const auto scene = call(with("--scene", "adlt"), never);
  EXPECT_NE(scene.err.find("Did you mean \"adult\"?"), std::string::npos) << scene.err;
  EXPECT_EQ(call(with("--swallow", "/none.json"), never).code, kUsage);
  EXPECT_EQ(call({"measure", "/none.h5"}, never).code, kUsage);
  EXPECT_EQ(call({"check", "/none.json"}, never).code, kUsage);
}

TEST(Run, ResultsGoToStdoutOnlyAndNoProgressWithoutTerminal) {
  const auto done = call({"list", "views"}, [](const auto&, pipeline::Progress& progress) {
    progress.stage("looking");
    progress.update(0.5);
    progress.print("oblique\n");
    progress.note("a remark");
    return Result<void>{};
  });
  EXPECT_EQ(done.out, "oblique\n");
  EXPECT_EQ(done.err, "a remark\n");
}

TEST(Run, InterruptEndsWith130) {
  pipeline::catchInterrupts();
  const auto stopped = call(kRenderWords, [](const auto&, auto&) -> Result<void> {
    std::raise(SIGINT);
    if (pipeline::interrupted()) return std::unexpected(pipeline::interruptedError());
    return {};
  });
  EXPECT_EQ(stopped.code, kInterrupted);
  pipeline::setInterrupted(false);
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

TEST(Progress, LineFitsTheTerminal) {
  EXPECT_EQ(progressLine("simulating", 0.25, 10, 80), "simulating   25 %, 0:30 left");
  EXPECT_EQ(progressLine("simulating", 0.25, 1, 80), "simulating   25 %");
  for (int columns = 1; columns < 60; ++columns)
    EXPECT_LT(progressLine("a very long name of a stage indeed", 0.5, 100, columns).size(),
              static_cast<std::size_t>(columns));
  EXPECT_EQ(progressLine("x", NAN, 10, 80), "x    0 %");
}
