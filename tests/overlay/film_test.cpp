// SPDX-License-Identifier: MIT
// Clocks and panes of the clip, and the whole command on a study with planted identifiers.
#include "overlay/film.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/file.h"
#include "run.h"
#include "scratch.h"
#include "study/studies.h"
#include "video/png.h"

namespace swallowclip::overlay {
namespace {
study::StudyInfo evenStudy(int frames, double rate_hz) {
  study::StudyInfo s;
  s.width = 320;
  s.height = 240;
  for (int k = 0; k < frames; ++k) s.time_s.push_back(k / rate_hz);
  return s;
}

}  // namespace

TEST(Film, OutputRateShowsEveryFrameEquallyLong) {
  const std::tuple<double, int, int> cases[] = {{30, 30, 1}, {15, 30, 1},   {25, 50, 1},
                                                {10, 30, 1}, {12.5, 75, 2}, {30000.0 / 1001, 30, 1},
                                                {60, 60, 1}, {7.5, 30, 1}};
  for (const auto& [rate, numerator, denominator] : cases) {
    const Rate r = outputRate(evenStudy(50, rate));
    EXPECT_EQ(r.numerator, numerator) << rate;
    EXPECT_EQ(r.denominator, denominator) << rate;
  }
  study::StudyInfo uneven = evenStudy(50, 30);
  uneven.time_s[20] += 0.012;
  EXPECT_EQ(outputRate(uneven).numerator, 60);
}

TEST(Film, ClockShowsFramesWhenTheyBegin) {
  for (const double rate : {30.0, 15.0, 25.0, 30000.0 / 1001}) {
    const study::StudyInfo s = evenStudy(90, rate);
    const Clock c = makeClock(s);
    EXPECT_EQ(c.studyFrame.front(), 0);
    EXPECT_EQ(c.studyFrame.back(), 89) << rate;
    const int times = static_cast<int>(std::lround(c.rate.hz() / rate));
    for (int f = 0; f < 90; ++f) EXPECT_EQ(c.clipFrameOf[f], f * times) << rate;
  }
}

TEST(Film, PanesFitThePicture) {
  for (const auto layout : {Layout::sideBySide, Layout::superimposed, Layout::both})
    for (std::size_t n = 1; n <= 4; ++n) {
      ComposeDef d;
      d.layout = layout;
      d.views.assign(n, "oblique");
      const auto panes = panesOf(d, 1280, 720, 22);
      EXPECT_EQ(panes.size(), layout == Layout::superimposed ? 1 : n + 1);
      for (const Rectangle& p : panes) {
        EXPECT_EQ(p.width % 2 + p.height % 2, 0);
        EXPECT_TRUE(p.x >= 0 && p.y >= 0 && p.x + p.width <= 1280 && p.y + p.height <= 720);
      }
    }
}

namespace {
constexpr const char* kPlanted = "PLANTED^NAME";

/// A noisy round opening; a white block of "text" in the corner.
Image patientPicture(int k) {
  Image image = study::fluoroPicture(320, 240, k);
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) {
      const bool open = std::hypot(x - 160, y - 120) < 112;
      const auto noise = static_cast<std::uint8_t>((x * 7919 + y * 104729 + k * 1299709) % 23);
      const bool text = x >= 4 && x < 60 && y >= 4 && y < 14 && (x / 3 + y) % 2;
      std::uint8_t* p = image.row(y) + 4 * x;
      const std::uint8_t grey = text   ? 255
                                : open ? static_cast<std::uint8_t>(p[0] / 2 + noise)
                                       : std::uint8_t{3};
      p[0] = p[1] = p[2] = grey;
    }
  return image;
}

/// A DICOM study with the planted words in every tag that dcmodify takes, burned-in text included.
std::string plantedStudy(const test::Scratch& scratch, const std::string& burnedIn) {
  const std::string path = (scratch / "PLANTED^NAME.dcm").string();
  study::DicomDef def;
  def.path = path;
  def.width = 320;
  def.height = 240;
  def.colour = false;
  def.coding = study::DicomCoding::uncompressed;
  auto sink = study::makeDicomSink(def);
  for (int k = 0; k < 40; ++k) EXPECT_TRUE((*sink)->push(patientPicture(k)));
  EXPECT_TRUE((*sink)->finish());
  std::string command = "dcmodify -nb -ie";
  for (const char* tag :
       {"0010,0010", "0010,0020", "0010,1001", "0010,1040", "0010,2154", "0010,21b0", "0010,4000",
        "0008,0050", "0008,0080", "0008,0081", "0008,0090", "0008,1030", "0008,103e", "0008,1048",
        "0008,1050", "0008,1070", "0008,2111", "0018,1000", "0018,1030", "0020,0010", "0020,4000",
        "0032,1032", "0032,4000", "0040,0006", "0040,0254", "0088,0140"})
    command += fmt::format(" -i '({})={}'", tag, kPlanted);
  command += " -i '(0010,0030)=19450508' -m '(0028,0301)=" + burnedIn + "'";
  int status = 0;
  const std::string said = study::output(command + " '" + path + "'", &status);
  EXPECT_EQ(status, 0) << said;
  return path;
}

void expectNowhere(const std::string& text, const std::string& where) {
  for (const char* word : {"PLANTED", "19450508"})
    EXPECT_EQ(text.find(word), std::string::npos) << word << " in " << where;
}
}  // namespace

// Acceptance: planted identifiers are found nowhere; unmasked burned-in text is refused.
TEST(Privacy, PlantedIdentifiersAreFoundNowhere) {
  if (!study::hasProgram("dcmodify")) GTEST_SKIP() << "dcmtk is not installed";
  test::Scratch scratch, temporary;
  for (const char* says : {"YES", ""}) {
    pipeline::RunOptions o = options(scratch);
    o.overlay.vf = plantedStudy(scratch, says);
    o.out = scratch / "sheets";
    Said said;
    const auto refused = events(o, said);
    ASSERT_FALSE(refused) << says;
    EXPECT_NE(refused.error().text().find("burned into its pixels"), std::string::npos);
    expectNowhere(refused.error().text() + said.lines, "a refusal");
  }
  pipeline::RunOptions o = options(scratch);
  o.overlay.vf = plantedStudy(scratch, "YES");
  o.overlay.masks = {{0, 0, 70, 20}};
  o.overlay.events = scratch / "PLANTED^NAME.events.json";
  o.component = 4;
  o.scores = {0};
  o.overlay.dicom = true;
  o.overlay.layout = "superimposed";
  ASSERT_TRUE(writeFile(o.overlay.events, R"({"version": 1, "events": {"HYB": 15, "UESC": 32},
    "landmarks": [{"name": "C2_anterior_inferior", "x_px": 200, "y_px": 90},
                  {"name": "C4_anterior_inferior", "x_px": 205, "y_px": 180}]})"));
  std::filesystem::create_directories(scratch / "out");
  o.out = scratch / "out";
  o.overlay.out = scratch / "out/clip.mp4";
  Said said;
  auto done = events(o, said);
  ASSERT_TRUE(done) << done.error().text();
  done = overlay(o, said);
  ASSERT_TRUE(done) << done.error().text();
  expectNowhere(said.lines, "the log");
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(scratch / "out")) {
    expectNowhere(entry.path().filename().string(), "a file name");
    auto bytes = readFile(entry.path());
    ASSERT_TRUE(bytes);
    expectNowhere(*bytes, entry.path().filename().string());
    ++files;
  }
  EXPECT_GE(files, 8);
  // the burned-in block is black in what was handed out pixel for pixel
  auto shown = video::readPng(scratch / "out/landmarks.png");
  ASSERT_TRUE(shown);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 70; ++x) ASSERT_EQ(shown->row(y)[4 * x], 0) << x << ", " << y;
  EXPECT_GT(shown->row(120)[4 * 160], 0);
  // mistakes in such a study are told without naming it
  ASSERT_TRUE(writeFile(o.overlay.vf, readFile(o.overlay.vf)->substr(0, 60000)));
  const auto cut = overlay(o, said);
  ASSERT_FALSE(cut);
  expectNowhere(cut.error().text(), "an error");
}

TEST(Privacy, TheOpeningHidesTextAroundIt) {
  test::Scratch scratch;
  study::DicomDef def;
  def.path = scratch / "study.dcm";
  def.width = 320;
  def.height = 240;
  def.colour = false;
  def.coding = study::DicomCoding::rle;
  auto sink = study::makeDicomSink(def);
  for (int k = 0; k < 30; ++k) ASSERT_TRUE((*sink)->push(patientPicture(k)));
  ASSERT_TRUE((*sink)->finish());
  auto s = study::Study::open({def.path});
  ASSERT_TRUE(s);
  const auto p = study::Protector::make(**s, {});
  ASSERT_TRUE(p) << p.error().text();
  auto image = (*s)->frame(10);
  ASSERT_TRUE(image);
  p->apply(*image);
  for (int y = 0; y < 14; ++y)
    for (int x = 0; x < 60; ++x) ASSERT_EQ(image->row(y)[4 * x], 0);
  // and leaves the opening: within a block of the true circle
  EXPECT_NEAR(p->opening().x, 48, 8);
  EXPECT_NEAR(p->opening().width, 224, 16);
  EXPECT_NEAR(p->opening().height, 224, 16);
  for (int k = 0; k < 360; ++k) {
    const int x = 160 + static_cast<int>(108 * std::cos(k * kPi / 180));
    const int y = 120 + static_cast<int>(108 * std::sin(k * kPi / 180));
    EXPECT_GT(image->row(y)[4 * x], 0) << k;
  }
}
}  // namespace swallowclip::overlay
