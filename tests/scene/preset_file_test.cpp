// SPDX-License-Identifier: MIT
#include "scene/preset_file.h"

#include <gtest/gtest.h>

#include "core/file.h"
#include "scene/file_kind.h"
#include "scene/palette_file.h"

using namespace swallowclip;

namespace {
const std::filesystem::path kPresets =
    std::filesystem::path(SWALLOWCLIP_SOURCE_DIR) / "render_presets";

/// Tests of one file may run side by side: each has its own name.
std::string scratchFile() {
  return ::testing::TempDir() + "preset_file_" +
         ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".json";
}

Result<render::RenderPreset> fromText(const std::string& json) {
  const std::string path = scratchFile();
  EXPECT_TRUE(writeFile(path, json));
  auto preset = scene::loadPreset(kPresets, path);
  std::filesystem::remove(path);
  return preset;
}
std::string with(const std::string& more) {
  return R"({"name": "t", "views": {"v": {"projection": "perspective", "eye_mm": [300, 0, 0],
             "target_mm": [0, 0, -50], "fovY_deg": 20}})" +
         more + "}";
}
std::string problem(const std::string& more) {
  const auto preset = fromText(with(more));
  return preset ? "accepted" : preset.error().text();
}
}  // namespace

TEST(PresetFile, EveryShippedPresetLoads) {
  const auto names = scene::presetNames(kPresets);
  ASSERT_FALSE(names.empty());
  for (const std::string& name : names) {
    const auto preset = scene::loadPreset(kPresets, name);
    ASSERT_TRUE(preset) << preset.error().text();
    EXPECT_EQ(preset->name, name);
    for (const char* view :
         {"oblique", "ap", "si", "lateral", "posterior", "axial", "fluoro", "fluoro-ap"}) {
      ASSERT_TRUE(preset->views.contains(view)) << name << " lacks " << view;
      EXPECT_FALSE(preset->views.at(view).shows.empty()) << name << " " << view;
    }
  }
}

TEST(PresetFile, UnitsAreConverted) {
  const auto preset = fromText(with(
      R"(, "creaseAngle_deg": 90, "sectionOutline_mm": 2, "background": {"top": "#ff0080"},
         "materials": {"muscle": {"roughness": 0.25}},
         "structures": {"tongue": {"like": "muscle", "wetness": 0.5}})"));
  ASSERT_TRUE(preset) << preset.error().text();
  const auto& view = preset->views.at("v");
  EXPECT_NEAR(view.eye_m.x(), 0.3, 1e-12);
  EXPECT_NEAR(view.fovY_rad, 0.34906585, 1e-7);
  EXPECT_NEAR(preset->creaseAngle_rad, 1.5707963, 1e-6);
  EXPECT_NEAR(preset->sectionOutline_m, 2e-3, 1e-9);
  EXPECT_NEAR((preset->background.top_srgb - render::Colour(1, 0, 128 / 255.f)).norm(), 0, 1e-6);
  EXPECT_FLOAT_EQ(preset->structures.at("tongue").roughness, 0.25f);
  EXPECT_FLOAT_EQ(preset->structures.at("tongue").wetness, 0.5f);
  EXPECT_EQ(preset->width, 1280);  // left out: the default
}

TEST(PresetFile, BadValuesAreNamed) {
  EXPECT_EQ(problem(""), "accepted");
  EXPECT_NE(problem(R"(, "fps": 15)").find("\"fps\": 15 is outside 30 to 240"), std::string::npos);
  EXPECT_NE(problem(R"(, "background": {"top": "blue"})").find("not a colour"), std::string::npos);
  EXPECT_NE(problem(R"(, "structures": {"tongue": {"like": "musle"}}, "materials": {"muscle": {}})")
                .find("Did you mean \"muscle\"?"),
            std::string::npos);
  EXPECT_NE(problem(R"(, "width_px": 1281)"), "accepted");
  EXPECT_NE(problem(R"(, "ligth": {})").find("Did you mean \"light\"?"), std::string::npos);
  EXPECT_NE(problem(R"(, "light": {"key": {"direction": [0, 0, 0]}})").find("no direction"),
            std::string::npos);
}

TEST(PresetFile, ABaseIsChangedWhereAskedOnly) {
  const auto training = scene::loadPreset(kPresets, "training");
  const auto preset = fromText(
      R"({"name": "t", "base": "training", "height_px": 480, "ao": {"taps": 8},
         "materials": {"bone": {"roughness": 0.9}}, "views": {"ap": {"projection": "perspective",
         "eye_mm": [300, 0, 0], "target_mm": [0, 0, -50], "fovY_deg": 20}}})");
  ASSERT_TRUE(training && preset) << preset.error().text();
  EXPECT_EQ(preset->height, 480);
  EXPECT_EQ(preset->width, training->width);
  EXPECT_EQ(preset->ao.taps, 8);
  EXPECT_EQ(preset->ao.radius_m, training->ao.radius_m);
  EXPECT_FLOAT_EQ(preset->materials.at("bone").roughness, 0.9f);
  EXPECT_EQ(preset->materials.at("bone").baseColour_srgb,
            training->materials.at("bone").baseColour_srgb);
  EXPECT_NEAR(preset->views.at("ap").eye_m.x(), 0.3, 1e-12);
  EXPECT_EQ(preset->views.at("si").eye_m, training->views.at("si").eye_m);
  const auto wrong = fromText(R"({"name": "t", "base": "trainig"})");
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().text().find("Did you mean \"training\"?"), std::string::npos);
  const auto circle = fromText(R"({"name": "t", "base": ")" + scratchFile() + R"("})");
  ASSERT_FALSE(circle);
  EXPECT_NE(circle.error().text().find("base on each other"), std::string::npos);
}

TEST(PresetFile, AnotherPaletteRecoloursTheBase) {
  const std::string path = ::testing::TempDir() + "grey.json";
  std::string grey = readFile(kPresets / "palettes/clinical.json").value();
  const auto at = grey.find("\"bone\": \"#");
  ASSERT_NE(at, std::string::npos);
  grey.replace(at, 17, "\"bone\": \"#ffffff\"");
  ASSERT_TRUE(writeFile(path, grey));
  const auto preset = fromText(R"({"name": "t", "base": "small", "palette": ")" + path + R"("})");
  ASSERT_TRUE(preset) << preset.error().text();
  EXPECT_EQ(preset->materials.at("bone").baseColour_srgb, render::Colour(1, 1, 1));
  std::filesystem::remove(path);
}

TEST(PresetFile, ColoursAndMaterialsAreFoundByName) {
  EXPECT_NE(problem(R"(, "palette": "clinical", "background": {"top": "mussle"})")
                .find("Did you mean \"muscle\"?"),
            std::string::npos);
  EXPECT_NE(problem(R"(, "palette": "clinicl")").find("Did you mean \"clinical\"?"),
            std::string::npos);
  EXPECT_NE(problem(R"(, "materials": {"cartilege": {}})").find("Did you mean \"cartilage\"?"),
            std::string::npos);
  EXPECT_NE(problem(R"(, "bolusByConsistency": {"thik": {}})").find("thin, nectar"),
            std::string::npos);
}

TEST(PaletteFile, ColoursThatSomeEyesConfuseAreRefused) {
  const std::string path = ::testing::TempDir() + "palette_test.json";
  ASSERT_TRUE(writeFile(path, R"({"palette": {"flesh": "#b47350", "leaf": "#849b4c"},
                                 "leastDifference": 20, "apart": [["flesh", "leaf"]]})"));
  const auto refused = scene::loadPalette(kPresets, path);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().text().find("\"flesh\" and \"leaf\" differ by"), std::string::npos);
  EXPECT_NE(refused.error().text().find("eyes"), std::string::npos) << refused.error().text();
  std::filesystem::remove(path);
  EXPECT_TRUE(scene::loadPalette(kPresets, "clinical"));
}

TEST(PresetFile, UnknownPresetGetsTheNearest) {
  const auto preset = scene::loadPreset(kPresets, "trainig");
  ASSERT_FALSE(preset);
  EXPECT_EQ(preset.error().text(),
            "--preset: unknown preset \"trainig\"\n  Did you mean \"training\"?");
}

TEST(FileKind, IsToldByTheKeys) {
  using scene::FileKind;
  EXPECT_EQ(scene::fileKind(kPresets / "training.json").value(), FileKind::preset);
  EXPECT_EQ(scene::fileKind(kPresets / "../scenes/boluses.json").value(), FileKind::bolusList);
  EXPECT_TRUE(scene::checkFile(kPresets / "training.json", FileKind::preset, kPresets));
  EXPECT_TRUE(scene::checkFile(kPresets / "../scenes/boluses.json", FileKind::bolusList, kPresets));
  EXPECT_FALSE(scene::checkFile(kPresets / "training.json", FileKind::bolus, kPresets));
  EXPECT_FALSE(scene::fileKind("/none.json"));
}
