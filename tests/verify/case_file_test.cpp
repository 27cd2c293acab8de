// SPDX-License-Identifier: MIT
// Case files: what is read, and that everything wrong is refused with its place and a remedy.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "core/file.h"
#include "scratch.h"
#include "verify/case.h"
#include "verify/cases.h"
#include "verify/quantities.h"
#include "verify/references.h"

using namespace swallowclip;
using namespace swallowclip::verify;
using verify::test::kGoodCase;
using verify::test::spoilt;

namespace {
void expectRefused(const std::string& text, const std::string& problem) {
  const auto def = parseCase(text, "case.json");
  ASSERT_FALSE(def) << problem;
  const Error& e = def.error();
  EXPECT_EQ(e.kind, ErrorKind::usage);
  EXPECT_TRUE(e.place.starts_with("case.json:")) << e.place;
  EXPECT_NE(e.problem.find(problem), std::string::npos) << e.problem;
  EXPECT_FALSE(e.remedy.empty());
}
}  // namespace

TEST(CaseFile, IsReadInSiUnits) {
  const auto def = parseCase(kGoodCase, "case.json");
  ASSERT_TRUE(def) << def.error().text();
  EXPECT_TRUE(def->isShort);
  EXPECT_NEAR(def->domain.size_m.z(), 0.04, 1e-15);
  EXPECT_NEAR(def->spacing_m, 0.002, 1e-15);
  EXPECT_EQ(def->samples_s.size(), 2u);
  EXPECT_NEAR(def->fill.at(0).radius_m, 0.005, 1e-15);
}

TEST(CaseFile, RefusesWhatCannotBeRun) {
  expectRefused(spoilt("\"viscosity_Pas\": 1", "\"viscosity_Pas\": 0"), "viscosity_Pas");
  expectRefused(spoilt("\"viscosity_Pas\": 1", "\"viscosity_Pas\": -1"), "viscosity_Pas");
  expectRefused(spoilt("\"viscosity_Pas\": 1", "\"viscosity_Pas\": NaN"), "");
  expectRefused(spoilt("[10, 10, 30]", "[10, 10, 38]"), "fluid outside the domain");
  expectRefused(spoilt("[20, 20, 40]", "[1.5, 20, 40]"), "spacing of 2 mm in a domain 1.5 mm wide");
  expectRefused(spoilt("\"spacing_mm\": 2", "\"spacing_mm\": 0"), "spacing_mm");
  expectRefused(spoilt("[20, 20, 40]", "[20, 1e99, 40]"), "size_mm");
  expectRefused(spoilt("[0.01, 0.02]", "[0.02, 0.01]"), "samples_s");
  expectRefused(spoilt("[0.01, 0.02]", "[0.01, 0.2]"), "samples_s");
  expectRefused(spoilt("\"tolerance\": 0.001", "\"tolerance\": 0.001, \"from_s\": 0.03"),
                "begins at 0.03 s, the last sample is at 0.02 s");
  expectRefused(spoilt("\"subset\"", "\"subest\""), "subest");
  expectRefused(spoilt("free-fall-speed", "free-fall-sped"), "free-fall-sped");
  expectRefused(spoilt("free-fall-speed", "hydrostatic"), "is a profile");
  expectRefused(spoilt("free-fall-speed", "shapiro-plane"), "needs a peristaltic wave");
  expectRefused(spoilt("\"drop\"", "\"../drop\""), "name");
  expectRefused(spoilt("\"slip\": false",
                       "\"slip\": false, \"motion\": {\"kind\": \"rotate\", "
                       "\"rate_rads\": 1}"),
                "needs a cylinder");
  expectRefused(spoilt("\"radius_mm\": 5", "\"radius_mm\": 0.1"), "particle");
  expectRefused(spoilt("{\"kind\": \"sphere\", \"centre_mm\": [10, 10, 30], \"radius_mm\": 5}", ""),
                "fill");
  expectRefused(spoilt("[20, 20, 40]}", "[3, 20, 40], \"periodic\": \"x\"}"), "a period of 3 mm");
  const std::string fluid = "\"viscosity_Pas\": 1";
  expectRefused(spoilt(fluid, fluid + ", \"surface_tension_Nm\": -0.07"), "surface_tension_Nm");
  expectRefused(spoilt(fluid, fluid + ", \"surface_tension_Nm\": 0.07, \"contact_angle_deg\": 181"),
                "contact_angle_deg");
  expectRefused(spoilt(fluid, fluid + ", \"contact_angle_deg\": 60"), "without surface tension");
  expectRefused(spoilt("free-fall-speed", "laplace-pressure"), "needs surface_tension_Nm above 0");
  expectRefused(kGoodCase.substr(0, kGoodCase.size() / 2), "");
}

TEST(CaseFile, RefusesMeshesThatAreMissingOrLeak) {
  const std::string mesh = R"({"shape": "mesh", "file": "walls.obj", "unit": "mm"})";
  const std::string text = spoilt(R"({"shape": "box", "size_mm": [20, 20, 40]})", mesh);
  const swallowclip::test::Scratch folder;
  const auto file = folder.path() / "case.json";
  ASSERT_TRUE(writeFile(file, text));
  const auto missing = loadCase(file);
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().text().find("walls.obj"), std::string::npos);

  // a box from -20 to 60 mm whose last face lacks one triangle
  const std::string vertices =
      "v -20 -20 -20\nv 60 -20 -20\nv 60 60 -20\nv -20 60 -20\n"
      "v -20 -20 60\nv 60 -20 60\nv 60 60 60\nv -20 60 60\n";
  const std::string faces =
      "f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\n"
      "f 3 4 8\nf 3 8 7\nf 4 1 5\n";
  ASSERT_TRUE(writeFile(folder.path() / "walls.obj", vertices + faces));
  const auto leaking = loadCase(file);
  ASSERT_FALSE(leaking);
  EXPECT_NE(leaking.error().problem.find("edge"), std::string::npos) << leaking.error().text();

  ASSERT_TRUE(writeFile(folder.path() / "walls.obj", vertices + faces + "f 4 5 8\n"));
  const auto closed = loadCase(file);
  EXPECT_TRUE(closed) << closed.error().text();
}

// Bytes of good files changed, dropped and doubled: read or refused, never a crash or a hang.
TEST(CaseFile, BearsRandomDamage) {
  std::uint64_t seed = 1;
  const auto next = [&](std::uint64_t below) {  // Knuth's MMIX generator
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (seed >> 33) % below;
  };
  int refused = 0;
  for (int round = 0; round < 400; ++round) {
    std::string text = kGoodCase;
    for (std::uint64_t k = 0; k <= next(3); ++k) {
      const std::size_t at = next(text.size());
      switch (next(4)) {
        case 0:
          text[at] = static_cast<char>(next(256));
          break;
        case 1:
          text.erase(at, 1 + next(20));
          break;
        case 2:
          text.insert(at, text.substr(at, 1 + next(20)));
          break;
        default:
          text[at] = "0123456789-.eE[]{},:\""[next(21)];
      }
    }
    const auto def = parseCase(text, "damaged.json");
    refused += !def;
    EXPECT_TRUE(def || !def.error().text().empty());
  }
  EXPECT_GT(refused, 200);
}

TEST(CaseFile, EveryWordIsDocumented) {
  const std::string page =
      readFile(std::filesystem::path(SWALLOWCLIP_SOURCE_DIR) / "docs" / "verify.md").value();
  for (const auto& words : {referenceNames(), quantityNames(), fieldNames(), coordinateNames()})
    for (const std::string& word : words)
      EXPECT_NE(page.find("`" + word + "`"), std::string::npos) << word;
}

TEST(CaseFile, AllShippedCasesAreGood) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(
           std::filesystem::path(SWALLOWCLIP_SOURCE_DIR) / "scenes" / "verify")) {
    if (!entry.is_regular_file()) continue;
    const auto def = loadCase(entry.path());
    ASSERT_TRUE(def) << def.error().text();
    EXPECT_EQ(def->name, entry.path().stem().string());
    EXPECT_FALSE(def->source.empty()) << def->name << " does not say where its answer is from";
    EXPECT_TRUE(names.insert(def->name).second);
  }
  EXPECT_GE(names.size(), 20u);
}
