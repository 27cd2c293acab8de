// SPDX-License-Identifier: MIT
#include "scene/json_reader.h"

#include <gtest/gtest.h>

#include <fstream>

using namespace swallowclip;
using swallowclip::scene::JsonFile;

namespace {
JsonFile parsed(const std::string& text) {
  auto file = JsonFile::parse(text, "t.json");
  EXPECT_TRUE(file) << (file ? "" : file.error().text());
  return *file;
}
std::string syntaxError(const std::string& text) {
  auto file = JsonFile::parse(text, "t.json");
  return file ? "accepted" : file.error().text();
}
std::string finishError(const JsonFile& file) {
  const auto done = file.finish();
  return done ? "accepted" : done.error().text();
}
}  // namespace

TEST(JsonReader, ReadsEveryKind) {
  const auto file = parsed(R"({"comment": "free", "a": 1.5, "n": -3, "t": "sé", "b": true,
    "v": [1, 2, 3], "p2": [[1, 2], [3, 4]], "p3": [[1,2,3]], "w": ["x", "y"], "o": {"q": 2},
    "l": [{"r": 1}, {"r": 2}], "m": {"one": 1, "two": 2}, "c": "sun"})");
  const auto root = file.root();
  EXPECT_EQ(root.number("a", 0, 2), 1.5);
  EXPECT_EQ(root.integer("n", -5, 5), -3);
  EXPECT_EQ(root.text("t"), "sé");
  EXPECT_TRUE(root.boolean("b", false));
  EXPECT_EQ(root.vec3("v"), Vec3(1, 2, 3));
  ASSERT_EQ(root.points2("p2").size(), 2u);
  EXPECT_EQ(root.points2("p2")[1], Vec2(3, 4));
  EXPECT_EQ(root.points3("p3").at(0), Vec3(1, 2, 3));
  EXPECT_EQ(root.texts("w").at(1), "y");
  EXPECT_EQ(root.object("o").number("q", 0, 9), 2);
  EXPECT_EQ(root.array("l").at(1).integer("r", 0, 9), 2);
  EXPECT_EQ(root.object("m").members().at(1).first, "two");
  EXPECT_EQ(root.object("m").members().at(1).second.asNumber(0, 9), 2);
  EXPECT_EQ(root.choice("c", {"moon", "sun"}), "sun");
  EXPECT_EQ(root.number("absent", 0, 1, 0.25), 0.25);
  EXPECT_EQ(root.choice("absent", {"moon", "sun"}, "moon"), "moon");
  EXPECT_EQ(finishError(file), "accepted");
}

TEST(JsonReader, WordingOfAnOutOfRangeValue) {
  const auto file = parsed("{\n  \"density_kgm3\": 12,\n  \"late\": true\n}");
  EXPECT_EQ(file.root().number("density_kgm3", 500, 3000), 500);
  EXPECT_EQ(finishError(file),
            "t.json:2:19: \"density_kgm3\": 12 is outside 500 to 3000\n"
            "      \"density_kgm3\": 12,\n"
            "                      ^\n"
            "  Check value and unit.");
}

TEST(JsonReader, WordingOfAnUnknownKey) {
  const auto file = parsed("{\"fps\": 30,\n \"frmes\": 109}");
  file.root().number("fps", 30, 120);
  file.root().integer("frames", 1, 1000, 109);
  EXPECT_EQ(finishError(file),
            "t.json:2:2: unknown key \"frmes\"\n"
            "     \"frmes\": 109}\n"
            "     ^\n"
            "  Did you mean \"frames\"?");
}

TEST(JsonReader, FindsUnknownKeysInsideObjectsAndLists) {
  const auto nested = parsed(R"({"o": {"a": 1, "zz": 2}})");
  nested.root().object("o").number("a", 0, 1);
  EXPECT_NE(finishError(nested).find("t.json:1:16: unknown key \"zz\""), std::string::npos);
  const auto listed = parsed(R"({"l": [{"a": 1}, {"b": 2}]})");
  for (const auto& node : listed.root().array("l")) node.number("a", 0, 1, 0);
  EXPECT_NE(finishError(listed).find("t.json:1:19: unknown key \"b\""), std::string::npos);
}

TEST(JsonReader, MissingKeyAndWrongKindNameThePlace) {
  const auto missing = parsed("{\"radus_mm\": 3}");
  missing.root().number("radius_mm", 0, 9);
  EXPECT_NE(finishError(missing).find("\"radius_mm\" is missing"), std::string::npos);
  EXPECT_NE(finishError(missing).find("by \"radus_mm\"?"), std::string::npos);
  const auto wrong = parsed("{\"a\":\n \"x\"}");
  wrong.root().number("a", 0, 1);
  EXPECT_NE(finishError(wrong).find("t.json:2:2: \"a\": expected a number, found a text"),
            std::string::npos);
  const auto word = parsed("{\"kind\": \"newtonain\"}");
  EXPECT_EQ(word.root().choice("kind", {"newtonian", "carreau"}), "newtonian");
  EXPECT_NE(finishError(word).find("Did you mean \"newtonian\"?"), std::string::npos);
}

TEST(JsonReader, KeepsOnlyTheFirstProblemAndStaysSilentBelowIt) {
  const auto file = parsed("{\"o\": 3}");
  const auto absent = file.root().object("o");
  EXPECT_FALSE(absent.exists());
  absent.number("x", 0, 1);
  absent.object("y").array("z");
  EXPECT_TRUE(absent.points3("p").empty());
  EXPECT_NE(finishError(file).find("expected an object, found a number"), std::string::npos);
}

TEST(JsonReader, RefusesBrokenText) {
  EXPECT_NE(syntaxError("{\"a\": 1,\n \"b\" 2}").find("t.json:2:"), std::string::npos);
  EXPECT_NE(syntaxError("{\"a\": [1, 2").find("ends in the middle"), std::string::npos);
  EXPECT_NE(syntaxError("").find("t.json"), std::string::npos);
  EXPECT_NE(syntaxError("{\"a\": 1, \"a\": 2}").find("appears twice"), std::string::npos);
  EXPECT_NE(syntaxError("{\"a\": 1e999}").find("too large"), std::string::npos);
  EXPECT_NE(syntaxError("{\"a\": NaN}").find("not valid JSON"), std::string::npos);
  EXPECT_NE(syntaxError("{\"a\": \"\xff\"}").find("not valid UTF-8"), std::string::npos);
  EXPECT_NE(syntaxError("{} {}").find("t.json:1:"), std::string::npos);
  EXPECT_NE(syntaxError(std::string(100000, '[')).find("nested deeper"), std::string::npos);
}

TEST(JsonReader, RefusesHugeFilesWithoutReadingThem) {
  const std::string path = ::testing::TempDir() + "json_reader_huge.json";
  std::ofstream(path) << "{}";
  std::filesystem::resize_file(path, 65u << 20);  // sparse
  const auto file = JsonFile::load(path);
  ASSERT_FALSE(file);
  EXPECT_NE(file.error().text().find("65 MB, at most 64 MB"), std::string::npos);
  std::filesystem::remove(path);
  EXPECT_NE(JsonFile::load("/nonexistent.json").error().text().find("no such file"),
            std::string::npos);
  EXPECT_NE(JsonFile::load("/dev/zero").error().text().find("not a regular file"),
            std::string::npos);
}

TEST(JsonReader, ManyValuesStop) {
  std::string text = "[0";
  text.reserve(2'200'000);
  for (int i = 0; i < 1'100'000; ++i) text += ",0";
  EXPECT_NE(syntaxError(text + "]").find("more than 1000000 values"), std::string::npos);
}

TEST(JsonReader, CaretStaysUnderTheValueInLongAndAccentedLines) {
  const auto file = parsed("{\"é\": 0, \"pad\": \"" + std::string(300, 'x') + "\", \"a\": 7}");
  file.root().number("a", 0, 1);
  const std::string text = finishError(file);
  const auto lines = text.substr(text.find('\n') + 1);
  const auto first = lines.substr(0, lines.find('\n'));
  const auto caret = lines.substr(first.size() + 1).find('^');
  EXPECT_EQ(first.at(caret), '7') << text;
}
