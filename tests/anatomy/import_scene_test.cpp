// SPDX-License-Identifier: MIT
// mapping.json, imported scenes on disk, and the reference meshes where they are at hand.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

#include "core/file.h"
#include "reference.h"
#include "scene/mapping_file.h"

namespace swallowclip {
namespace {
namespace fs = std::filesystem;
using namespace anatomy;

class ImportScene : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder = fs::temp_directory_path() /
             fmt::format("swallowclip_import_scene_{}_{}", info->name(), ::getpid());
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }
  fs::path write(const std::string& name, const std::string& text) {
    EXPECT_TRUE(writeFile(folder / name, text).has_value());
    return folder / name;
  }
  std::string mappingError(const std::string& text) {
    const auto r = scene::loadMapping(write("mapping.json", text));
    return r ? "no error" : r.error().text();
  }
  fs::path folder;
};

const char* kBox =
    "v -10 -10 -10\nv 10 -10 -10\nv 10 10 -10\nv -10 10 -10\nv -10 -10 10\nv 10 -10 10\nv 10 10 "
    "10\n"
    "v -10 10 10\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
const char* kMapping = R"({"unit": "mm", "axes": {"x": "right", "y": "anterior", "z": "superior"},
  "rate_hz": 30, "landmarks_mm": {"menton": [0, -39.4, -70.1]}, "structures": [
  {"file": "box.obj", "structure": "hyoid", "material": "bone", "kind": "rigid"},
  {"file": "t_%02d.obj", "structure": "tongue", "material": "muscle", "kind": "wall"}]})";

TEST_F(ImportScene, MappingSaysWhatItMeans) {
  const auto def = scene::loadMapping(write("mapping.json", kMapping));
  ASSERT_TRUE(def) << def.error().text();
  EXPECT_EQ(def->unit, LengthUnit::mm);
  EXPECT_FALSE(def->axes.guess);
  EXPECT_EQ(def->axes.oursFromFile, Mat3(Vec3(-1, -1, 1).asDiagonal()));
  EXPECT_EQ(def->structures[0].carrier, Carrier::hyoid);
  EXPECT_EQ(def->structures[0].closure, SurfaceClosure::requireClosed);
  EXPECT_FALSE(def->structures[1].rigid);
  EXPECT_NEAR(def->landmarks.at("menton").z(), -0.0701, 1e-12);
}

TEST_F(ImportScene, WrongMappingsAreLocated) {
  EXPECT_NE(
      mappingError(R"({"structures": [{"file": "../x.obj", "structure": "a", "kind": "rigid"}]})")
          .find("inside the source folder"),
      std::string::npos);
  EXPECT_NE(mappingError(R"({"axis": 1, "structures": []})").find("axes"), std::string::npos);
  EXPECT_NE(
      mappingError(R"({"axes": {"x": "left", "y": "right", "z": "superior"}, "structures": []})")
          .find("same direction"),
      std::string::npos);
  EXPECT_NE(
      mappingError(R"({"structures": [{"file": "a%s.obj", "structure": "a", "kind": "rigid"}]})")
          .find("no pattern"),
      std::string::npos);
  EXPECT_NE(mappingError(R"({"structures": [{"file": "a.obj", "structure": "a", "kind": "rigd"}]})")
                .find("mapping.json:1:"),
            std::string::npos);
  EXPECT_NE(mappingError(R"({"structures": [{"file": "a.obj", "structure": "a", "kind": "rigid"},
      {"file": "b.obj", "structure": "a", "kind": "rigid"}]})")
                .find("twice"),
            std::string::npos);
}

TEST_F(ImportScene, SavedSceneComesBackExactlyAndSavesToTheSameBytes) {
  write("box.obj", kBox);
  write("t_00.obj", kBox);
  write("t_01.obj", kBox);
  const auto made = scene::importScene(folder, write("mapping.json", kMapping), folder / "mine");
  ASSERT_TRUE(made) << made.error().text();
  EXPECT_TRUE(scene::isImportedScene(folder / "mine"));
  const auto back = scene::loadImportedScene(folder / "mine");
  ASSERT_TRUE(back) << back.error().text();
  ASSERT_EQ(back->anatomy.structures.size(), 2u);
  for (int k = 0; k < 2; ++k) {
    const Structure &a = made->anatomy.structures[k], &b = back->anatomy.structures[k];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.material, b.material);
    EXPECT_EQ(a.rigid, b.rigid);
    EXPECT_EQ(a.carrier, b.carrier);
    EXPECT_EQ(a.mesh.positions, b.mesh.positions);
    EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  }
  ASSERT_EQ(back->sequences.size(), 1u);
  EXPECT_EQ(back->sequences[0].frames, made->sequences[0].frames);
  EXPECT_EQ(back->report, made->report);
  EXPECT_EQ(back->rate_hz, 30);
  const auto first = readFile(folder / "mine/scene.json");
  ASSERT_TRUE(scene::saveImportedScene(*back, folder / "again"));
  EXPECT_EQ(*first, *readFile(folder / "again/scene.json"));
}

TEST_F(ImportScene, AFailedImportLeavesTheFormerSceneAndANewOneReplacesIt) {
  write("box.obj", kBox);
  write("t_00.obj", kBox);
  const fs::path mapping = write("mapping.json", kMapping), mine = folder / "mine";
  ASSERT_TRUE(scene::importScene(folder, mapping, mine));
  write("t_01.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_FALSE(scene::importScene(folder, mapping, mine));
  ASSERT_TRUE(scene::loadImportedScene(mine));
  write("t_01.obj", kBox);
  ASSERT_TRUE(scene::importScene(folder, mapping, mine));
  int meshFolders = 0;
  for (const auto& e : fs::directory_iterator(mine)) meshFolders += e.is_directory();
  EXPECT_EQ(meshFolders, 1);
  // a mesh cut short is told, not drawn
  for (const auto& e : fs::recursive_directory_iterator(mine))
    if (e.path().filename() == "hyoid.ply") fs::resize_file(e.path(), 300);
  const auto broken = scene::loadImportedScene(mine);
  ASSERT_FALSE(broken);
  EXPECT_NE(broken.error().text().find("hyoid.ply"), std::string::npos);
}

TEST_F(ImportScene, AScenesOwnMeshesCanBeImportedAgain) {
  write("box.obj", kBox);
  write("t_00.obj", kBox);
  ASSERT_TRUE(scene::importScene(folder, write("mapping.json", kMapping), folder / "mine"));
  fs::path ply;
  for (const auto& e : fs::recursive_directory_iterator(folder / "mine"))
    if (e.path().filename() == "hyoid.ply") ply = e.path();
  const auto mapping = write("again.json", R"({"unit": "m", "axes": {"x": "left", "y": "posterior",
      "z": "superior"}, "structures": [{"structure": "hyoid", "kind": "rigid"}]})");
  const auto def = scene::loadMapping(mapping);
  ASSERT_TRUE(def) << def.error().text();
  const auto back = importMeshes(ply, *def);
  ASSERT_TRUE(back) << back.error().text();
  EXPECT_EQ(back->anatomy.structures[0].mesh.positions.size(), 8u);
  EXPECT_NEAR(volume(back->anatomy.structures[0].mesh), 8e-6, 1e-11);
}

// ---- real meshes: two adults outside the repository ----

fs::path referenceFolder() {
  return test::referenceFolder() / "meshes";
}
fs::path referenceMapping() {
  return fs::path(SWALLOWCLIP_SOURCE_DIR) / "tests/fixtures/reference_mapping.json";
}

TEST_F(ImportScene, ReferenceMappingIsSound) {
  const auto def = scene::loadMapping(referenceMapping());
  ASSERT_TRUE(def) << def.error().text();
  EXPECT_EQ(def->structures.size(), 26u);
}

TEST_F(ImportScene, ReferenceMeshesBecomeAScene) {
  if (!fs::exists(referenceFolder())) GTEST_SKIP() << "no folder " << referenceFolder();
  const auto made = scene::importScene(referenceFolder(), referenceMapping(), folder / "mine");
  ASSERT_TRUE(made) << made.error().text();
  for (const std::string& line : made->report) RecordProperty("report", line);
  const auto back = scene::loadImportedScene(folder / "mine");
  ASSERT_TRUE(back) << back.error().text();
  ASSERT_EQ(back->anatomy.structures.size(), 26u);
  struct Expected {
    const char* name;
    std::size_t triangles;  // of the file
    double volume_cm3;      // of the pack's own table, 0 where open
  };
  for (const auto& [name, triangles, volume_cm3] : {Expected{"mandible", 4184, 67.0},
                                                    {"maxilla", 5808, 0},
                                                    {"hyoid", 662, 1.8},
                                                    {"cricoid", 458, 4.3},
                                                    {"epiglottis", 588, 1.0},
                                                    {"tongue", 736, 102.3},
                                                    {"soft_palate", 7570, 17.2},
                                                    {"c2", 4498, 20.4},
                                                    {"c6", 4498, 14.6}}) {
    const Structure* s = back->anatomy.find(name);
    ASSERT_TRUE(s) << name;
    EXPECT_EQ(s->mesh.triangles.size(), triangles) << name;
    if (volume_cm3 == 0) continue;
    EXPECT_TRUE(checkManifold(s->mesh.triangles, int(s->mesh.positions.size())).closed()) << name;
    EXPECT_NEAR(volume(s->mesh) * 1e6, volume_cm3, 0.06) << name;
  }
  EXPECT_TRUE(back->anatomy.find("maxilla")->drawOnly);
  for (const Structure& s : back->anatomy.structures)
    EXPECT_TRUE(s.drawOnly ||
                checkManifold(s.mesh.triangles, int(s.mesh.positions.size())).closed())
        << s.name;
  ASSERT_EQ(back->sequences.size(), 1u);
  EXPECT_EQ(back->sequences[0].frames.size(), 5u);
}

TEST_F(ImportScene, ReferenceUnitAndAxesAreGuessedRight) {
  if (!fs::exists(referenceFolder())) GTEST_SKIP() << "no folder " << referenceFolder();
  auto def = scene::loadMapping(referenceMapping());
  ASSERT_TRUE(def);
  def->unit = LengthUnit::guess;
  def->axes.guess = true;
  for (auto& s : def->structures) s.half = HalfSide::guess;
  const auto made = importMeshes(referenceFolder(), *def);
  ASSERT_TRUE(made) << made.error().text();
  EXPECT_NE(made->report[0].find("unit mm guessed"), std::string::npos) << made->report[0];
  EXPECT_EQ(made->report[1], "axes guessed: x is left, y is posterior, z is superior");
  for (const std::string& line : made->report)
    EXPECT_EQ(line.find("half"), std::string::npos) << line;  // none of them is one
}

TEST_F(ImportScene, AllBonyReferenceMeshesOfBothAdults) {
  if (!fs::exists(referenceFolder())) GTEST_SKIP() << "no folder " << referenceFolder();
  ImportDef def;
  def.unit = LengthUnit::mm;
  def.axes.guess = false;
  for (const auto& entry : fs::directory_iterator(referenceFolder())) {
    const std::string stem = entry.path().stem().string();
    const std::string part = stem.substr(stem.find('_') + 1);
    const bool soft = part.starts_with("tongue") || part.starts_with("soft") ||
                      part.starts_with("airway") || part.starts_with("face") ||
                      part.starts_with("constrictor") || part.starts_with("larynx") ||
                      part.starts_with("pharynx");
    if (entry.path().extension() != ".obj" || soft) continue;
    ImportStructureDef s;
    s.files = {entry.path().filename().string()};
    s.name = part + "_" + stem.substr(0, stem.find('_'));
    s.half = HalfSide::whole;
    s.closure = part.starts_with("maxilla") ? SurfaceClosure::drawOnly : SurfaceClosure::repair;
    def.structures.push_back(s);
  }
  ASSERT_EQ(def.structures.size(), 30u);
  const auto made = importMeshes(referenceFolder(), def);
  ASSERT_TRUE(made) << made.error().text();
  int closed = 0;
  for (const Structure& s : made->anatomy.structures)
    closed += checkManifold(s.mesh.triangles, int(s.mesh.positions.size())).closed();
  EXPECT_EQ(closed, 27);  // all but the three open maxillae
}
}  // namespace
}  // namespace swallowclip
