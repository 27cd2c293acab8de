// SPDX-License-Identifier: MIT
#include "core/error.h"

#include <gtest/gtest.h>

#include "core/digest.h"

using namespace swallowclip;

TEST(NearestName, FindsTypingErrorsAndNothingElse) {
  const std::vector<std::string> known{"oblique", "ap", "si", "lateral", "fluoro", "fluoro-ap"};
  EXPECT_EQ(nearestName("obliqe", known), "oblique");
  EXPECT_EQ(nearestName("latreal", known), "lateral");
  EXPECT_EQ(nearestName("fluoroap", known), "fluoro-ap");
  EXPECT_EQ(nearestName("ap", known), "ap");
  EXPECT_EQ(nearestName("zygomatic", known), "");
  EXPECT_EQ(nearestName("oblique", {}), "");
}

TEST(Error, TextHasPlaceProblemAndRemedy) {
  const auto error = usageError("scene.json:3:7", "unknown key", "Remove it.");
  EXPECT_EQ(error.error().text(), "scene.json:3:7: unknown key\n  Remove it.");
  EXPECT_EQ((Error{ErrorKind::failed, "", "no space", ""}).text(), "no space");
}

TEST(CheckDeathTest, PrintsBothValues) {
  const int gap = 3, limit = 2;
  EXPECT_DEATH(CHECK_LT(gap, limit), "gap < limit \\(3 vs 2\\)");
}

TEST(Digest, KnownAnswers) {
  // FIPS 180-2, appendix B.1, and the empty message.
  EXPECT_EQ(sha256Hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256Hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(stateDigest("swallow", 7), stateDigest("swallow", 7));
  EXPECT_NE(stateDigest("swallow", 7), stateDigest("swallov", 7));
  EXPECT_NE(stateDigest("swallow", 7), stateDigest("swallow", 7, 1));
}
