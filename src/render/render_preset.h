// SPDX-License-Identifier: MIT
// How pictures look: size, palette, lights, cameras and cutaways as plain structs. Looks only,
// never physics. Metres and radians here; the JSON files in render_presets/ carry mm and deg in
// their keys and are read by the scene room. Frame: x patient left, y posterior, z superior.
// All looks (colours, light, sizes) are own design choices: assumed, tuned by eye.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "core/vec.h"

namespace swallowclip::render {

/// sRGB, components 0..1 (files may write "#rrggbb").
using Colour = Vec3f;

/// Surface look. Dimensionless, 0..1 unless said otherwise.
struct Material {
  Colour baseColour_srgb{0.78f, 0.72f, 0.68f};
  Colour sectionColour_srgb{0.62f, 0.55f, 0.52f};  ///< colour of the capped cut
  float roughness = 0.5f;     ///< GGX, perceptual (alpha = roughness^2), 0.05..1
  float specular = 0.5f;      ///< 0.5 = normal reflectance 0.04 (refractive index 1.5)
  float translucency = 0.0f;  ///< light wrapping past the terminator, tinted by the base colour
  float wetness = 0.0f;       ///< strength of the thin glossy water coat
  float mottle = 0.0f;        ///< contrast of fine tissue-fixed colour variation
  float relief = 0.0f;        ///< height of fine bumps fixed to the tissue: papillae, rugae, folds
  float reliefSize_m = 1.2e-3f;  ///< from bump to bump
  float opacity = 1.0f;          ///< below 1 drawn as ghost in every view
};

/// Directional light; direction points from the scene to the light, in view axes
/// (x right, y up, z towards the viewer), so that every view is lit alike.
struct DirectionalLight {
  Vec3f direction{-0.45f, 0.75f, 0.75f};
  Colour colour_srgb{1.0f, 0.97f, 0.92f};
  float intensity = 1.55f;  ///< diffuse white facing it becomes this bright (linear)
};

struct LightDef {
  DirectionalLight key;
  DirectionalLight fill{{0.8f, 0.1f, 0.6f}, {0.82f, 0.90f, 1.0f}, 0.45f};
  Colour ambientTop_srgb{0.80f, 0.84f, 0.90f};
  Colour ambientBottom_srgb{0.55f, 0.45f, 0.42f};
  float ambientIntensity = 0.45f;
  bool shadow = true;
  int shadowMap_px = 1024;
  float shadowSoftness_m = 1.5e-3f;  ///< radius of the filter on the shadow map
  float shadowStrength = 0.75f;      ///< 0 none .. 1 key light fully blocked
};

struct AoDef {
  float strength = 0.85f;  ///< 0 switches the pass off
  float radius_m = 8e-3f;
  int taps = 16;  ///< 4..32
};

struct BackgroundDef {
  Colour top_srgb{0.16f, 0.19f, 0.24f};
  Colour bottom_srgb{0.05f, 0.06f, 0.08f};
};

struct CaptionDef {
  bool on = true;
  std::string font = "DejaVu Sans";
  float size_px = 22.0f;  ///< title; the other lines are 0.72 of it
  Colour colour_srgb{0.96f, 0.96f, 0.94f};
  bool timeBar = true;
  std::string credit = "Training illustration, not for diagnosis";
};

/// Removes every point with normal . p > offset from the structures it applies to.
struct ClipRule {
  Vec3 normal{1, 0, 0};
  double offset_m = 0;
  std::vector<std::string> only{};    ///< structures cut; empty = all
  std::vector<std::string> except{};  ///< structures left whole
  bool cap = true;                    ///< fill the cut with the section colour
};

enum class Projection { perspective, orthographic };
enum class Style { surface, fluoro };

/// One fixed camera with its cutaway, framing its subject over the whole clip.
struct ViewDef {
  std::string captionTitle;
  Style style = Style::surface;
  Projection projection = Projection::perspective;
  Vec3 eye_m{0.25, -0.25, 0.1}, target_m{0, 0, -0.05}, up{0, 0, 1};
  double fovY_rad = 0.5;        ///< perspective: full vertical angle
  float referenceDepth = 2.5f;  ///< fluoro: optical depth of the exposure; 2.5 = 115 mm soft tissue
  double orthoHeight_m = 0.16;  ///< orthographic: metres over the picture's height
  std::vector<ClipRule> cuts;   ///< at most 3 may apply to one structure
  std::vector<std::string> hidden;       ///< structures not drawn
  std::map<std::string, float> ghosted;  ///< structure -> opacity 0..1
  /// Structure -> least visible pixels in a picture of 720 lines, in every frame; see
  /// Renderer::lost. "bolus" counts while more than half of it is above the esophageal sphincter,
  /// "bolus_in_mouth" while more than half is before the ramus; both for 5 mL, less for less.
  std::map<std::string, int> shows{};
};

/// Simulated videofluoroscopy, style fluoro: the machine and its screen. What tissues attenuate is
/// physics and stands in xray.h.
struct FluoroDef {
  bool body = true;  ///< soft tissue around the scene; false: bodies stand in air
  /// Quanta detected behind the view's reference depth in one frame: 40 nGy at the detector
  /// (assumed 20..100) times 30174 quanta / (mm2 uGy) (IEC 62220-1, RQA5) times DQE 0.65 (assumed).
  /// 0 = no noise.
  float quanta_per_m2 = 785e6f;
  float scatterToPrimary = 0.4f;   ///< at the reference depth, behind a grid; assumed 0.2..0.8
  float scatterRadius_m = 22e-3f;  ///< standard deviation of its spread; assumed 15..40 mm
  float blur_m = 0.30e-3f;         ///< light spread in CsI and focal spot; assumed 0.2..0.5 mm
  float fieldWidth_m = 0.165f, fieldHeight_m = 0.150f;  ///< collimated field; 0 = all open
  float fieldCorner_m = 0.012f, penumbra_m = 1.2e-3f;
  float white = -1.25f, black = 0.85f;  ///< ends of the screen's window about that depth
  float equalisation = 0.35f;           ///< share of smooth depth taken off, 0..1; assumed
  float gamma = 1.15f;                  ///< of the screen curve
  bool boneDark = true;                 ///< absorbers dark, as on a fluoroscopy screen
};

/// Bolus consistencies by apparent viscosity at 50 1/s: < 0.05, 0.35, 1.75 Pa.s and above (National
/// Dysphagia Diet 2002).
inline constexpr const char* kConsistencies[] = {"thin", "nectar", "honey", "pudding"};
const char* consistencyOf(double viscosity_Pas);

struct RenderPreset {
  std::string name = "training";
  int width = 1280, height = 720;  ///< even (4:2:0 video)
  double fps = 30;                 ///< >= 30: pulse rate changes scores (Bonilha 2013)
  bool smoothEdges = true;         ///< edges.h
  float exposure = 1.0f;
  bool toneMap = true;                ///< soft highlight shoulder; false = clamp
  float sectionOutline_m = 0.35e-3f;  ///< width of the line around caps, 0 = none
  float sectionOutlineDarkness = 0.55f;
  float creaseAngle_rad = 0.87f;  ///< edges sharper than this keep a hard shade

  std::map<std::string, Material> materials;   ///< by material name (muscle, bone, ...)
  std::map<std::string, Material> structures;  ///< by structure name; goes before `materials`
  Material fallback;                           ///< for unknown materials
  Material bolus;                              ///< where no consistency has a look of its own
  std::map<std::string, Material> bolusByConsistency;  ///< by word of kConsistencies
  std::map<std::string, Colour> palette;               ///< colours by name, as the files use them
  std::vector<std::string> sectionPriority;  ///< who wins where sections overlap, first wins

  LightDef light;
  AoDef ao;
  BackgroundDef background;
  CaptionDef caption;
  FluoroDef fluoro;
  std::map<std::string, ViewDef> views;

  /// The look of a structure: by name, else by material, else the fallback.
  const Material& materialFor(const std::string& structure, const std::string& material) const;
  const Material& bolusFor(double viscosity_Pas) const;
  /// "" when usable, else what is wrong (odd size, fps < 30, zero direction ...).
  std::string validate() const;
};
}  // namespace swallowclip::render
