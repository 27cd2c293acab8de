// SPDX-License-Identifier: MIT
// Events files: JSON and the tables of spreadsheets say the same; every mistake is named.
#include "overlay/marks.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "overlay/demo.h"
#include "scratch.h"

namespace swallowclip::overlay {
namespace {
study::StudyInfo study100() {
  study::StudyInfo s;
  s.width = 640;
  s.height = 480;
  for (int k = 0; k < 100; ++k) s.time_s.push_back(k / 30.0);
  return s;
}

Result<Marks> read(const std::string& text) {
  test::Scratch scratch;
  EXPECT_TRUE(writeFile(scratch / "DOE^JOHN.txt", text));
  return loadMarks(scratch / "DOE^JOHN.txt", study100());
}

const char* kJson = R"({"version": 1, "facing": "left",
  "events": {"BPM": 30, "hyb": 31, "UESC": 50},
  "landmarks": [{"name": "C2 anterior inferior", "x_px": 300.5, "y_px": 200},
                {"name": "C4_anterior_inferior", "frame": 7, "x_px": 310, "y_px": 320}],
  "calibration": {"from_px": [10, 10], "to_px": [10, 80], "length_mm": 25}})";
}  // namespace

TEST(Marks, JsonAndTablesAgree) {
  const char* comma =
      "\xef\xbb\xbfkind,name,frame,x_px,y_px,note\r\nevent,BPM,30,,,\r\nevent,\"hyb\",31,,,\r\n\r\n"
      "event,UESC,50,,,\"said, \"\"late\"\"\"\r\nlandmark,C2 anterior inferior,,300.5,200,\r\n"
      "landmark,C4_anterior_inferior,7,310,320,\r\ncalibration,25,,10,10,\r\n"
      "calibration,25,,10,80,\r\n";
  const char* semicolon =
      "Kind;Frame;Name;X;Y\nEvent;30;BPM;;\nevent;31;HYB;;\nevent;50;UESC;;\n"
      "landmark;;C2-anterior-inferior;300,5;200\nlandmark;7;C4 anterior inferior;310;320\n"
      "calibration;;25;10;10\ncalibration;;25,0;10;80\n";
  for (const char* text : {kJson, comma, semicolon}) {
    auto marks = read(text);
    ASSERT_TRUE(marks) << marks.error().text();
    ASSERT_EQ(marks->events.size(), 3u);
    EXPECT_EQ(marks->events[1].name, "HYB");
    EXPECT_EQ(marks->events[1].frame, 31);
    ASSERT_EQ(marks->points.size(), 2u);
    EXPECT_EQ(marks->points[0].name, "C2_anterior_inferior");
    EXPECT_FALSE(marks->points[0].frame);
    EXPECT_DOUBLE_EQ(marks->points[0].at_px.x(), 300.5);
    EXPECT_EQ(marks->points[1].frame, 7);
    ASSERT_TRUE(marks->calibration);
    EXPECT_NEAR(marks->calibration->pixelsPerMetre(), 2800, 1e-9);
  }
}

TEST(Marks, TheSchemaKnowsTheSameNames) {
  const auto text =
      readFile(std::filesystem::path(SWALLOWCLIP_SOURCE_DIR) / "docs/study.events.schema.json");
  ASSERT_TRUE(text);
  const nlohmann::json schema = nlohmann::json::parse(*text)["properties"];
  std::vector<std::string> events;
  for (const auto& [name, unused] : schema["events"]["properties"].items()) events.push_back(name);
  std::vector<std::string> known = eventNames();
  std::ranges::sort(known);
  EXPECT_EQ(events, known);
  const nlohmann::json landmarks = schema["landmarks"]["items"]["properties"]["name"]["enum"];
  EXPECT_EQ(landmarks.get<std::vector<std::string>>(), landmarkNames());
}

TEST(Marks, WrittenOnesAreReadBack) {
  auto marks = read(kJson);
  ASSERT_TRUE(marks);
  auto again = read(marksText(*marks));
  ASSERT_TRUE(again) << again.error().text();
  EXPECT_EQ(again->events.size(), marks->events.size());
  EXPECT_EQ(again->points[1].frame, marks->points[1].frame);
}

TEST(Marks, MistakesAreNamed) {
  const auto events = [](const std::string& list) {
    return R"({"version": 1, "events": {)" + list + "}}";
  };
  const auto landmarks = [](const std::string& list) {
    return R"({"version": 1, "events": {"BPM": 3}, "landmarks": [)" + list + "]}";
  };
  const std::pair<std::string, std::string> cases[] = {
      {events(R"("BPM": 40, "UESC": 30)"), "BPM at frame 40 comes after UESC at frame 30"},
      {events(R"("BPM": 100)"), "frames 0 to 99"},
      {events(R"("BPM": 1.5)"), "whole frame number"},
      {events(R"("BPN": 3)"), "unknown event"},
      {events(R"("BPM": 3, "bpm": 4)"), "marked twice"},
      {events(""), "no event is marked"},
      {landmarks(
           R"({"name": "ANS", "x_px": 5, "y_px": 5}, {"name": "PNS", "x_px": 5, "y_px": 5.2})"),
       "ANS and PNS lie on one spot"},
      {landmarks(R"({"name": "ANS", "x_px": 700, "y_px": 5})"), "outside the picture"},
      {landmarks(R"({"name": "ANS", "frame": 100, "x_px": 7, "y_px": 5})"), "frames 0 to 99"},
      {landmarks(R"({"name": "ANS", "x_px": 7})"), "y_px"},
      {"kind,name,frame\nevent,BPM,\n", "an event without a frame"},
      {"kind,name,frame\nevent,BPM,3.5\n", "no whole number"},
      {"kind,name,frame\nsight,BPM,3\n", "unknown kind"},
      {"kind,name,frame\nevent,HYB,2\nevent,BPN,3\n", "row 3: an unknown event"},
      {"a,b\n1,2\n", "must name the columns"},
      {"kind,name,frame,x,y\nevent,BPM,3\ncalibration,20,,1,1\n", "one end of a calibration"},
      {R"({"version": 2, "events": {"BPM": 3}})", "version"},
      {"{", "events file"},
      {"", "must name the columns"},
  };
  for (const auto& [text, expected] : cases) {
    auto marks = read(text);
    ASSERT_FALSE(marks) << text;
    EXPECT_NE(marks.error().text().find(expected), std::string::npos)
        << marks.error().text() << " for " << text;
    EXPECT_EQ(marks.error().text().find("DOE"), std::string::npos) << marks.error().text();
  }
}

TEST(Marks, TextOfTheFileIsNotQuoted) {
  for (const char* text :
       {R"({"version": 1, "patient": "DOE^JOHN", "events": {"BPM": 3}})",
        R"({"version": 1, "events": {"BPM": "DOE^JOHN"}})", "kind,name,frame\nevent,DOE^JOHN,3\n",
        "kind,name,frame\nDOE^JOHN,BPM,3\n", "DOE^JOHN,b\n"}) {
    auto marks = read(text);
    ASSERT_FALSE(marks) << text;
    EXPECT_EQ(marks.error().text().find("DOE"), std::string::npos) << marks.error().text();
  }
}
}  // namespace swallowclip::overlay
