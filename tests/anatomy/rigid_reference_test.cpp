// SPDX-License-Identifier: MIT
// Midsagittal sections of the default scene against those of real people (facts only; the reference
// folder is no part of the repository, so without it the tests are skipped).
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <limits>

#include "anatomy/anatomy_builder.h"
#include "reference.h"
#include "scene/anatomy_file.h"
#include "scene/json_reader.h"
#include "section.h"

namespace swallowclip::anatomy {
namespace {

using test::distance_mm;
using test::referenceFolder;
using test::section;
using test::Segment;

Anatomy adult() {
  auto def = scene::loadAnatomyDef(SWALLOWCLIP_SOURCE_DIR "/scenes/adult/anatomy.json");
  EXPECT_TRUE(def) << def.error().text();
  auto built = def ? buildRigidParts(*def) : Result<Anatomy>(Anatomy{});
  EXPECT_TRUE(built) << built.error().text();
  return built ? *built : Anatomy{};
}

TEST(RigidReference, MidsagittalSectionsLieNearRealOnes) {
  const auto path = referenceFolder() / "profiles.json";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no reference folder at " << path;
  auto file = scene::JsonFile::load(path);
  ASSERT_TRUE(file) << file.error().text();
  const Anatomy anatomy = adult();
  struct Case {
    const char *set, *profile, *structure;
  };
  for (const Case& c :
       {Case{"ql2", "mandible_symphysis", "mandible"},
        Case{"cbct", "mandible_symphysis", "mandible"}, Case{"ql2", "hyoid_body", "hyoid"},
        Case{"cbct", "hyoid_body", "hyoid"}, Case{"ql2", "thyroid_lamina", "thyroid"},
        Case{"ql2", "cricoid_arch", "cricoid"}, Case{"ql2", "cricoid_lamina", "cricoid"},
        Case{"ql2", "epiglottis_cartilage_outline", "epiglottis"},
        Case{"ql2", "hard_palate_nasal_floor", "maxilla"}, Case{"cbct", "C2_body", "c2"},
        Case{"cbct", "C3_body", "c3"}, Case{"cbct", "C4_body", "c4"}, Case{"cbct", "C5_body", "c5"},
        Case{"cbct", "C6_body", "c6"}}) {
    const auto points =
        file->root().object("midsagittal").object(c.set).object(c.profile).points2("points_yz");
    ASSERT_FALSE(points.empty()) << c.profile;
    const auto segments = section(anatomy.find(c.structure)->mesh, 1e-7);
    double sum = 0;
    for (const Vec2& p : points) sum += distance_mm(p, segments);
    const double mean = sum / static_cast<double>(points.size());
    RecordProperty(std::string(c.set) + "_" + c.profile, std::to_string(mean));
    EXPECT_LT(mean, 6) << c.set << " " << c.profile;  // mm; the two people differ by 3-6
  }
}

TEST(RigidReference, LandmarksLieNearRealOnes) {
  const auto path = referenceFolder() / "landmarks.json";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no reference folder at " << path;
  auto file = scene::JsonFile::load(path);
  ASSERT_TRUE(file) << file.error().text();
  const Anatomy anatomy = adult();
  const auto sets = file->root().object("landmarks");
  int compared = 0;
  for (const auto& [name, at] : anatomy.landmarks) {
    double nearest = std::numeric_limits<double>::max();
    for (const char* set : {"ql2", "cbct"})
      if (sets.object(set).has(name))
        nearest = std::min(nearest, (sets.object(set).object(name).vec3("xyz") - at * 1e3).norm());
    if (nearest == std::numeric_limits<double>::max()) continue;
    ++compared;
    EXPECT_LT(nearest, 8) << name;  // mm
  }
  EXPECT_GT(compared, 45);
}
}  // namespace
}  // namespace swallowclip::anatomy
