// SPDX-License-Identifier: MIT
#include "plot/figure.h"

#include <gtest/gtest.h>

#include "core/file.h"
#include "scratch.h"

namespace swallowclip::plot {
namespace {
Figure sample() {
  Figure f;
  f.title = "A figure", f.xLabel = "time (s)", f.marks = {{0.5, "LVC"}, {0.51, "UESO"}};
  f.panels.push_back(
      {.bands = {{"velum", 0.2, 0.8, 0, "0.60 s"}, {"larynx", 0.4, 0.42, 1, "short"}}});
  f.panels.push_back({.title = "Ways",
                      .yLabel = "mm",
                      .series = {{"up", {{0, 0}, {0.5, NAN}, {1, 12}}, false, -1}},
                      .levels = {{8, "cut"}},
                      .markers = true});
  f.panels.push_back({.title = "Left", .yLabel = "mL", .amounts = {{"tongue", 0, "none", 0}}});
  return f;
}

TEST(Figure, SameFigureSameBytesInBothForms) {
  test::Scratch folder;
  for (const char* name : {"a.svg", "a.png"}) {
    const auto file = folder / name;
    ASSERT_TRUE(writeFigure(sample(), file));
    const std::string once = readFile(file).value();
    ASSERT_TRUE(writeFigure(sample(), file));
    EXPECT_EQ(once, readFile(file).value()) << name;
    EXPECT_GT(once.size(), 2000u);
  }
}

TEST(Figure, TallEnoughForItsPanels) {
  Figure f = sample();
  const int before = f.height_px();
  f.panels[1].height_px += 100;
  EXPECT_EQ(f.height_px(), before + 100);
}

TEST(Figure, OtherEndingsAreRefused) {
  test::Scratch folder;
  const auto done = writeFigure(sample(), folder / "a.jpg");
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().text().find(".svg or .png"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.jpg"));
}
}  // namespace
}  // namespace swallowclip::plot
