// SPDX-License-Identifier: MIT
#include "scene/anatomy_file.h"

#include <algorithm>

#include "scene/json_reader.h"

namespace swallowclip::scene {
namespace {
using namespace anatomy;

constexpr double kRadPerDeg = kPi / 180;
constexpr double kFar_mm = 300;  // nothing of a head and neck lies farther from the PNS

const std::vector<std::string> kCarriers{"skull",   "mandible",   "hyoid",      "thyroid",
                                         "cricoid", "arytenoidL", "arytenoidR", "epiglottis"};
const std::vector<std::string> kMaterials{"bone", "cartilage", "enamel", "mucosa", "muscle"};

int wordIndex(const std::vector<std::string>& words, const std::string& word) {
  const auto it = std::find(words.begin(), words.end(), word);
  return it == words.end() ? 0 : static_cast<int>(it - words.begin());
}

Carrier carrier(const JsonNode& node, const char* key) {
  return static_cast<Carrier>(wordIndex(kCarriers, node.choice(key, kCarriers, "skull")));
}

double length(const JsonNode& node, const char* key, double min_mm, double max_mm,
              double default_m) {
  return node.number(key, min_mm, max_mm, default_m / kMetrePerMm) * kMetrePerMm;
}

Vec3 point(const JsonNode& node, const char* key) {
  return node.vec3(key) * kMetrePerMm;
}

std::vector<Vec2> curve(const JsonNode& node, const char* key) {
  std::vector<Vec2> points = node.points2(key);
  for (Vec2& p : points) p *= kMetrePerMm;
  return points;
}

StationDef station(const JsonNode& node, bool half) {
  StationDef s;
  s.at_m = point(node, "at_mm");
  s.u_m = point(node, "u_mm");
  s.v_m = point(node, "v_mm");
  s.exponent = node.number("exponent", 1, 8, s.exponent);
  s.curl_m = length(node, "curl_mm", -20, 20, s.curl_m);
  s.profile = node.text("profile", "");
  if (node.has("ridge_mm")) {
    s.ridge_m = length(node, "ridge_mm", -20, 30, 0);
    s.ridgeHalfWidth_m = length(node, "ridge_half_width_mm", 1, 60, s.ridgeHalfWidth_m);
  }
  if (s.u_m.norm() == 0 || s.v_m.norm() == 0)
    node.fail("a half axis has no length", "give u_mm and v_mm");
  if (half && (s.at_m.x() != 0 || s.v_m.x() != 0 || !s.profile.empty()))
    node.fail("a half section must be centred on x = 0 with v_mm in the midplane and no profile",
              "set the x of at_mm and v_mm to 0");
  return s;
}

SweepDef sweep(const JsonNode& node) {
  const std::vector<std::string> kClosures{"midplane", "dome", "window", "loop"};
  SweepDef s;
  s.name = node.text("name");
  s.half = node.boolean("half", false);
  s.start = static_cast<Closure>(wordIndex(
      kClosures, node.choice("start", {"midplane", "dome", "window", "loop"}, "midplane")));
  s.end = static_cast<Closure>(
      wordIndex(kClosures, node.choice("end", {"midplane", "dome", "loop"}, "dome")));
  if (s.start == Closure::window) {
    s.parent = node.text("parent");
    const std::vector<double> rows = node.numbers("window_stations");
    const std::vector<double> angles = node.numbers("window_deg");
    if (rows.size() == 2 && angles.size() == 2)
      s.window = {rows[0], rows[1], angles[0] * kRadPerDeg, angles[1] * kRadPerDeg};
    else
      node.fail("window_stations and window_deg need two numbers each", "give from and to");
  }
  s.ringPoints = node.integer("ring_points", 5, 64, s.ringPoints);
  s.edge_m = length(node, "edge_mm", 0.5, 40, s.edge_m);
  s.startDome_m = length(node, "start_dome_mm", 0, 20, s.startDome_m);
  s.endDome_m = length(node, "end_dome_mm", 0, 20, s.endDome_m);
  for (const JsonNode& n : node.array("stations")) s.stations.push_back(station(n, s.half));
  return s;
}

PartDef part(const JsonNode& node) {
  PartDef p;
  p.name = node.text("name");
  p.material = node.choice("material", kMaterials);
  p.carrier = carrier(node, "carrier");
  p.paired = node.boolean("paired", false);
  if (node.has("follows")) p.follows = node.texts("follows");
  if (p.paired) p.carrierRight = carrier(node, "carrier_right");
  for (const JsonNode& n : node.array("sweeps")) p.sweeps.push_back(sweep(n));
  return p;
}

DentalArchDef arch(const JsonNode& node) {
  const std::vector<std::string> kKinds{"incisor", "canine", "premolar", "molar"};
  DentalArchDef a;
  a.name = node.text("name");
  a.carrier = carrier(node, "carrier");
  a.upper = node.boolean("upper", true);
  a.root_m = length(node, "root_mm", 0.5, 15, a.root_m);
  a.lingualPlan_m = curve(node, "lingual_plan_xy_mm");
  for (const JsonNode& n : node.array("teeth")) {
    ToothDef t;
    t.kind = static_cast<ToothKind>(wordIndex(kKinds, n.choice("kind", kKinds)));
    t.width_m = length(n, "width_mm", 3, 15, t.width_m);
    t.depth_m = length(n, "depth_mm", 3, 15, t.depth_m);
    t.height_m = length(n, "height_mm", 3, 15, t.height_m);
    t.tipZ_m = length(n, "tip_z_mm", -kFar_mm, kFar_mm, t.tipZ_m);
    t.lean_rad = n.number("lean_deg", -45, 45, 0) * kRadPerDeg;
    a.teeth.push_back(t);
  }
  a.gumName = node.text("gum", "");
  a.gumMargin_m = length(node, "gum_margin_mm", 0, 6, a.gumMargin_m);
  return a;
}

PalateDef palate(const JsonNode& node) {
  PalateDef p;
  p.name = node.text("name");
  p.oralMidline_m = curve(node, "oral_midline_yz_mm");
  p.halfWidth_m = curve(node, "half_width_yw_mm");
  p.nasalFloor_m = curve(node, "nasal_floor_yz_mm");
  p.lingualPlan_m = curve(node, "lingual_plan_xy_mm");
  p.frontRim_m = curve(node, "front_rim_mm");
  p.backRim_m = curve(node, "back_rim_mm");
  p.mucosa_m = length(node, "mucosa_mm", 0.2, 5, p.mucosa_m);
  p.archDrop_m = length(node, "arch_drop_mm", 0, 30, p.archDrop_m);
  p.archExponent = node.number("arch_exponent", 1, 8, p.archExponent);
  p.lowest_m = length(node, "lowest_mm", -60, 0, p.lowest_m);
  p.fanFront_m = length(node, "fan_front_mm", -60, 0, p.fanFront_m);
  p.sections = node.integer("sections", 4, 100, p.sections);
  p.mucosaName = node.text("mucosa", "");
  if (node.has("rugae_y_mm"))
    for (double y : node.numbers("rugae_y_mm")) p.rugaeY_m.push_back(y * kMetrePerMm);
  p.rugaDepth_m = length(node, "ruga_depth_mm", 0, 2, p.rugaDepth_m);
  return p;
}

LandmarkDef landmark(const std::string& name, const JsonNode& node) {
  LandmarkDef l;
  l.name = name;
  if (node.has("at_mm")) {
    l.rule = LandmarkDef::Rule::fixed;
    l.value = point(node, "at_mm");
    return l;
  }
  l.structure = node.text("structure");
  if (node.has("near_mm")) {
    l.value = point(node, "near_mm");
    l.midplane = l.value.x() == 0;
  } else if (node.has("extreme")) {
    l.rule = LandmarkDef::Rule::extreme;
    l.value = node.vec3("extreme");
    l.midplane = node.boolean("midplane", false);
  } else {
    l.rule = LandmarkDef::Rule::midCentre;
    if (!node.boolean("mid_centre", false))
      node.fail("no rule for this landmark", "give at_mm, near_mm, extreme or mid_centre");
  }
  return l;
}
}  // namespace

Result<AnatomyDef> loadAnatomyDef(const std::filesystem::path& path) {
  auto file = JsonFile::load(path);
  if (!file) return std::unexpected(file.error());
  const JsonNode root = file->root();
  AnatomyDef def;
  def.name = root.text("name");
  for (const auto& [name, node] : root.object("profiles").members()) {
    std::vector<Vec2> points;
    for (const JsonNode& p : node.asArray()) {
      const std::vector<double> ab = p.asNumbers();
      if (ab.size() != 2)
        p.fail("a profile point has two numbers", "give [a, b]");
      else
        points.push_back({ab[0], ab[1]});
    }
    if (points.size() < 4) node.fail("a profile needs four points or more", "add points");
    def.profiles[name] = points;
  }
  def.palate = palate(root.object("maxilla"));
  for (const JsonNode& n : root.array("dental_arches")) def.arches.push_back(arch(n));
  for (const JsonNode& n : root.array("parts")) {
    def.parts.push_back(part(n));
    for (const SweepDef& s : def.parts.back().sweeps)
      for (const StationDef& st : s.stations)
        if (!st.profile.empty() && !def.profiles.count(st.profile))
          n.fail("there is no profile \"" + st.profile + "\"", "add it to \"profiles\"");
  }
  for (const auto& [name, node] : root.object("landmarks").members())
    def.landmarks.push_back(landmark(name, node));
  if (auto done = file->finish(); !done) return std::unexpected(done.error());
  return def;
}
}  // namespace swallowclip::scene
