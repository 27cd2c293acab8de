// SPDX-License-Identifier: MIT
// Nights out of made-up products.
#include "library/publish.h"

#include "core/digest.h"
#include "data.h"

namespace swallowclip::library {
namespace {
namespace fs = std::filesystem;

class PublishTest : public test::Library {
 protected:
  PublishTest() : root(openRoot(options.library.out, true).value()), stamps(root.run() / "stamps") {
    made = plan(test::kSpec);
  }

  /// Products for every job of the plan that has none; clips hold `bytes`.
  void make(const std::string& bytes, const std::string& unconfirmed = "none of them") {
    for (PlannedJob& p : made.jobs) {
      const Job& j = p.job;
      const fs::path part = partFolder(root, j.key);
      fs::remove_all(root.product(j.key));
      ASSERT_TRUE(prepareFolder(part));
      const std::string stem = fmt::format("{}-{}", j.choice.stem(), j.choice.view);
      const bool good = j.name.find(unconfirmed) == std::string::npos;
      std::map<std::string, std::string> files;
      if (j.stage == Stage::measure)
        files["measures.json"] = fmt::format(
            "{{\"label_confirmed\": {}, \"label_reason\": \"r\", \"scores_measured\": {{\"4\": 1, "
            "\"5\": null}}, \"quantities\": {{\"v\": {{\"value\": 2.5}}, \"w\": {{\"value\": "
            "null}}}}}}",
            good);
      if (j.stage == Stage::draw)
        for (const char* kind : {".mp4", ".png", ".vtt"})
          files[stem + kind] = bytes + j.name + kind;
      if (j.stage == Stage::verify)
        for (const char* file : {"sheet.png", "thumb.png"}) files[file] = bytes + j.name + file;
      for (const auto& [file, text] : files) {
        ASSERT_TRUE(writeFile(part / file, text));
      }
      Marker m;
      m.key = j.key;
      m.stage = name(j.stage);
      m.name = j.name;
      ASSERT_TRUE(publishProduct(root, part, m));
    }
    Store store(root, stamps);
    lookUp(made, store, Memory(root.run() / "memory"), true);
  }
  Night publish() {
    Night night = gatherNight(made, root);
    const auto done = publishNight(night, publishedNight(root), made, root, stamps);
    EXPECT_TRUE(done) << done.error().text();
    return night;
  }

  Root root;
  Stamps stamps;
  Plan made;
};

TEST_F(PublishTest, ANightIsShownWithAManifestThatMatches) {
  make("a");
  const Night night = publish();
  EXPECT_EQ(night.clips.size(), 8u);
  EXPECT_EQ(night.files().size(), 8 * 5u + 4u);  // four side files are shared by two views
  const auto shown = publishedNight(root);
  ASSERT_TRUE(shown);
  EXPECT_EQ(shown->content(), night.content());
  EXPECT_TRUE(nightHolds(root, *shown, stamps));
  const NightClip* clip = shown->find("small/c04/c04-s1-honey-si");
  ASSERT_TRUE(clip);
  EXPECT_TRUE(clip->measured.labelConfirmed);
  EXPECT_EQ(night.clips[0].measured.quantities.size(), 1u);
  // and for sha256sum -c
  EXPECT_NE(readFile(root.current() / "SHA256SUMS")->find("  small/c04/c04-s1-honey-si.mp4\n"),
            std::string::npos);
}

TEST_F(PublishTest, TheNextNightSharesWhatHasNotChanged) {
  make("a");
  const Night first = publish();
  for (PlannedJob& p : made.jobs)
    if (p.job.name.ends_with("c04-s0-thin-si") && p.job.stage == Stage::draw)
      fs::remove_all(root.product(p.job.key));
  Plan whole = made;
  std::erase_if(made.jobs, [](const PlannedJob& p) {
    return !(p.job.name.ends_with("c04-s0-thin-si") && p.job.stage == Stage::draw);
  });
  for (PlannedJob& p : made.jobs) p.needs.clear();
  make("b");
  const PlannedJob redrawn = made.jobs[0];
  made = whole;
  for (PlannedJob& p : made.jobs)
    if (p.job.key == redrawn.job.key) p.marker = redrawn.marker;
  const Night second = publish();
  EXPECT_EQ(second.name.substr(0, 7), "n000002");
  const auto links = [&](const Night& night, const char* file) {
    return fs::hard_link_count(root.nights() / night.name / file);
  };
  EXPECT_EQ(links(second, "small/c04/c04-s0-thin-oblique.mp4"), 2u);
  EXPECT_EQ(links(second, "small/c04/c04-s0-thin-si.mp4"), 1u);
  EXPECT_EQ(links(first, "small/c04/c04-s0-thin-si.mp4"), 1u);
}

TEST_F(PublishTest, DamageToTheShownNightIsNoticedAndTheNextIsWhole) {
  make("a");
  const Night first = publish();
  const fs::path clip = root.nights() / first.name / "small/c04/c04-s0-thin-si.mp4";
  std::ofstream(clip) << "b";
  EXPECT_FALSE(nightHolds(root, first, stamps));
  const Night second = publish();
  EXPECT_TRUE(nightHolds(root, second, stamps));
  EXPECT_NE(fs::file_size(root.current() / "small/c04/c04-s0-thin-si.mp4"), 1u);
}

TEST_F(PublishTest, ADamagedProductStopsTheNightAndTheLastStays) {
  make("a");
  const Night first = publish();
  make("b");
  for (const PlannedJob& p : made.jobs)
    if (p.job.stage == Stage::draw && p.job.name.ends_with("c04-s0-thin-si"))
      std::ofstream(root.product(p.job.key) / "c04-s0-thin-si.mp4") << "c";
  Night night = gatherNight(made, root);
  const auto done = publishNight(night, publishedNight(root), made, root, stamps);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().text().find("c04-s0-thin-si.mp4"), std::string::npos);
  ASSERT_TRUE(publishedNight(root));
  EXPECT_EQ(publishedNight(root)->name, first.name);
}

TEST_F(PublishTest, ClipsWithoutAConfirmedLabelStayOut) {
  make("a", "c04-s1-thin");
  const Night night = gatherNight(made, root);
  EXPECT_EQ(night.clips.size(), 6u);
  ASSERT_EQ(night.missing.size(), 2u);
  EXPECT_NE(night.missing[0].why.find("label not confirmed"), std::string::npos);
  made.spec.publish.labelsConfirmed = false;
  const Night draft = gatherNight(made, root);
  EXPECT_EQ(draft.clips.size(), 8u);
  EXPECT_TRUE(draft.draft);
  EXPECT_NE(draft.content(), night.content());
}

TEST_F(PublishTest, PruningKeepsTheNewestAndTheOneShown) {
  make("a");
  const Night first = publish();
  for (int k = 0; k < 3; ++k) {
    make(std::string(1, static_cast<char>('b' + k)));
    publish();
  }
  fs::create_directory(root.nights() / ".n000009-20260101.part");
  fs::create_directory(root.nights() / "mine");
  fs::remove(root.current());
  fs::create_symlink(fs::path("nights") / first.name, root.current());
  EXPECT_EQ(pruneNights(root, {true, 0, 2, 50}), 1);
  EXPECT_TRUE(fs::exists(root.nights() / first.name));
  EXPECT_TRUE(fs::exists(root.nights() / "mine"));
  EXPECT_FALSE(fs::exists(root.nights() / ".n000009-20260101.part"));
  EXPECT_EQ(pruneNights(root, {true, 0, 9, 0}), 2);
  EXPECT_TRUE(publishedNight(root));
}
}  // namespace
}  // namespace swallowclip::library
