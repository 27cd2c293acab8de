// SPDX-License-Identifier: MIT
#include "library/plan.h"

#include <set>

#include "data.h"
#include "library/engine.h"
#include "library/process.h"

namespace swallowclip::library {
namespace {
namespace fs = std::filesystem;
class PlanTest : public test::Library {
 protected:
  /// Names of jobs whose key differs from before.
  static std::set<std::string> changed(const Plan& before, const Plan& after) {
    std::map<std::string, std::string> old;
    for (const PlannedJob& p : before.jobs) old[p.job.name] = p.job.key;
    std::set<std::string> names;
    for (const PlannedJob& p : after.jobs)
      if (old[p.job.name] != p.job.key) names.insert(p.job.name);
    return names;
  }
  static std::map<std::string, int> byStage(const std::set<std::string>& names) {
    std::map<std::string, int> count;
    for (const std::string& n : names) ++count[n.substr(0, n.find(' '))];
    return count;
  }
};

TEST_F(PlanTest, HistoriesAreSharedByViewsAndBakesByBoluses) {
  const Plan p = plan(test::kSpec);
  std::set<std::string> names, keys;
  for (const PlannedJob& j : p.jobs) {
    names.insert(j.job.name);
    keys.insert(j.job.key);
  }
  EXPECT_EQ(keys.size(), p.jobs.size());
  EXPECT_EQ(byStage(names),
            (std::map<std::string, int>{
                {"bake", 2}, {"simulate", 4}, {"measure", 4}, {"draw", 8}, {"verify", 8}}));
  EXPECT_EQ(p.clips.size(), 8u);
}

TEST_F(PlanTest, RemarksAndReadmesChangeNothing) {
  const Plan before = plan(test::kSpec);
  change("scenes/swallows/c04-s0.json", "MBSImP component 4", "A remark about component 4");
  change("render_presets/small.json", "{\n", "{\n\n  \"comment\": \"looks\",\n");
  write("data/scenes/adult/README.md", "words");
  EXPECT_EQ(changed(before, plan(test::kSpec)), std::set<std::string>{});
}

TEST_F(PlanTest, AViewOfAPresetRedrawsThatViewOnly) {
  const Plan before = plan(test::kSpec);
  change("render_presets/training.json", "\"captionTitle\": \"S-I tongue view",
         "\"captionTitle\": \"S-I view of the tongue");
  const auto names = changed(before, plan(test::kSpec));
  EXPECT_EQ(byStage(names), (std::map<std::string, int>{{"draw", 4}, {"verify", 4}}));
  for (const std::string& n : names) EXPECT_TRUE(n.ends_with("-si")) << n;
}

TEST_F(PlanTest, AScoreFileResimulatesThatSwallowOnly) {
  const Plan before = plan(test::kSpec);
  change("scenes/swallows/c04-s1.json", "6.5", "6.6");
  const auto names = changed(before, plan(test::kSpec));
  EXPECT_EQ(byStage(names),
            (std::map<std::string, int>{
                {"bake", 1}, {"simulate", 2}, {"measure", 2}, {"draw", 4}, {"verify", 4}}));
  for (const std::string& n : names) EXPECT_NE(n.find("c04-s1"), std::string::npos) << n;
}

TEST_F(PlanTest, TheBaseOfASwallowShapesAllOfThem) {
  const Plan before = plan(test::kSpec);
  change("scenes/swallows/normal.json", "\"peak_mm\": 22", "\"peak_mm\": 21");
  EXPECT_EQ(changed(before, plan(test::kSpec)).size(), 26u);
}

TEST_F(PlanTest, ABolusResimulatesThatBolusOnly) {
  const Plan before = plan(test::kSpec);
  change("scenes/boluses.json", "\"viscosity_Pas\": 0.004", "\"viscosity_Pas\": 0.005");
  const auto names = changed(before, plan(test::kSpec));
  EXPECT_EQ(byStage(names), (std::map<std::string, int>{
                                {"simulate", 2}, {"measure", 2}, {"draw", 4}, {"verify", 4}}));
  for (const std::string& n : names) EXPECT_NE(n.find("thin"), std::string::npos) << n;
}

TEST_F(PlanTest, AShaderRedrawsEverythingAndSimulatesNothing) {
  const Plan before = plan(test::kSpec);
  change("shaders/ao.frag", "// SPDX", "// changed\n// SPDX");
  EXPECT_EQ(byStage(changed(before, plan(test::kSpec))),
            (std::map<std::string, int>{{"draw", 8}, {"verify", 8}}));
}

TEST_F(PlanTest, TheOrderPutsLongWaysFirstAndNeverAJobBeforeItsNeeds) {
  Plan p = plan(test::kSpec);
  const auto root = openRoot(options.library.out, true);
  ASSERT_TRUE(root);
  Stamps stamps(root->run() / "stamps.tsv");
  Store store(*root, stamps);
  lookUp(p, store, Memory(root->run() / "memory.tsv"), true);
  std::set<int> seen;
  double last_s = 1e9;
  for (const int k : p.order()) {
    for (const int n : p.jobs[k].needs) EXPECT_TRUE(seen.contains(n)) << p.jobs[k].job.name;
    EXPECT_LE(p.jobs[k].path_s, last_s);
    last_s = p.jobs[k].path_s;
    seen.insert(k);
  }
  EXPECT_EQ(seen.size(), p.jobs.size());
  const std::string text = planText(p);
  EXPECT_NE(text.find("stale: not made yet"), std::string::npos);
  EXPECT_NE(text.find("26 of 26 jobs to do"), std::string::npos);

  const std::string ninja = ninjaText(p, *root, "/opt/it's/$wallow");
  EXPECT_NE(ninja.find("'/opt/it'\\''s/$$wallow' job $out"), std::string::npos) << ninja;

  const auto tasks = slurmTasks(p);
  EXPECT_EQ(tasks.size(), 4u);  // one per swallow and bolus
  for (const auto& task : tasks) {
    std::set<std::string> done;
    EXPECT_EQ(task.size(), 7u);  // bake, simulate, measure, two clips
    for (const std::string& key : task) {
      for (const PlannedJob& j : p.jobs) {
        if (j.job.key != key) continue;
        for (const std::string& need : j.job.needs) EXPECT_TRUE(done.contains(need));
      }
      done.insert(key);
    }
  }
}

TEST_F(PlanTest, ALongJobHoldsUpNoOther) {
  Plan p = plan(test::kSpec);
  const auto root = openRoot(options.library.out, true);
  ASSERT_TRUE(root);
  std::string slow, waiting;  // one bake, and a job that needs only the other one
  for (const PlannedJob& j : p.jobs) {
    if (j.job.name == "bake c04-s0") slow = j.job.key;
    if (j.job.name == "simulate c04-s1-thin") waiting = j.job.key;
  }
  const fs::path list = folder / "list";
  // The slow one ends as soon as the other has begun, or after a minute.
  const fs::path fake = write(
      "fake", fmt::format("#!/bin/sh\necho start $2 >>'{0}'\nif [ $2 = {1} ]; then\n"
                          "  timeout 60 sh -c 'until grep -q \"start {2}\" \"{0}\"; do sleep 0.1; "
                          "done'\nfi\necho end $2 >>'{0}'\n",
                          list.string(), slow, waiting));
  fs::permissions(fake, fs::perms::owner_all);
  const fs::path file = write("build.ninja", ninjaText(p, *root, fake.string()));
  const auto code = runChild({"ninja", "-f", file.string(), "-k", "0", "-j", "2"}, [](auto&) {});
  ASSERT_TRUE(code) << code.error().text();
  EXPECT_EQ(*code, 0);
  const std::string order = readFile(list).value();
  EXPECT_LT(order.find("start " + waiting), order.find("end " + slow)) << order;
}

TEST_F(PlanTest, TheMemoryTellsWhichInputHasChanged) {
  const Plan before = plan(test::kSpec);
  Memory memory(folder / "memory.tsv");
  memory.keep(before);
  ASSERT_TRUE(memory.save());
  change("scenes/boluses.json", "\"viscosity_Pas\": 0.004", "\"viscosity_Pas\": 0.005");
  const Memory read(folder / "memory.tsv");
  for (const PlannedJob& p : plan(test::kSpec).jobs) {
    if (p.job.name == "simulate c04-s0-thin") {
      EXPECT_EQ(read.changes(p.job), "file boluses.json thin changed");
    }
    if (p.job.name == "measure c04-s0-thin") {
      EXPECT_EQ(read.changes(p.job), "made from products that changed");
    }
    if (p.job.name == "simulate c04-s0-honey") {
      EXPECT_EQ(read.changes(p.job), "");
    }
  }
}

TEST_F(PlanTest, AJobFileReadsBackAndDamageIsNoticed) {
  const Plan p = plan(test::kSpec);
  for (const PlannedJob& j : p.jobs) {
    const fs::path file = write("job.json", jobText(j.job));
    auto read = readJob(file);
    ASSERT_TRUE(read) << read.error().text();
    Inputs inputs;
    ASSERT_TRUE(cook(*read, inputs));
    EXPECT_EQ(read->key, j.job.key) << j.job.name;
    std::string text = jobText(j.job);
    text[text.find("adult")] = 'b';
    EXPECT_FALSE(readJob(write("job.json", text)));
  }
}
}  // namespace
}  // namespace swallowclip::library
