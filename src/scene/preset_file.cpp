// SPDX-License-Identifier: MIT
#include "scene/preset_file.h"

#include <algorithm>
#include <cmath>

#include "scene/json_reader.h"
#include "scene/palette_file.h"

namespace swallowclip::scene {
namespace {
using namespace render;
constexpr double kRadPerDeg = kPi / 180;
const std::vector<std::string> kMaterials{"bone", "cartilage", "enamel", "mucosa", "muscle"};

float unit(const JsonNode& node, std::string_view key, float defaultValue) {
  return static_cast<float>(node.number(key, 0, 1, defaultValue));
}
float real(const JsonNode& node, std::string_view key, double max, float defaultValue) {
  return static_cast<float>(node.number(key, 0, max, defaultValue));
}
/// A length given in mm under a key that says so.
float length_m(const JsonNode& node, std::string_view key, double max_mm, float defaultValue_m) {
  if (!node.has(key)) return defaultValue_m;
  return static_cast<float>(node.number(key, 0, max_mm) * kMetrePerMm);
}

Vec3 direction(const JsonNode& node, std::string_view key, const Vec3& defaultValue) {
  const Vec3 v = node.vec3(key, defaultValue);
  if (v.norm() > 1e-6 && v.norm() < 1e6) return v;  // a direction may have any sane length
  node.fail(fmt::format("\"{}\" is no direction", key), "Give a vector that is not zero.");
  return defaultValue;
}

Material readMaterial(const JsonNode& node, Material m, const Palette& palette) {
  m.baseColour_srgb = readColour(node, "baseColour", m.baseColour_srgb, palette);
  m.sectionColour_srgb = readColour(node, "sectionColour", m.sectionColour_srgb, palette);
  m.roughness = static_cast<float>(node.number("roughness", 0.05, 1, m.roughness));
  m.specular = unit(node, "specular", m.specular);
  m.translucency = unit(node, "translucency", m.translucency);
  m.wetness = unit(node, "wetness", m.wetness);
  m.mottle = unit(node, "mottle", m.mottle);
  m.relief = unit(node, "relief", m.relief);
  m.reliefSize_m = length_m(node, "reliefSize_mm", 50, m.reliefSize_m);
  m.opacity = unit(node, "opacity", m.opacity);
  return m;
}

/// Own look of a structure; "like" names the material it starts from.
void readStructures(const JsonNode& root, RenderPreset& preset, const Palette& palette) {
  std::vector<std::string> known;
  for (const auto& [name, look] : preset.materials) known.push_back(name);
  for (const auto& [name, node] : root.object("structures").members()) {
    Material start = preset.structures.contains(name) ? preset.structures[name] : preset.fallback;
    if (node.has("like")) start = preset.materials[node.choice("like", known)];
    preset.structures[name] = readMaterial(node, start, palette);
  }
}

void readMaterials(const JsonNode& root, RenderPreset& preset, const Palette& palette) {
  if (root.has("fallback"))
    preset.fallback = readMaterial(root.object("fallback"), preset.fallback, palette);
  if (root.has("materials"))
    for (const auto& [name, node] : root.object("materials").members()) {
      if (std::ranges::find(kMaterials, name) == kMaterials.end()) {
        const std::string near = nearestName(name, kMaterials);
        node.fail(fmt::format("unknown material \"{}\"", name),
                  near.empty() ? fmt::format("Known: {}.", fmt::join(kMaterials, ", "))
                               : fmt::format("Did you mean \"{}\"?", near));
      }
      preset.materials[name] = readMaterial(node, preset.materials[name], palette);
    }
  if (root.has("structures")) readStructures(root, preset, palette);
  if (root.has("bolus")) preset.bolus = readMaterial(root.object("bolus"), preset.bolus, palette);
  if (root.has("bolusByConsistency")) {
    const std::vector<std::string> known(std::begin(kConsistencies), std::end(kConsistencies));
    for (const auto& [name, node] : root.object("bolusByConsistency").members()) {
      if (std::ranges::find(known, name) == known.end())
        node.fail(fmt::format("unknown consistency \"{}\"", name),
                  fmt::format("Known: {}.", fmt::join(known, ", ")));
      const auto start = preset.bolusByConsistency.find(name);
      preset.bolusByConsistency[name] = readMaterial(
          node, start == preset.bolusByConsistency.end() ? preset.bolus : start->second, palette);
    }
  }
}

DirectionalLight readLight(const JsonNode& node, DirectionalLight light, const Palette& palette) {
  light.direction = direction(node, "direction", light.direction.cast<double>()).cast<float>();
  light.colour_srgb = readColour(node, "colour", light.colour_srgb, palette);
  light.intensity = real(node, "intensity", 100, light.intensity);
  return light;
}

void readLights(const JsonNode& node, LightDef& light, const Palette& palette) {
  if (node.has("key")) light.key = readLight(node.object("key"), light.key, palette);
  if (node.has("fill")) light.fill = readLight(node.object("fill"), light.fill, palette);
  light.ambientTop_srgb = readColour(node, "ambientTop", light.ambientTop_srgb, palette);
  light.ambientBottom_srgb = readColour(node, "ambientBottom", light.ambientBottom_srgb, palette);
  light.ambientIntensity = real(node, "ambientIntensity", 100, light.ambientIntensity);
  light.shadow = node.boolean("shadow", light.shadow);
  light.shadowMap_px = node.integer("shadowMap_px", 64, 8192, light.shadowMap_px);
  light.shadowSoftness_m = length_m(node, "shadowSoftness_mm", 50, light.shadowSoftness_m);
  light.shadowStrength = unit(node, "shadowStrength", light.shadowStrength);
}

void readCaption(const JsonNode& node, CaptionDef& caption, const Palette& palette) {
  caption.on = node.boolean("on", caption.on);
  caption.font = node.text("font", caption.font);
  caption.size_px = static_cast<float>(node.number("size_px", 4, 400, caption.size_px));
  caption.colour_srgb = readColour(node, "colour", caption.colour_srgb, palette);
  caption.timeBar = node.boolean("timeBar", caption.timeBar);
  caption.credit = node.text("credit", caption.credit);
}

void readFluoro(const JsonNode& node, FluoroDef& f) {
  f.body = node.boolean("body", f.body);
  constexpr double kPerM2 = 1e6;  // from 1/mm2
  f.quanta_per_m2 =
      static_cast<float>(node.number("quanta_per_mm2", 0, 1e7, f.quanta_per_m2 / kPerM2) * kPerM2);
  f.scatterToPrimary = real(node, "scatterToPrimary", 10, f.scatterToPrimary);
  f.scatterRadius_m = length_m(node, "scatterRadius_mm", 200, f.scatterRadius_m);
  f.blur_m = length_m(node, "blur_mm", 5, f.blur_m);
  f.fieldWidth_m = length_m(node, "fieldWidth_mm", 1000, f.fieldWidth_m);
  f.fieldHeight_m = length_m(node, "fieldHeight_mm", 1000, f.fieldHeight_m);
  f.fieldCorner_m = length_m(node, "fieldCorner_mm", 500, f.fieldCorner_m);
  f.penumbra_m = length_m(node, "penumbra_mm", 50, f.penumbra_m);
  f.white = static_cast<float>(node.number("white", -20, 20, f.white));
  f.black = static_cast<float>(node.number("black", -20, 20, f.black));
  f.equalisation = unit(node, "equalisation", f.equalisation);
  f.gamma = static_cast<float>(node.number("gamma", 0.2, 5, f.gamma));
  f.boneDark = node.boolean("boneDark", f.boneDark);
}

ClipRule readCut(const JsonNode& node) {
  ClipRule rule;
  rule.normal = direction(node, "normal", rule.normal).normalized();
  rule.offset_m = node.number("offset_mm", -1000, 1000, 0) * kMetrePerMm;
  if (node.has("only")) rule.only = node.texts("only");
  if (node.has("except")) rule.except = node.texts("except");
  rule.cap = node.boolean("cap", rule.cap);
  return rule;
}

ViewDef readView(const JsonNode& node, const std::string& name) {
  ViewDef view;
  view.captionTitle = node.text("captionTitle", name);
  view.style = node.choice("style", {"surface", "fluoro"}, "surface") == "fluoro" ? Style::fluoro
                                                                                  : Style::surface;
  const bool flat = node.choice("projection", {"perspective", "orthographic"}) == "orthographic";
  view.projection = flat ? Projection::orthographic : Projection::perspective;
  view.eye_m = node.vec3("eye_mm") * kMetrePerMm;
  view.target_m = node.vec3("target_mm") * kMetrePerMm;
  view.up = direction(node, "up", view.up);
  if (flat)
    view.orthoHeight_m = node.number("orthoHeight_mm", 1, 5000) * kMetrePerMm;
  else
    view.fovY_rad = node.number("fovY_deg", 1, 120) * kRadPerDeg;
  view.referenceDepth =
      static_cast<float>(node.number("referenceDepth", 0.1, 20, view.referenceDepth));
  const Vec3 gaze = view.target_m - view.eye_m;
  constexpr double kNearest_m = 1e-3;
  if (node.exists() && (!gaze.allFinite() || gaze.norm() < kNearest_m ||
                        gaze.normalized().cross(view.up.normalized()).norm() < 1e-3))
    node.fail("the camera looks along its own \"up\", or from its target",
              "Move \"eye_mm\" or turn \"up\".");
  if (node.has("cuts"))
    for (const JsonNode& cut : node.array("cuts")) view.cuts.push_back(readCut(cut));
  if (node.has("hidden")) view.hidden = node.texts("hidden");
  if (node.has("shows"))
    for (const auto& [structure, pixels] : node.object("shows").members())
      view.shows[structure] = static_cast<int>(pixels.asNumber(1, 1e7));
  if (node.has("ghosted"))
    for (const auto& [structure, opacity] : node.object("ghosted").members())
      view.ghosted[structure] = static_cast<float>(opacity.asNumber(0, 1));
  return view;
}

void readPicture(const JsonNode& root, RenderPreset& preset) {
  preset.name = root.text("name");
  preset.width = root.integer("width_px", 64, 8192, preset.width);
  preset.height = root.integer("height_px", 64, 8192, preset.height);
  preset.fps = root.number("fps", 30, 240, preset.fps);
  preset.smoothEdges = root.boolean("smoothEdges", preset.smoothEdges);
  preset.exposure = real(root, "exposure", 100, preset.exposure);
  preset.toneMap = root.boolean("toneMap", preset.toneMap);
  preset.sectionOutline_m = length_m(root, "sectionOutline_mm", 20, preset.sectionOutline_m);
  preset.sectionOutlineDarkness =
      unit(root, "sectionOutlineDarkness", preset.sectionOutlineDarkness);
  if (root.has("creaseAngle_deg"))
    preset.creaseAngle_rad =
        static_cast<float>(root.number("creaseAngle_deg", 0, 180) * kRadPerDeg);
}

void readSurroundings(const JsonNode& root, RenderPreset& preset, const Palette& palette) {
  if (root.has("light")) readLights(root.object("light"), preset.light, palette);
  if (root.has("ao")) {
    const JsonNode ao = root.object("ao");
    preset.ao.strength = unit(ao, "strength", preset.ao.strength);
    preset.ao.radius_m = length_m(ao, "radius_mm", 200, preset.ao.radius_m);
    preset.ao.taps = ao.integer("taps", 4, 32, preset.ao.taps);
  }
  if (root.has("background")) {
    const JsonNode background = root.object("background");
    preset.background.top_srgb = readColour(background, "top", preset.background.top_srgb, palette);
    preset.background.bottom_srgb =
        readColour(background, "bottom", preset.background.bottom_srgb, palette);
  }
  if (root.has("caption")) readCaption(root.object("caption"), preset.caption, palette);
  if (root.has("fluoro")) readFluoro(root.object("fluoro"), preset.fluoro);
}

Result<std::filesystem::path> presetPath(const std::filesystem::path& presetsFolder,
                                         const std::string& nameOrFile) {
  if (nameOrFile.ends_with(".json")) return nameOrFile;
  const std::vector<std::string> names = presetNames(presetsFolder);
  if (std::ranges::find(names, nameOrFile) != names.end())
    return presetsFolder / (nameOrFile + ".json");
  const std::string near = nearestName(nameOrFile, names);
  return usageError("--preset", fmt::format("unknown preset \"{}\"", nameOrFile),
                    near.empty()
                        ? fmt::format("Known: {}; or a .json file.", fmt::join(names, ", "))
                        : fmt::format("Did you mean \"{}\"?", near));
}

constexpr int kDeepestBase = 4;

Result<RenderPreset> readPreset(const JsonFile& file, const std::filesystem::path& presetsFolder,
                                const std::string& paletteOfLook, int depth);

// The preset that this one changes, drawn in the palette of this one.
Result<RenderPreset> readBase(const JsonNode& root, const std::filesystem::path& presetsFolder,
                              const std::string& palette, int depth) {
  if (!root.has("base")) return RenderPreset{};
  const std::string base = root.text("base");
  if (depth >= kDeepestBase)
    return usageError(root.place(), fmt::format("more than {} presets base on each other", depth),
                      "Look for a circle, or base on one of the first.");
  auto path = presetPath(presetsFolder, base);
  if (!path) return std::unexpected(path.error());
  auto file = JsonFile::load(*path);
  if (!file) return std::unexpected(file.error());
  return readPreset(*file, presetsFolder, palette, depth + 1);
}

Result<RenderPreset> readPreset(const JsonFile& file, const std::filesystem::path& presetsFolder,
                                const std::string& paletteOfLook, int depth) {
  const JsonNode root = file.root();
  const std::string own = root.text("palette", "");
  const std::string paletteName = paletteOfLook.empty() ? own : paletteOfLook;
  auto base = readBase(root, presetsFolder, paletteName, depth);
  if (!base) return base;
  RenderPreset preset = std::move(*base);
  Palette palette = preset.palette;
  if (!paletteName.empty()) {
    auto loaded = loadPalette(presetsFolder, paletteName);
    if (!loaded) return std::unexpected(loaded.error());
    palette = preset.palette = std::move(*loaded);
  }
  readPicture(root, preset);
  readMaterials(root, preset, palette);
  if (root.has("sectionPriority")) preset.sectionPriority = root.texts("sectionPriority");
  readSurroundings(root, preset, palette);
  if (!root.has("base") || root.has("views"))
    for (const auto& [name, node] : root.object("views").members())
      preset.views[name] = readView(node, name);
  if (const std::string problem = preset.validate(); !problem.empty())
    root.fail(problem, "Correct the preset.");
  if (auto done = file.finish(); !done) return std::unexpected(done.error());
  return preset;
}
}  // namespace

Result<std::vector<std::filesystem::path>> presetFiles(const std::filesystem::path& presetsFolder,
                                                       const std::string& nameOrFile) {
  std::vector<std::filesystem::path> files;
  std::string next = nameOrFile, palette;
  for (int depth = 0; !next.empty() && depth <= kDeepestBase; ++depth) {
    auto path = presetPath(presetsFolder, next);
    if (!path) return std::unexpected(path.error());
    auto file = JsonFile::load(*path);
    if (!file) return std::unexpected(file.error());
    files.push_back(*path);
    if (palette.empty()) palette = file->root().text("palette", "");
    next = file->root().text("base", "");
  }
  if (palette.empty()) return files;
  auto path = palettePath(presetsFolder, palette);
  if (!path) return std::unexpected(path.error());
  files.push_back(*path);
  return files;
}

std::vector<std::string> presetNames(const std::filesystem::path& presetsFolder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(presetsFolder, error))
    if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
  std::ranges::sort(names);
  return names;
}

Result<RenderPreset> loadPreset(const std::filesystem::path& presetsFolder,
                                const std::string& nameOrFile) {
  const auto path = presetPath(presetsFolder, nameOrFile);
  if (!path) return std::unexpected(path.error());
  return loadPresetFile(*path, presetsFolder);
}

Result<RenderPreset> loadPresetFile(const std::filesystem::path& path,
                                    const std::filesystem::path& presetsFolder) {
  auto file = JsonFile::load(path);
  if (!file) return std::unexpected(file.error());
  return readPreset(*file, presetsFolder, "", 0);
}
}  // namespace swallowclip::scene
