// SPDX-License-Identifier: MIT
#include "scene/bolus_file.h"

#include "core/vec.h"
#include "scene/json_reader.h"

namespace swallowclip::scene {
namespace {
// Ranges are what a person can swallow, with room: air-foamed cream to dense barium, water to
// paste.
constexpr double kMinDensity_kgm3 = 500, kMaxDensity_kgm3 = 3000;
constexpr double kMinViscosity_Pas = 1e-4, kMaxViscosity_Pas = 1000;
constexpr double kMaxConsistency_Pasn = 1e4;                   // thick puree: some 100 Pa.s^n
constexpr double kMinTension_Nm = 1e-3, kMaxTension_Nm = 0.5;  // water has 0.073, mercury 0.49
constexpr double kRadPerDeg = kPi / 180;
// Of a bolus on walls that saliva wets, clinical-reference 4 (0.045 to 0.072 N/m).
constexpr Surface kSwallowed{.tension_Nm = 0.055, .contactAngle_rad = 20 * kRadPerDeg};

/// Names become parts of file names.
bool isFileWord(const std::string& word) {
  constexpr std::size_t kLongest = 40;
  return !word.empty() && word.size() <= kLongest &&
         word.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") == std::string::npos &&
         word != "none";
}

/// The nearest file word to any text, e.g. of a file that does not name its bolus.
std::string wordOf(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (!((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))) c = '-';
  }
  return text.substr(0, 40);
}

BolusDef readBolus(const JsonNode& node, std::string name) {
  BolusDef def{std::move(name), node.text("description", ""), readFluid(node, kSwallowed)};
  // "% w/v" is grams in 100 mL; above 250 % the grains of 4.5 g/cm3 leave no room for water
  constexpr double kKgm3PerPercent = 10;
  def.bariumSulfate_kgm3 = node.number("barium_percentWv", 0, 250, 0) * kKgm3PerPercent;
  if (node.exists() && !isFileWord(def.name))
    node.fail("a bolus name has 1 to 40 lower-case letters, digits or '-', and is not \"none\"",
              "Rename it; it becomes part of file names.");
  return def;
}
}  // namespace

/// Newtonian, Carreau, power law and Herschel-Bulkley each take their own numbers and no others.
bolus::Fluid readFluid(const JsonNode& node, const Surface& usual) {
  using bolus::RheologyModel;
  bolus::Fluid fluid;
  fluid.density_kgm3 = node.number("density_kgm3", kMinDensity_kgm3, kMaxDensity_kgm3);
  const std::string word =
      node.choice("rheology", {"newtonian", "power-law", "carreau", "herschel-bulkley"});
  fluid.model = bolus::rheologyFromName(word).value_or(RheologyModel::newtonian);
  constexpr double kLowestIndex = 0.05, kHighestIndex = 2;
  switch (fluid.model) {
    case RheologyModel::newtonian:
      fluid.viscosity_Pas = node.number("viscosity_Pas", kMinViscosity_Pas, kMaxViscosity_Pas);
      break;
    case RheologyModel::herschelBulkley:
      fluid.yield_Pa = node.number("yield_Pa", 0, 1000);
      [[fallthrough]];
    case RheologyModel::powerLaw:
      fluid.consistency_Pasn = node.number("consistency_Pasn", 1e-5, kMaxConsistency_Pasn);
      fluid.index = node.number("index", kLowestIndex, kHighestIndex);
      break;
    case RheologyModel::carreau:
      fluid.eta0_Pas = node.number("eta0_Pas", kMinViscosity_Pas, kMaxViscosity_Pas);
      fluid.etaInf_Pas =
          node.number("etaInf_Pas", kMinViscosity_Pas, kMaxViscosity_Pas, fluid.etaInf_Pas);
      fluid.lambda_s = node.number("lambda_s", 1e-6, 1e4, fluid.lambda_s);
      fluid.index = node.number("index", kLowestIndex, kHighestIndex);
      break;
  }
  fluid.minViscosity_Pas =
      node.number("minViscosity_Pas", kMinViscosity_Pas, kMaxViscosity_Pas, fluid.minViscosity_Pas);
  fluid.maxViscosity_Pas =
      node.number("maxViscosity_Pas", kMinViscosity_Pas, kMaxViscosity_Pas, fluid.maxViscosity_Pas);
  fluid.surfaceTension_Nm = node.number("surface_tension_Nm", 0, kMaxTension_Nm, usual.tension_Nm);
  fluid.contactAngle_rad = usual.contactAngle_rad;
  if (node.has("contact_angle_deg")) {
    fluid.contactAngle_rad = node.number("contact_angle_deg", 0, 180) * kRadPerDeg;
    if (fluid.surfaceTension_Nm == 0)
      node.fail("\"contact_angle_deg\" without surface tension has no effect",
                "Give \"surface_tension_Nm\" above 0 (water 0.073), or remove the angle.");
  }
  if (node.has("coating"))
    fluid.coatingTension_Nm =
        node.object("coating").number("surface_tension_Nm", kMinTension_Nm, kMaxTension_Nm);
  if (const std::string problem = fluid.validate(); !problem.empty())
    node.fail(problem, "Correct the numbers of this bolus.");
  return fluid;
}

Result<BolusDef> loadBolusFile(const std::filesystem::path& path) {
  auto file = JsonFile::load(path);
  if (!file) return std::unexpected(file.error());
  BolusDef def = readBolus(file->root(), file->root().text("name", wordOf(path.stem().string())));
  if (auto done = file->finish(); !done) return std::unexpected(done.error());
  return def;
}

Result<std::vector<BolusDef>> loadBolusList(const std::filesystem::path& path) {
  auto file = JsonFile::load(path);
  if (!file) return std::unexpected(file.error());
  std::vector<BolusDef> boluses;
  for (const auto& [name, node] : file->root().object("boluses").members())
    boluses.push_back(readBolus(node, name));
  if (auto done = file->finish(); !done) return std::unexpected(done.error());
  return boluses;
}

Result<std::vector<BolusDef>> loadBoluses(const std::filesystem::path& scenesFolder) {
  return loadBolusList(scenesFolder / "boluses.json");
}

Result<BolusDef> loadBolus(const std::filesystem::path& scenesFolder,
                           const std::string& nameOrFile) {
  if (nameOrFile.ends_with(".json")) return loadBolusFile(nameOrFile);
  auto boluses = loadBoluses(scenesFolder);
  if (!boluses) return std::unexpected(boluses.error());
  std::vector<std::string> names;
  for (BolusDef& def : *boluses) {
    if (def.name == nameOrFile) return std::move(def);
    names.push_back(def.name);
  }
  const std::string near = nearestName(nameOrFile, names);
  return usageError("--bolus", fmt::format("unknown bolus \"{}\"", nameOrFile),
                    near.empty()
                        ? fmt::format("Known: {}, none; or a .json file.", fmt::join(names, ", "))
                        : fmt::format("Did you mean \"{}\"?", near));
}
}  // namespace swallowclip::scene
