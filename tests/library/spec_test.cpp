// SPDX-License-Identifier: MIT
#include "library/spec.h"

#include "data.h"

namespace swallowclip::library {
namespace {
class Spec : public test::Library {
 protected:
  std::string problems(const std::string& text) {
    auto spec = loadSpec(write("spec.json", text), options);
    return spec ? "" : spec.error().text();
  }
};

TEST_F(Spec, TheShippedOneIsGood) {
  const auto spec = loadSpec(options.scenesFolder() / "nightly.json", options);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_FALSE(spec->swallows.empty());
  EXPECT_TRUE(spec->publish.labelsConfirmed);
  EXPECT_EQ(spec->publish.missingClipsAllowed, 0);
}

TEST_F(Spec, AllProblemsAtOnceEachWithItsPlace) {
  const std::string text = problems(
      "{\"boluses\": [\"thn\"],\n \"views\": [\"oblique\", \"latteral\"],\n \"presets\": "
      "[\"smal\"],\n"
      " \"spacing_mm\": 9,\n \"colour\": \"blue\",\n"
      " \"swallows\": [{\"component\": 10, \"scores\": [7]},\n"
      "  {\"component\": 99, \"scores\": \"all\"}],\n \"publish\": {\"keep_nights\": 0}}");
  for (const char* expected :
       {"spec.json:1:14", "Did you mean \"thin\"?", "spec.json:3:14", "Did you mean \"small\"?",
        "spec.json:4:", "spec.json:5:2", "unknown key \"colour\"",
        "spec.json:6:", "spec.json:7:", "spec.json:8:"})
    EXPECT_NE(text.find(expected), std::string::npos) << expected << " is not in:\n" << text;
}

TEST_F(Spec, ViewsAreThoseOfThePresets) {
  const std::string text =
      problems("{\"views\": [\"latteral\"], \"swallows\": [{\"component\": 4, \"scores\": [0]}]}");
  EXPECT_NE(text.find("Did you mean \"lateral\"?"), std::string::npos) << text;
}

TEST_F(Spec, ASwallowFileMustShowItsScore) {
  write("mine.json",
        "{\"base\": \"data/scenes/swallows/normal.json\", \"component\": 4, "
        "\"score\": 2}");
  const std::string text =
      problems("{\"swallows\": [{\"component\": 4, \"scores\": [1], \"swallow\": \"mine.json\"}]}");
  EXPECT_NE(text.find("shows component 4, score 2, not component 4, score 1"), std::string::npos)
      << text;
  const std::string missing = problems("{\"swallows\": [{\"component\": 17, \"scores\": [4]}]}");
  EXPECT_NE(missing.find("c17-s4.json"), std::string::npos) << missing;
}

TEST_F(Spec, EntriesMayHaveTheirOwnViewsAndBoluses) {
  const auto spec =
      loadSpec(write("spec.json",
                     "{\"boluses\": [\"thin\"], \"views\": [\"si\"], \"swallows\": "
                     "[{\"component\": 4, \"scores\": [0], \"boluses\": [\"none\", \"honey\"], "
                     "\"views\": [\"ap\"]}, {\"component\": 4, \"scores\": [1]}]}"),
               options);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_EQ(spec->swallows[0].boluses, (std::vector<std::string>{"none", "honey"}));
  EXPECT_EQ(spec->swallows[0].views, (std::vector<std::string>{"ap"}));
  EXPECT_EQ(spec->swallows[1].boluses, (std::vector<std::string>{"thin"}));
  EXPECT_EQ(spec->swallows[1].views, (std::vector<std::string>{"si"}));
}

TEST_F(Spec, TheSameScoreTwiceIsRefused) {
  const std::string text = problems(
      "{\"swallows\": [{\"component\": 4, \"scores\": [0]}, {\"component\": 4, \"scores\": "
      "\"all\"}]}");
  EXPECT_NE(text.find("component 4, score 0 a second time"), std::string::npos) << text;
}
}  // namespace
}  // namespace swallowclip::library
