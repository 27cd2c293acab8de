// SPDX-License-Identifier: MIT
// The mucosa on palate and alveolar bone of the default scene.
#include "anatomy/oral_mucosa.h"

#include <gtest/gtest.h>

#include "anatomy/anatomy_builder.h"
#include "anatomy/rigid_parts.h"
#include "scene/anatomy_file.h"

namespace swallowclip::anatomy {
namespace {

AnatomyDef adultDef() {
  auto loaded = scene::loadAnatomyDef(SWALLOWCLIP_SOURCE_DIR "/scenes/adult/anatomy.json");
  EXPECT_TRUE(loaded) << loaded.error().text();
  return loaded ? *loaded : AnatomyDef{};
}

TEST(OralMucosa, NeverStandsBeforeTheVaultThatTheTongueCloses) {
  const PalateDef palate = adultDef().palate;
  for (double y = -50e-3; y <= 0; y += 0.37e-3)
    for (double x = -18e-3; x <= 18e-3; x += 0.41e-3) {
      const double recess = palateRecess_m(palate, x, y);
      EXPECT_GT(recess, 0) << "at x " << x << ", y " << y;
      EXPECT_LT(recess, palate.rugaDepth_m + 1e-4);
      EXPECT_EQ(recess, palateRecess_m(palate, -x, y));
    }
}

TEST(OralMucosa, HasItsRugaeAndNoneBehindThem) {
  const PalateDef palate = adultDef().palate;
  const auto crests = [&](double from, double to) {
    int count = 0;
    const auto at = [&](double y) { return palateRecess_m(palate, 5e-3, y); };
    for (double y = from; y < to; y += 0.1e-3)
      count += at(y) < at(y - 0.1e-3) && at(y) <= at(y + 0.1e-3) && at(y) < 0.4e-3;
    return count;
  };
  EXPECT_EQ(crests(-48e-3, -30e-3), static_cast<int>(palate.rugaeY_m.size()));
  EXPECT_EQ(crests(-22e-3, -1e-3), 0);
}

TEST(OralMucosa, GumsCoverTheNecksAndLeaveTheCrowns) {
  const AnatomyDef def = adultDef();
  const auto built = buildRigidParts(def);
  ASSERT_TRUE(built) << built.error().text();
  for (const DentalArchDef& arch : def.arches) {
    const TriMesh& band = built->find(arch.gumName)->mesh;
    const TriMesh& teeth = built->find(arch.name)->mesh;
    double gumEdge = arch.upper ? 0 : -1, tip = gumEdge;
    for (const Vec3& p : band.positions)
      gumEdge = arch.upper ? std::min(gumEdge, p.z()) : std::max(gumEdge, p.z());
    for (const Vec3& p : teeth.positions)
      tip = arch.upper ? std::min(tip, p.z()) : std::max(tip, p.z());
    EXPECT_GT(std::abs(tip - gumEdge), 3e-3) << arch.name;  // crowns stand clear, m
    const auto places = toothPlaces(arch);
    ASSERT_TRUE(places);
    EXPECT_EQ(places->size(), 8u) << arch.name;  // sixteen in an arch
    int covered = 0;
    for (const ToothPlace& place : *places) {
      const Vec3 probe = place.cervix + Vec3(0, 0, (arch.upper ? 1 : -1) * 1e-3);
      covered += windingNumber(probe, band.positions, band.triangles) > 0.5;
    }
    EXPECT_EQ(covered, 8) << arch.name;
  }
}
}  // namespace
}  // namespace swallowclip::anatomy
