// SPDX-License-Identifier: MIT
#include "scene/bolus_file.h"

#include <gtest/gtest.h>

#include "core/file.h"

using namespace swallowclip;
using bolus::RheologyModel;

namespace {
const std::filesystem::path kScenes = std::filesystem::path(SWALLOWCLIP_SOURCE_DIR) / "scenes";

scene::BolusDef known(const std::string& name) {
  auto def = scene::loadBolus(kScenes, name);
  EXPECT_TRUE(def) << (def ? "" : def.error().text());
  return def.value_or(scene::BolusDef{});
}

std::string fileError(const std::string& json) {
  // tests run beside each other
  const std::string path = ::testing::TempDir() + "bolus_file_" +
                           ::testing::UnitTest::GetInstance()->current_test_info()->name() +
                           ".json";
  EXPECT_TRUE(writeFile(path, json));
  const auto def = scene::loadBolus(kScenes, path);
  std::filesystem::remove(path);
  return def ? "accepted" : def.error().text();
}
}  // namespace

TEST(BolusFile, ThesisHoneyIsTheThesis) {
  const auto def = known("thesis-honey");
  EXPECT_EQ(def.fluid.model, RheologyModel::newtonian);
  EXPECT_EQ(def.fluid.density_kgm3, 1000);
  EXPECT_EQ(def.fluid.viscosity_Pas, 1.0);
}

/// The viscosity at 50 1/s is what the names promise (clinical-reference 4): within 1 %.
TEST(BolusFile, ApparentViscosityAt50PerSecond) {
  const std::pair<const char*, double> expected[] = {
      {"thin", 0.004},     {"nectar", 0.30},  {"honey", 3.0},          {"pudding", 5.0},
      {"thin-honey", 1.5}, {"water", 0.001},  {"iddsi-1", 0.048},      {"iddsi-2", 0.126},
      {"iddsi-3", 0.287},  {"iddsi-4", 1.05}, {"nectar-carreau", 0.30}};
  for (const auto& [name, eta_Pas] : expected) {
    const double found_Pas = bolus::apparentViscosity_Pas(known(name).fluid, 50);
    EXPECT_NEAR(found_Pas / eta_Pas, 1, 0.015) << name << ": " << found_Pas;
  }
}

TEST(BolusFile, UnknownNameGetsTheNearest) {
  const auto def = scene::loadBolus(kScenes, "necter");
  ASSERT_FALSE(def);
  EXPECT_EQ(def.error().text(), "--bolus: unknown bolus \"necter\"\n  Did you mean \"nectar\"?");
  EXPECT_EQ(def.error().kind, ErrorKind::usage);
}

TEST(BolusFile, OwnFile) {
  EXPECT_EQ(fileError(R"({"name": "oil", "density_kgm3": 920, "rheology": "newtonian",
                          "viscosity_Pas": 0.07})"),
            "accepted");
  EXPECT_NE(fileError(R"({"name": "oil", "density_kgm3": 0.92, "rheology": "newtonian",
                          "viscosity_Pas": 0.07})")
                .find("0.92 is outside 500 to 3000"),
            std::string::npos);
  EXPECT_NE(fileError(R"({"name": "oil", "density_kgm3": 920, "rheology": "newtonian",
                          "viscosity_Pas": 0.07, "index": 0.4})")
                .find("unknown key \"index\""),
            std::string::npos);
  EXPECT_NE(fileError(R"({"name": "../oil", "density_kgm3": 920, "rheology": "newtonian",
                          "viscosity_Pas": 0.07})")
                .find("lower-case letters"),
            std::string::npos);
}

TEST(BolusFile, SurfaceTensionIsReadWithItsAngle) {
  const auto with = [](const std::string& more) {
    return fileError(R"({"name": "oil", "density_kgm3": 920, "rheology": "newtonian",
                         "viscosity_Pas": 0.07)" +
                     more + "}");
  };
  EXPECT_EQ(with(R"(, "surface_tension_Nm": 0.03, "contact_angle_deg": 60)"), "accepted");
  EXPECT_EQ(with(R"(, "surface_tension_Nm": 0.03)"), "accepted");
  EXPECT_NE(with(R"(, "surface_tension_Nm": -0.03)").find("-0.03 is outside 0 to 0.5"),
            std::string::npos);
  EXPECT_NE(with(R"(, "surface_tension_Nm": 0.03, "contact_angle_deg": 190)")
                .find("190 is outside 0 to 180"),
            std::string::npos);
  EXPECT_EQ(with(R"(, "contact_angle_deg": 60)"), "accepted") << "with the usual tension";
  const std::string alone = with(R"(, "surface_tension_Nm": 0, "contact_angle_deg": 60)");
  EXPECT_NE(alone.find("without surface tension has no effect"), std::string::npos) << alone;
  EXPECT_NE(alone.find("Give \"surface_tension_Nm\""), std::string::npos) << alone;
}

TEST(BolusFile, ABolusHasTheSurfaceOfWhatIsSwallowed) {
  EXPECT_EQ(known("thin").fluid.surfaceTension_Nm, 0.055);
  EXPECT_NEAR(known("thin").fluid.contactAngle_rad, 20 * 3.14159265358979 / 180, 1e-12);
}

TEST(BolusFile, CoatingIsReadAndGuarded) {
  const auto text = [](const std::string& coating) {
    return R"({"density_kgm3": 1000, "rheology": "newtonian", "viscosity_Pas": 1, "coating": )" +
           coating + "}";
  };
  EXPECT_EQ(fileError(text(R"({"surface_tension_Nm": 0.06})")), "accepted");
  const std::string zero = fileError(text(R"({"surface_tension_Nm": 0})"));
  EXPECT_NE(zero.find("surface_tension_Nm"), std::string::npos) << zero;
  EXPECT_NE(zero.find(":1:"), std::string::npos) << zero;
  EXPECT_NE(fileError(text("{}")).find("surface_tension_Nm"), std::string::npos);
  EXPECT_NE(fileError(text(R"({"surface_tension_mNm": 60})")), "accepted");
  EXPECT_EQ(known("thin").fluid.coatingTension_Nm, 0);
}
