// SPDX-License-Identifier: MIT
#include "cli/command_line.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "pipeline/components.h"

using namespace swallowclip;
using namespace swallowclip::cli;

namespace {
std::vector<std::string> split(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}
CommandLine parsed(const std::string& line) {
  auto result = parseCommandLine(split(line), "/data");
  EXPECT_TRUE(result) << line << ": " << (result ? "" : result.error().text());
  return result.value_or(CommandLine{});
}
std::string problem(const std::string& line) {
  auto result = parseCommandLine(split(line), "/data");
  if (result) return "accepted";
  EXPECT_EQ(result.error().kind, ErrorKind::usage);
  return result.error().text();
}
}  // namespace

TEST(CommandLine, RenderWithEverything) {
  const auto line = parsed(
      "render --component 4 --score 3 --bolus honey --views oblique,ap --scene adult --swallow "
      "s.json "
      "--set tongue.delay_s=-0.5 --set jaw.open.gain=2e-1 --preset small --spacing-mm 1.5 "
      "--solver wcsph --out o --jobs 3");
  EXPECT_EQ(line.command, kRender);
  const auto& o = line.options;
  EXPECT_EQ(o.component, 4);
  EXPECT_EQ(o.scores, std::vector<int>{3});
  EXPECT_EQ(o.bolus, "honey");
  EXPECT_EQ(o.views, (std::vector<std::string>{"oblique", "ap"}));
  EXPECT_EQ(o.swallow, "s.json");
  ASSERT_EQ(o.sets.size(), 2u);
  EXPECT_EQ(o.sets[0].track + "/" + o.sets[0].key, "tongue/delay_s");
  EXPECT_EQ(o.sets[0].value, -0.5);
  EXPECT_EQ(o.sets[1].track + "/" + o.sets[1].key, "jaw.open/gain");
  EXPECT_EQ(o.preset, "small");
  EXPECT_EQ(o.spacing_mm, 1.5);
  EXPECT_EQ(o.solver, "wcsph");
  EXPECT_EQ(o.out, "o");
  EXPECT_EQ(o.jobs, 3);
  EXPECT_EQ(o.presetsFolder(), "/data/render_presets");
}

TEST(CommandLine, AllScoresOfEveryComponent) {
  int scores = 0;
  for (const auto& component : pipeline::components()) {
    const auto line = parsed(fmt::format("render --component {} --score all", component.word));
    EXPECT_EQ(line.options.component, component.number);
    EXPECT_EQ(line.options.scores.size(), component.scores.size());
    scores += static_cast<int>(line.options.scores.size());
  }
  EXPECT_EQ(scores, 72);
}

TEST(CommandLine, OtherCommands) {
  EXPECT_EQ(parsed("simulate --component 4 --score 0 --history r.h5").options.history, "r.h5");
  EXPECT_TRUE(parsed("measure r.h5 --json").options.json);
  EXPECT_EQ(parsed("draw r.h5 --views lateral --out x").options.views.size(), 1u);
  EXPECT_EQ(parsed("export r.h5 --format vtp --out x").options.format, "vtp");
  EXPECT_EQ(parsed("import meshes --map m.json --out s").options.map, "m.json");
  EXPECT_EQ(parsed("list boluses").options.topic, "boluses");
  EXPECT_EQ(parsed("check a.json b.json").options.files.size(), 2u);
}

TEST(CommandLine, FilesAfterAnOption) {
  const auto line = parsed("verify --jobs 2 --out results a.json b.json");
  EXPECT_EQ(line.options.verify.out, "results");
  EXPECT_EQ(line.options.files, (std::vector<std::filesystem::path>{"a.json", "b.json"}));
}

TEST(CommandLine, NearestNames) {
  EXPECT_EQ(problem("rendr --component 4"),
            "unknown command \"rendr\"\n  Did you mean \"render\"?");
  EXPECT_EQ(problem("render --componnet 4"),
            "render has no option --componnet\n  Did you mean --component?");
  EXPECT_EQ(problem("render --component bolus-transprt --score 1"),
            "--component: unknown component \"bolus-transprt\"\n"
            "  Did you mean \"bolus-transport\"?");
  EXPECT_NE(problem("render --component 4 --score 1 --solver dfhsp").find("\"dfsph\""),
            std::string::npos);
  EXPECT_NE(problem("list bolus").find("\"boluses\""), std::string::npos);
}

TEST(CommandLine, WhatDoesNotFitTogether) {
  EXPECT_EQ(problem("render --component 9 --score 3"),
            "--score: component 9 has no score 3\n  Its scores are 0 to 2.");
  EXPECT_NE(problem("render --component 18 --score 0").find("1 to 17"), std::string::npos);
  EXPECT_NE(problem("render --component 4 --score 5").find("0, 1, 2, 3, 4 or all"),
            std::string::npos);
  EXPECT_NE(problem("render --component 4").find("no score chosen"), std::string::npos);
  EXPECT_NE(problem("render").find("no component chosen"), std::string::npos);
  EXPECT_NE(problem("simulate --component 4 --score all --history r.h5").find("one score"),
            std::string::npos);
  EXPECT_EQ(parsed("render --swallow mine.json").options.component, 0);
}

TEST(CommandLine, BadValues) {
  for (const char* bad :
       {"render --component 4 --score 1 --spacing-mm nan",
        "render --component 4 --score 1 --spacing-mm 0",
        "render --component 4 --score 1 --jobs -1",
        "render --component 4 --score 1 --jobs 99999999999999",
        "render --component 4 --score 1 --set tongue=1",
        "render --component 4 --score 1 --set larynx.delay_s=0:0.6:0.1",
        "sweep --component 4 --score 1 --set larynx.delay_s=0.1",
        "sweep --component 4 --score 1 --set larynx.delay_s=0:0.6:0",
        "sweep --component 4 --score 1 --set larynx.delay_s=0.6:0:0.1",
        "sweep --component 4 --score 1 --set larynx.delay_s=0:1:0.1 --set hyoid.speed=1:2:1",
        "render --component 4 --score 1 --set tongue.x=1e999",
        "render --component 4 --score 1 --set .x=1",
        "render --component 4 --score 1 --score 2",
        "render --component 4 --score 1 --bolus=",
        "measure",
        "export r.h5 --format glb",
        "import x --map m",
        "list",
        "check",
        "",
        "--nonsense",
        "measure a.h5 b.h5"})
    EXPECT_NE(problem(bad), "accepted") << bad;
}

TEST(CommandLine, HelpAndVersion) {
  EXPECT_NE(parsed("--help").helpText.find("render"), std::string::npos);
  EXPECT_EQ(parsed("--version").helpText, "swallowclip " SWALLOWCLIP_VERSION "\n");
  for (const CommandRow& command : commandTable()) {
    const std::string help = parsed(fmt::format("{} --help", command.word)).helpText;
    for (const OptionRow& row : optionTable()) {
      const bool shown = help.find(row.help) != std::string::npos;
      EXPECT_EQ(shown, (row.commands & command.bit) != 0) << row.name << " in\n" << help;
    }
  }
}

TEST(CommandLine, ReplayLineIsQuoted) {
  auto line = parseCommandLine({"list", "views"}, "/data");
  EXPECT_EQ(line->options.commandLine, "swallowclip list views");
  auto odd = parseCommandLine({"check", "it's a file.json"}, "/data");
  EXPECT_EQ(odd->options.commandLine, "swallowclip check 'it'\\''s a file.json'");
}

/// docs/options.md is made from the table; SWALLOWCLIP_BLESS=1 writes it anew.
TEST(CommandLine, OptionsPageIsUpToDate) {
  const std::string path = SWALLOWCLIP_SOURCE_DIR "/docs/options.md";
  if (std::getenv("SWALLOWCLIP_BLESS")) std::ofstream(path) << optionsPage();
  std::ostringstream found;
  found << std::ifstream(path).rdbuf();
  EXPECT_EQ(found.str(), optionsPage()) << "SWALLOWCLIP_BLESS=1 build/tests/cli/test_cli writes it";
}
