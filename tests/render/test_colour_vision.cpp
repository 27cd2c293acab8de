// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "render/colour_vision.h"

namespace swallowclip::render {
namespace {

TEST(ColourDifference, MatchesThePublishedPairs) {
  // Sharma, Wu & Dalal 2005, table 1
  const struct {
    Vec3 a, b;
    double expected;
  } pairs[] = {{{50, 2.6772, -79.7751}, {50, 0, -82.7485}, 2.0425},
               {{50, -1.3802, -84.2814}, {50, 0, -82.7485}, 1.0000},
               {{50, 2.5, 0}, {73, 25, -18}, 27.1492},
               {{50, 2.5, 0}, {58, 24, 15}, 19.4535},
               {{60.2574, -34.0099, 36.2677}, {60.4626, -34.1751, 39.4387}, 1.2644},
               {{2.0776, 0.0795, -1.1350}, {0.9033, -0.0636, -0.5514}, 0.9082}};
  for (const auto& p : pairs) {
    EXPECT_NEAR(ciede2000(p.a, p.b), p.expected, 1e-4);
    EXPECT_NEAR(ciede2000(p.b, p.a), p.expected, 1e-4);
  }
  EXPECT_EQ(colourDifference({0.3f, 0.5f, 0.1f}, {0.3f, 0.5f, 0.1f}), 0);
  EXPECT_NEAR(colourDifference({0, 0, 0}, {1, 1, 1}), 100, 0.1);
}

TEST(ColourVision, GreysStayAndConfusedColoursMeet) {
  for (const Vision v : kVisions)
    for (float g : {0.1f, 0.5f, 0.9f})
      EXPECT_LT((seenBy(v, Colour::Constant(g)) - Colour::Constant(g)).norm(), 0.01) << name(v);
  // a red and a green of one protan or deutan confusion line come close, to others they do not
  const Colour red(0.70f, 0.45f, 0.30f), green(0.40f, 0.55f, 0.28f);
  const double apart = colourDifference(red, green);
  EXPECT_GT(apart, 25);
  EXPECT_LT(colourDifference(seenBy(Vision::protan, red), seenBy(Vision::protan, green)),
            0.6 * apart);
  EXPECT_LT(colourDifference(seenBy(Vision::deutan, red), seenBy(Vision::deutan, green)),
            0.6 * apart);
  EXPECT_GT(colourDifference(seenBy(Vision::tritan, red), seenBy(Vision::tritan, green)),
            0.7 * apart);
}
}  // namespace
}  // namespace swallowclip::render
