// SPDX-License-Identifier: MIT
#include "pipeline/confirm.h"

#include <gtest/gtest.h>

namespace swallowclip::pipeline {
namespace {
scoring::Metrics measured(std::optional<bool> confirmed, std::string reason) {
  scoring::Metrics m;
  m.labelConfirmed = confirmed;
  m.labelReason = std::move(reason);
  return m;
}

TEST(Confirm, OnlyAConfirmedScoreIsPublished) {
  frame::Meta meta;
  meta.component = 15, meta.score = 2;
  EXPECT_TRUE(confirm(meta, measured(true, "as intended")).publish);
  const Confirmation other = confirm(meta, measured(false, "meant to show 15-2, measured 3"));
  EXPECT_FALSE(other.publish);
  EXPECT_NE(other.reason.find("measured 3"), std::string::npos);
  EXPECT_FALSE(confirm(meta, measured({}, "no bolus")).publish) << "unmeasured is unproved";
}

TEST(Confirm, ASwallowWithoutIntendedScoreStandsForItself) {
  frame::Meta meta;
  EXPECT_TRUE(confirm(meta, measured({}, "")).publish);
  meta.component = 4;
  EXPECT_TRUE(confirm(meta, measured({}, "")).publish);
}

TEST(Confirm, RejectedClipsLieAside) {
  EXPECT_EQ(placeFor({true, ""}, "out/c15"), "out/c15");
  EXPECT_EQ(placeFor({false, ""}, "out/c15"), "out/c15/rejected");
}
}  // namespace
}  // namespace swallowclip::pipeline
