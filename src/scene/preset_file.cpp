// SPDX-License-Identifier: MIT
#include "scene/preset_file.h"

#include <algorithm>
#include <cmath>

#include "scene/json_reader.h"

namespace swallowclip::scene {
namespace {
using namespace render;
constexpr double kRadPerDeg = kPi / 180;

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

/// "#rrggbb" or [r, g, b] with components 0 to 1.
Colour colour(const JsonNode& node, std::string_view key, const Colour& defaultValue) {
  if (!node.has(key)) return defaultValue;
  const JsonNode value = node.member(key);
  if (value.isArray()) {
    const std::vector<double> c = value.asNumbers();
    const bool inRange = std::ranges::all_of(c, [](double v) { return v >= 0 && v <= 1; });
    if (c.size() == 3 && inRange) return Colour(float(c[0]), float(c[1]), float(c[2]));
  } else {
    const std::string text = value.asText();
    if (text.size() == 7 && text[0] == '#' &&
        text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos) {
      const unsigned long rgb = std::stoul(text.substr(1), nullptr, 16);
      return Colour(float(rgb >> 16 & 255), float(rgb >> 8 & 255), float(rgb & 255)) / 255.0f;
    }
  }
  value.fail(fmt::format("\"{}\": not a colour", key),
             "Write \"#rrggbb\" or [r, g, b] with 0 to 1.");
  return defaultValue;
}

Vec3 direction(const JsonNode& node, std::string_view key, const Vec3& defaultValue) {
  const Vec3 v = node.vec3(key, defaultValue);
  if (v.norm() > 1e-6 && v.norm() < 1e6) return v;  // a direction may have any sane length
  node.fail(fmt::format("\"{}\" is no direction", key), "Give a vector that is not zero.");
  return defaultValue;
}

Material readMaterial(const JsonNode& node, Material m) {
  m.baseColour_srgb = colour(node, "baseColour", m.baseColour_srgb);
  m.sectionColour_srgb = colour(node, "sectionColour", m.sectionColour_srgb);
  m.roughness = static_cast<float>(node.number("roughness", 0.05, 1, m.roughness));
  m.specular = unit(node, "specular", m.specular);
  m.translucency = unit(node, "translucency", m.translucency);
  m.wetness = unit(node, "wetness", m.wetness);
  m.mottle = unit(node, "mottle", m.mottle);
  m.opacity = unit(node, "opacity", m.opacity);
  return m;
}

/// Own look of a structure; "like" names the material it starts from.
void readStructures(const JsonNode& root, RenderPreset& preset) {
  std::vector<std::string> known;
  for (const auto& [name, look] : preset.materials) known.push_back(name);
  for (const auto& [name, node] : root.object("structures").members()) {
    Material start = preset.fallback;
    if (node.has("like")) start = preset.materials[node.choice("like", known)];
    preset.structures[name] = readMaterial(node, start);
  }
}

DirectionalLight readLight(const JsonNode& node, DirectionalLight light) {
  light.direction = direction(node, "direction", light.direction.cast<double>()).cast<float>();
  light.colour_srgb = colour(node, "colour", light.colour_srgb);
  light.intensity = real(node, "intensity", 100, light.intensity);
  return light;
}

void readLights(const JsonNode& node, LightDef& light) {
  if (node.has("key")) light.key = readLight(node.object("key"), light.key);
  if (node.has("fill")) light.fill = readLight(node.object("fill"), light.fill);
  light.ambientTop_srgb = colour(node, "ambientTop", light.ambientTop_srgb);
  light.ambientBottom_srgb = colour(node, "ambientBottom", light.ambientBottom_srgb);
  light.ambientIntensity = real(node, "ambientIntensity", 100, light.ambientIntensity);
  light.shadow = node.boolean("shadow", light.shadow);
  light.shadowMap_px = node.integer("shadowMap_px", 64, 8192, light.shadowMap_px);
  light.shadowSoftness_m = length_m(node, "shadowSoftness_mm", 50, light.shadowSoftness_m);
  light.shadowStrength = unit(node, "shadowStrength", light.shadowStrength);
}

void readCaption(const JsonNode& node, CaptionDef& caption) {
  caption.on = node.boolean("on", caption.on);
  caption.font = node.text("font", caption.font);
  caption.size_px = static_cast<float>(node.number("size_px", 4, 400, caption.size_px));
  caption.colour_srgb = colour(node, "colour", caption.colour_srgb);
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
  preset.msaa = root.integer("msaa", 1, 4, preset.msaa);
  preset.exposure = real(root, "exposure", 100, preset.exposure);
  preset.toneMap = root.boolean("toneMap", preset.toneMap);
  preset.sectionOutline_m = length_m(root, "sectionOutline_mm", 20, preset.sectionOutline_m);
  preset.sectionOutlineDarkness =
      unit(root, "sectionOutlineDarkness", preset.sectionOutlineDarkness);
  if (root.has("creaseAngle_deg"))
    preset.creaseAngle_rad =
        static_cast<float>(root.number("creaseAngle_deg", 0, 180) * kRadPerDeg);
}

void readSurroundings(const JsonNode& root, RenderPreset& preset) {
  if (root.has("light")) readLights(root.object("light"), preset.light);
  if (root.has("ao")) {
    const JsonNode ao = root.object("ao");
    preset.ao.strength = unit(ao, "strength", preset.ao.strength);
    preset.ao.radius_m = length_m(ao, "radius_mm", 200, preset.ao.radius_m);
    preset.ao.taps = ao.integer("taps", 4, 32, preset.ao.taps);
  }
  if (root.has("background")) {
    const JsonNode background = root.object("background");
    preset.background.top_srgb = colour(background, "top", preset.background.top_srgb);
    preset.background.bottom_srgb = colour(background, "bottom", preset.background.bottom_srgb);
  }
  if (root.has("caption")) readCaption(root.object("caption"), preset.caption);
  if (root.has("fluoro")) readFluoro(root.object("fluoro"), preset.fluoro);
}

Result<RenderPreset> readPreset(const JsonFile& file) {
  const JsonNode root = file.root();
  RenderPreset preset;
  readPicture(root, preset);
  if (root.has("fallback"))
    preset.fallback = readMaterial(root.object("fallback"), preset.fallback);
  if (root.has("materials"))
    for (const auto& [name, node] : root.object("materials").members())
      preset.materials[name] = readMaterial(node, Material{});
  if (root.has("structures")) readStructures(root, preset);
  if (root.has("bolus")) preset.bolus = readMaterial(root.object("bolus"), preset.bolus);
  if (root.has("sectionPriority")) preset.sectionPriority = root.texts("sectionPriority");
  readSurroundings(root, preset);
  for (const auto& [name, node] : root.object("views").members())
    preset.views[name] = readView(node, name);
  if (const std::string problem = preset.validate(); !problem.empty())
    root.fail(problem, "Correct the preset.");
  if (auto done = file.finish(); !done) return std::unexpected(done.error());
  return preset;
}
}  // namespace

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
  std::filesystem::path path = nameOrFile;
  if (!nameOrFile.ends_with(".json")) {
    const std::vector<std::string> names = presetNames(presetsFolder);
    if (std::ranges::find(names, nameOrFile) == names.end()) {
      const std::string near = nearestName(nameOrFile, names);
      return usageError("--preset", fmt::format("unknown preset \"{}\"", nameOrFile),
                        near.empty()
                            ? fmt::format("Known: {}; or a .json file.", fmt::join(names, ", "))
                            : fmt::format("Did you mean \"{}\"?", near));
    }
    path = presetsFolder / (nameOrFile + ".json");
  }
  return loadPresetFile(path);
}

Result<RenderPreset> loadPresetFile(const std::filesystem::path& path) {
  auto file = JsonFile::load(path);
  if (!file) return std::unexpected(file.error());
  return readPreset(*file);
}
}  // namespace swallowclip::scene
