// SPDX-License-Identifier: MIT
// Charts: round numbers along the axes, two files that are what they say, the same bytes twice.
#include "plot/chart.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/file.h"
#include "plot/axis.h"
#include "scratch.h"

using namespace swallowclip;

TEST(Ticks, AreRoundAndEncloseTheData) {
  const plot::Ticks t = plot::niceTicks(0.03, 0.97, 5);
  EXPECT_DOUBLE_EQ(t.low, 0);
  EXPECT_DOUBLE_EQ(t.high, 1);
  ASSERT_EQ(t.values.size(), 6u);
  EXPECT_NEAR(t.values[1], 0.2, 1e-15);
}

TEST(Ticks, BearAnyRange) {
  for (const auto& [low, high] : {std::pair{0.0, 0.0},
                                  {5.0, 5.0},
                                  {-3.0, -3.0},
                                  {1.0, -1.0},
                                  {1e-9, 2e-9},
                                  {-1e12, 1e12},
                                  {double(NAN), 1.0}}) {
    const plot::Ticks t = plot::niceTicks(low, high, 6);
    EXPECT_LT(t.low, t.high);
    EXPECT_GE(t.values.size(), 2u);
    EXPECT_LT(t.values.size(), 20u);
  }
}

TEST(Ticks, TextHasTheDecimalsOfItsStep) {
  EXPECT_EQ(plot::tickText(0.30000000000000004, 0.1), "0.3");
  EXPECT_EQ(plot::tickText(-1e-18, 0.1), "0.0");
  EXPECT_EQ(plot::tickText(1500, 500), "1500");
}

TEST(Chart, IsWrittenAsSvgAndPngAlikeTwice) {
  plot::Chart chart{"a < b & c",
                    "time (s)",
                    "speed (mm/s)",
                    {{"reference", {{0, 0}, {1, 1}, {2, NAN}, {3, 9}}, false, -1},
                     {"measured", {{0, 0.1}, {1, 0.9}}, true, -1}},
                    400,
                    300};
  const test::Scratch folder;
  for (const char* name : {"a", "b"}) {
    ASSERT_TRUE(plot::writeSvg(chart, folder.path() / (std::string(name) + ".svg")));
    ASSERT_TRUE(plot::writePng(chart, folder.path() / (std::string(name) + ".png")));
  }
  const std::string svg = readFile(folder.path() / "a.svg").value();
  const std::string png = readFile(folder.path() / "a.png").value();
  EXPECT_NE(svg.find("<svg"), std::string::npos);
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_EQ(svg, readFile(folder.path() / "b.svg").value());
  EXPECT_EQ(png, readFile(folder.path() / "b.png").value());
}

TEST(Chart, WithoutPointsIsStillAPicture) {
  const test::Scratch folder;
  EXPECT_TRUE(plot::writePng({}, folder.path() / "empty.png"));
}
