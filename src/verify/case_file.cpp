// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "bolus/tension.h"
#include "scene/bolus_file.h"
#include "scene/json_reader.h"
#include "verify/case.h"
#include "verify/domain.h"
#include "verify/fill.h"
#include "verify/read_checks.h"
#include "verify/references.h"

namespace swallowclip::verify {
namespace {
using scene::JsonFile;
using scene::JsonNode;
constexpr double kMm = 1e-3;
// Millimetres to decimetres: above lies what a solver for mouthfuls was not made for.
constexpr double kLargest_mm = 1000, kSmallest_mm = 0.01;
constexpr double kFastest_mms = 1e5;
constexpr std::size_t kMostSamples = 1000, kMostRefinements = 5;

Vec3 sizes(const JsonNode& node, const char* key) {
  const Vec3 v = node.vec3(key);
  if (node.exists() && !(v.minCoeff() >= kSmallest_mm && v.maxCoeff() <= kLargest_mm))
    node.fail(fmt::format("\"{}\" must lie within {} and {} mm", key, kSmallest_mm, kLargest_mm),
              "Check value and unit.");
  return v * kMm;
}

double length(const JsonNode& node, const char* key) {
  return node.number(key, kSmallest_mm, kLargest_mm) * kMm;
}

DomainDef readDomain(const JsonNode& node, const std::filesystem::path& folder) {
  DomainDef d;
  const std::string shape = node.choice("shape", {"none", "box", "cylinder", "tube", "mesh"});
  if (shape == "none") return d;
  if (shape == "box") {
    d.shape = Shape::box;
    d.size_m = sizes(node, "size_mm");
    const std::string axes = node.text("periodic", "");
    for (char c : axes) {
      if (c < 'x' || c > 'z')
        node.fail(fmt::format("\"periodic\": \"{}\" names an axis other than x, y, z", axes),
                  "Give \"x\", \"xy\", \"xyz\" ...");
      else
        d.periodic[c - 'x'] = true;
    }
  } else if (shape == "cylinder" || shape == "tube") {
    d.shape = shape == "tube" ? Shape::tube : Shape::cylinder;
    d.radius_m = length(node, "radius_mm");
    d.length_m = length(node, d.shape == Shape::tube ? "length_mm" : "height_mm");
    d.periodic[0] = d.shape == Shape::tube;
  } else {
    d.shape = Shape::mesh;
    d.file = node.text("file");
    if (d.file.is_relative()) d.file = folder / d.file;
    const std::string unit = node.choice("unit", {"mm", "cm", "m"});
    d.metresPerUnit = unit == "mm" ? 1e-3 : unit == "cm" ? 1e-2 : 1;
  }
  d.tilt_rad = node.number("tilt_deg", -180, 180, 0) * kPi / 180;
  if (d.tilt_rad != 0 && (d.periodic[0] || d.periodic[1] || d.periodic[2]))
    node.fail("a periodic domain cannot be tilted: its periods run along x, y and z",
              "Turn gravity_ms2 instead.");
  if (node.has("edge_mm")) d.edge_m = length(node, "edge_mm");
  return d;
}

/// "speed_mms" (with "ramp_s"), or "speeds": [[t_s, mms], ...]; `unit` in SI per file unit.
SpeedProfile readSpeed(const JsonNode& node, const char* key, double unit) {
  SpeedProfile p;
  if (node.has("speeds")) {
    for (const Vec2& v : node.points2("speeds")) p.points.emplace_back(v.x(), v.y() * unit);
    for (std::size_t k = 1; k < p.points.size(); ++k)
      if (!(p.points[k].first > p.points[k - 1].first))
        node.fail("\"speeds\": the times do not rise", "Sort the points by time.");
    if (p.points.empty()) node.fail("\"speeds\" is empty", "Give [time, speed] points.");
    return p;
  }
  const double speed = node.number(key, -kFastest_mms, kFastest_mms) * unit;
  const double ramp_s = node.number("ramp_s", 0, 100, 0);
  if (ramp_s > 0) p.points.emplace_back(0.0, 0.0);
  p.points.emplace_back(ramp_s, speed);
  return p;
}

MotionDef readMotion(const JsonNode& node, const DomainDef& domain) {
  MotionDef m;
  const std::string kind =
      node.choice("kind", {"still", "slide", "piston", "close", "rotate", "peristalsis"});
  const auto needs = [&](bool good, const char* what) {
    if (node.exists() && !good)
      node.fail(fmt::format("motion \"{}\" needs {}", kind, what), "Change domain or motion.");
  };
  const auto face = [&] {
    const std::string part = node.choice("part", {"-x", "+x", "-y", "+y", "-z", "+z"});
    m.high = part[0] == '+';
    m.axis = part[1] - 'x';
    needs(domain.shape == Shape::cylinder ? m.axis == 2
                                          : domain.shape == Shape::box && !domain.periodic[m.axis],
          "a face of a box, or -z or +z of a cylinder, that is not periodic");
  };
  if (kind == "slide") {
    m.kind = MotionKind::slide;
    face();
    m.velocity_ms = node.vec3("velocity_mms") * kMm;
    needs(std::abs(m.velocity_ms[m.axis]) == 0, "a velocity along the face");
  } else if (kind == "piston") {
    m.kind = MotionKind::piston;
    face();
    m.speed = readSpeed(node, "speed_mms", kMm);
  } else if (kind == "close") {
    m.kind = MotionKind::close;
    m.axis = 2;
    needs(domain.shape == Shape::cylinder || (domain.shape == Shape::box && !domain.periodic[2]),
          "a box or cylinder with walls at both ends of z");
    m.speed = readSpeed(node, "speed_mms", kMm);
  } else if (kind == "rotate") {
    m.kind = MotionKind::rotate;
    needs(domain.shape == Shape::cylinder, "a cylinder");
    m.speed = readSpeed(node, "rate_rads", 1);
  } else if (kind == "peristalsis") {
    m.kind = MotionKind::peristalsis;
    needs(domain.shape == Shape::tube ||
              (domain.shape == Shape::box && domain.periodic[0] && !domain.periodic[2]),
          "a tube, or a box periodic along x with walls at both ends of z");
    m.speed = readSpeed(node, "speed_mms", kMm);
    m.occlusion = node.number("occlusion", 0, 0.95);
    m.waves = node.integer("waves", 1, 20, 1);
  }
  if (m.kind != MotionKind::still && domain.tilt_rad != 0)
    node.fail("walls that move cannot be tilted", "Turn gravity_ms2 instead.");
  return m;
}

std::vector<FillDef> readFill(const JsonNode& root) {
  std::vector<FillDef> fills;
  for (const JsonNode& node : root.array("fill")) {
    FillDef f;
    f.place = node.place();
    const std::string kind = node.choice("kind", {"domain", "block", "sphere", "cylinder"});
    if (kind == "block") {
      f.kind = FillKind::block;
      f.low_m = node.vec3("low_mm") * kMm;
      f.size_m = sizes(node, "size_mm");
    } else if (kind == "sphere") {
      f.kind = FillKind::sphere;
      f.low_m = node.vec3("centre_mm") * kMm;
      f.radius_m = length(node, "radius_mm");
    } else if (kind == "cylinder") {
      f.kind = FillKind::cylinder;
      f.low_m = node.vec3("base_mm") * kMm;
      f.radius_m = length(node, "radius_mm");
      f.size_m.z() = length(node, "height_mm");
    }
    f.velocity_ms = node.vec3("velocity_mms", Vec3::Zero()) * kMm;
    fills.push_back(f);
  }
  if (root.exists() && fills.empty()) root.fail("\"fill\" is empty", "Say where the fluid is.");
  return fills;
}

void readStart(const JsonNode& root, CaseDef& def) {
  if (!root.has("start")) return;
  const JsonNode node = root.object("start");
  const std::string kind = node.choice("kind", {"rest", "rotation", "taylor-green"});
  if (kind == "rotation") {
    def.start = StartKind::rotation;
    def.startRate = node.number("rate_rads", -1e4, 1e4);
  } else if (kind == "taylor-green") {
    def.start = StartKind::taylorGreen;
    def.startRate = node.number("speed_mms", 0, kFastest_mms) * kMm;
    if (def.domain.shape != Shape::box || !def.domain.periodic[0] || !def.domain.periodic[1])
      node.fail("taylor-green needs a box periodic along x and y", "Change \"periodic\".");
  }
}

void readTimes(const JsonNode& root, CaseDef& def) {
  def.duration_s = root.number("duration_s", 1e-6, 100);
  if (root.has("samples_s")) def.samples_s = root.numbers("samples_s");
  if (root.has("every_s")) {
    const double every = root.number("every_s", def.duration_s / kMostSamples, def.duration_s);
    for (int k = 1;
         k * every <= def.duration_s * (1 + 1e-12) && def.samples_s.size() < kMostSamples; ++k)
      def.samples_s.push_back(std::min(k * every, def.duration_s));
  }
  if (def.samples_s.empty()) def.samples_s = {def.duration_s};
  bool good = def.samples_s.size() <= kMostSamples;
  double before = 0;
  for (double t : def.samples_s) good = good && t > before && t <= def.duration_s, before = t;
  if (!good)
    root.fail(fmt::format("\"samples_s\" must rise, from above 0 to {} s at most, {} of them",
                          def.duration_s, kMostSamples),
              "Correct samples_s or duration_s.");
  def.average_s = root.number("average_s", 0, def.duration_s, 0);
}

void readSpacings(const JsonNode& root, CaseDef& def) {
  def.spacing_m = root.number("spacing_mm", 0.2, 10) * kMm;
  if (!root.has("refine_mm")) return;
  for (double mm : root.numbers("refine_mm")) {
    const double finest = def.refine_m.empty() ? 0.01 : def.refine_m.back();
    if (!(mm * kMm > def.spacing_m && mm * kMm < finest + 1e-12))
      root.fail("\"refine_mm\" must fall towards spacing_mm, 10 mm at most",
                "Give the coarser spacings, the coarsest first.");
    def.refine_m.push_back(mm * kMm);
    if (def.refine_m.size() > kMostRefinements) {
      root.fail("\"refine_mm\" has too many spacings", "Give five at most.");
      return;
    }
  }
}

Result<CaseDef> read(const JsonFile& file, const std::filesystem::path& path) {
  const JsonNode root = file.root();
  CaseDef def;
  def.file = path;
  def.name = root.text("name");
  if (root.exists() &&
      (def.name.empty() || def.name.size() > 60 ||
       def.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") != std::string::npos))
    root.fail("\"name\" must have 1 to 60 lower-case letters, digits or '-'",
              "Rename the case; the name becomes part of file names.");
  def.description = root.text("description", "");
  def.source = root.text("source", "");
  def.isShort = root.choice("subset", {"short", "long"}, "long") == "short";
  if (root.choice("type", {"flow", "kernels"}, "flow") == "kernels") {
    def.kernelsOnly = true;
    def.kernelTolerance = root.number("tolerance", 1e-12, 1);
    if (auto done = file.finish(); !done) return std::unexpected(done.error());
    return def;
  }
  def.domain = readDomain(root.object("domain"), path.parent_path());
  if (root.has("walls")) {
    const JsonNode walls = root.object("walls");
    def.slip = walls.boolean("slip", false);
    if (walls.has("motion")) def.motion = readMotion(walls.object("motion"), def.domain);
  }
  def.fluid = scene::readFluid(root.object("fluid"));
  def.gravity_ms2 = root.vec3("gravity_ms2", def.gravity_ms2);
  readSpacings(root, def);
  def.kernel = bolus::kernelFromName(root.choice("kernel",
                                                 {"cubic-spline", "lucy", "gaussian",
                                                  "quartic-spline", "wendland-c2"},
                                                 "cubic-spline"))
                   .value_or(def.kernel);
  def.solver = bolus::solverFromName(root.choice("solver", {"dfsph", "wcsph"}, "dfsph"))
                   .value_or(def.solver);
  def.fill = readFill(root);
  readStart(root, def);
  def.relax_s = root.number("relax_s", 0, 10, 0);
  readTimes(root, def);
  def.checks = readChecks(root);
  if (auto done = file.finish(); !done) return std::unexpected(done.error());
  // Errors without a place of their own are those of the file as a whole.
  auto good = checkGeometry(def);
  if (!good && good.error().place.empty()) good.error().place = root.place();
  if (!good) return std::unexpected(good.error());
  return def;
}
}  // namespace

Result<void> checkGeometry(const CaseDef& def) {
  if (def.kernelsOnly) return {};
  std::vector<double> spacings = def.refine_m;
  spacings.push_back(def.spacing_m);
  for (double spacing_m : spacings) {
    const auto domain = Domain::build(def, spacing_m);
    if (!domain) return std::unexpected(domain.error());
    if (const double least = domain->narrowest_m(); spacing_m > least)
      return usageError("",
                        fmt::format("spacing of {:.3g} mm in a domain {:.3g} mm wide",
                                    spacing_m / kMm, least / kMm),
                        "Use a spacing of a tenth of the width or less.");
    double reach_m = 2 * bolus::supportPerSpacing(def.kernel) * spacing_m;
    if (def.fluid.surfaceTension_Nm > 0)
      reach_m = std::max(reach_m, 2 * bolus::kTensionReach * spacing_m);
    for (int k = 0; k < 3; ++k)
      if (const double period_m = domain->period_m()[k]; period_m > 0 && period_m <= reach_m)
        return usageError("",
                          fmt::format("a period of {:.3g} mm, with particles that feel each other "
                                      "over {:.3g} mm on either side",
                                      period_m / kMm, reach_m / 2 / kMm),
                          fmt::format("Make it longer than {:.3g} mm.", reach_m / kMm));
    if (const auto start = fillDomain(def, *domain, spacing_m); !start)
      return std::unexpected(start.error());
  }
  for (const CheckDef& check : def.checks)
    if (!def.samples_s.empty() && check.from_s > def.samples_s.back())
      return usageError(
          "",
          fmt::format("the check of {} begins at {:.4g} s, the last sample is at {:.4g} s",
                      check.quantity.kind, check.from_s, def.samples_s.back()),
          "Give from_s a time that is looked at.");
  for (const CheckDef& check : def.checks)
    if (const auto made = makeReference(def, check.reference); !made)
      return std::unexpected(made.error());
  return {};
}

Result<CaseDef> loadCase(const std::filesystem::path& path) {
  auto file = JsonFile::load(path);
  if (!file) return std::unexpected(file.error());
  return read(*file, path);
}

Result<CaseDef> parseCase(std::string text, const std::string& name) {
  auto file = JsonFile::parse(std::move(text), name);
  if (!file) return std::unexpected(file.error());
  return read(*file, name);
}
}  // namespace swallowclip::verify
