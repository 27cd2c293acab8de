// SPDX-License-Identifier: MIT
// Every file that is shipped in scenes/ is read by its own reader without a complaint.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "scene/swallow_file.h"

using namespace swallowclip;
namespace fs = std::filesystem;

namespace {
const fs::path kScenes = fs::path(SWALLOWCLIP_SOURCE_DIR) / "scenes";
}  // namespace

TEST(Scenes, EverySwallowLoads) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(kScenes / "swallows")) {
    if (entry.path().extension() != ".json") continue;
    names.insert(entry.path().stem().string());
    const auto swallow = scene::loadSwallow(entry.path());
    EXPECT_TRUE(swallow) << (swallow ? "" : swallow.error().text());
  }
  for (const char* expected : {"normal", "c04-s0", "c04-s1", "c04-s2", "c04-s3", "c04-s4"})
    EXPECT_TRUE(names.contains(expected)) << expected;
}
