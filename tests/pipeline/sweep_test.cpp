// SPDX-License-Identifier: MIT
// Measuring histories that are no histories, and sweeps: what they refuse, what they write.
#include "frame/history_file.h"
#include "pipeline/compare.h"
#include "pipeline/confirm.h"
#include "pipeline/simulation.h"
#include "run.h"

namespace swallowclip::pipeline {
namespace {
class Sweep : public test::Run {
 protected:
  std::string problem() {
    const auto done = sweep(options, notes);
    return done ? "" : done.error().text();
  }
};

TEST_F(Sweep, ValuesAreThoseThatWereTyped) {
  const TrackRange r{"larynx", "delay_s", 0, 0.6, 0.1};
  EXPECT_EQ(r.values(), (std::vector<double>{0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6}));
  EXPECT_EQ((TrackRange{"a", "b", 1, 2, 0.4}).values(), (std::vector<double>{1, 1.4, 1.8}));
}

TEST_F(Sweep, UnknownTracksAndWildValuesAreRefusedBeforeAnyWork) {
  options.range = {"larinx", "delay_s", 0, 0.6, 0.1};
  EXPECT_NE(problem().find("Did you mean 'larynx'?"), std::string::npos);
  options.range = {"larynx", "speed", 0.5, 30.5, 10};
  EXPECT_NE(problem().find("[0.05, 20]"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(options.out));
}

TEST_F(Sweep, OneRowPerValueWhateverTheThreads) {
  shorten(1.6);
  options.bolus = "none";
  options.range = {"arytenoid", "delay_s", 0, 0.1, 0.05};
  std::vector<std::string> tables;
  for (int jobs : {1, 3}) {
    options.jobs = jobs;
    ASSERT_EQ(problem(), "");
    tables.push_back(readFile(options.out / "sweep.csv").value());
  }
  EXPECT_EQ(tables[0], tables[1]);
  EXPECT_EQ(std::ranges::count(tables[0], '\n'), 4);
  EXPECT_EQ(filesIn(options.out),
            (std::vector<std::string>{"sweep.csv", "sweep.png", "sweep.svg"}));
}

TEST_F(Sweep, SettingsAreNamedInTheHistoryAndTheChangesReported) {
  shorten(1.6);
  options.bolus = "none";
  options.history = folder / "unchanged.h5";
  ASSERT_TRUE(simulate(options, notes));
  options.compare = options.history;
  options.history = folder / "changed.h5";
  options.sets = {{"arytenoid", "delay_s", 0.1}};
  ASSERT_TRUE(simulate(options, notes));
  EXPECT_NE(notes.printed.find("hyoid burst to vestibule closed (s)"), std::string::npos);
  const auto before =
      measureHistory(options.scenesFolder(), frame::loadHistory(folder / "unchanged.h5").value());
  const auto after =
      measureHistory(options.scenesFolder(), frame::loadHistory(folder / "changed.h5").value());
  ASSERT_TRUE(before && after);
  for (const Outcome& o : outcomes()) {
    if (std::string_view(o.quantity) != "time_to_lvc") continue;
    EXPECT_NEAR(outcome(*after, o) - outcome(*before, o), 0.1, 0.034);
  }
  EXPECT_EQ(frame::loadHistory(options.history)->meta.swallow, "short+arytenoid.delay_s=0.1");
}

class Measure : public test::Run {};

TEST_F(Measure, BrokenHistoriesAreNamedAndNothingIsDrawn) {
  shorten(0.5);
  options.bolus = "none";
  options.history = folder / "whole.h5";
  ASSERT_TRUE(simulate(options, notes));
  const std::string whole = readFile(options.history).value();
  options.plot = folder / "sheet.svg";
  const auto measured = [&](const std::string& bytes) {
    options.history = folder / "broken.h5";
    EXPECT_TRUE(writeFile(options.history, bytes));
    const auto done = measure(options, notes);
    return done ? std::string() : done.error().text();
  };
  for (const std::string& bytes :
       {std::string(), whole.substr(0, whole.size() / 2), std::string("not a history")}) {
    EXPECT_NE(measured(bytes).find("broken.h5"), std::string::npos) << bytes.size() << " bytes";
    EXPECT_FALSE(std::filesystem::exists(options.plot));
  }
  EXPECT_EQ(measured(whole), "") << "without a bolus there is still much to measure";
  EXPECT_TRUE(std::filesystem::exists(options.plot));
}
}  // namespace
}  // namespace swallowclip::pipeline
