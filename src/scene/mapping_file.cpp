// SPDX-License-Identifier: MIT
#include "scene/mapping_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <utility>

#include "core/digest.h"
#include "core/file.h"
#include "scene/json_reader.h"

namespace swallowclip::scene {
namespace fs = std::filesystem;
using namespace anatomy;
namespace {

constexpr int kSceneVersion = 1;
constexpr int kMaxFrames = 10000;  ///< of a sequence; 5 minutes at 34/s, assumed

const std::vector<std::string> kCarriers{"skull",   "mandible",   "hyoid",      "thyroid",
                                         "cricoid", "arytenoidL", "arytenoidR", "epiglottis"};
const std::vector<std::string> kMaterials{"muscle", "mucosa", "bone", "cartilage", "enamel"};

std::size_t indexOf(const std::vector<std::string>& words, const std::string& word) {
  return std::size_t(std::find(words.begin(), words.end(), word) - words.begin());
}

/// What a rigid structure rides on when the mapping doesn't say: by the beginning of its name.
std::string usualCarrier(const std::string& name) {
  if (name.starts_with("arytenoid"))
    return name.ends_with("R") || name.ends_with("right") ? "arytenoidR" : "arytenoidL";
  if (name.starts_with("lower_teeth")) return "mandible";
  for (const std::string& c : kCarriers)
    if (name.starts_with(c)) return c;
  return "skull";
}

AxesDef readAxes(const JsonNode& root) {
  AxesDef axes;
  if (!root.has("axes")) return axes;
  const JsonNode node = root.object("axes");
  static const std::vector<std::string> words{"left",     "right",    "posterior",
                                              "anterior", "superior", "inferior"};
  axes.guess = false;
  axes.oursFromFile.setZero();
  const char* keys[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    const std::size_t word = indexOf(words, node.choice(keys[k], words));
    if (word < words.size()) axes.oursFromFile(Eigen::Index(word / 2), k) = word % 2 ? -1 : 1;
  }
  if (std::abs(axes.oursFromFile.determinant()) < 0.5)
    node.fail("two axes name the same direction",
              "Give one of left/right, posterior/anterior and superior/inferior to each.");
  return axes;
}

/// A path inside the source folder; anything else is refused.
void checkInside(const JsonNode& node, const std::string& file) {
  const fs::path path(file);
  bool inside = path.is_relative() && !file.empty();
  for (const fs::path& part : path) inside = inside && part != "..";
  const std::size_t percent = path.filename().string().find('%');
  if (!inside)
    node.fail(fmt::format("\"{}\" is not inside the source folder", file), "Name files in it.");
  else if (percent != std::string::npos) {
    const std::string name = path.filename().string();
    const std::size_t end = name.find_first_not_of("0123456789", percent + 1);
    if (end == std::string::npos || name[end] != 'd' || file.find('%') != file.rfind('%'))
      node.fail(fmt::format("\"{}\" is no pattern", file), "Write the number as %d or %04d, once.");
  }
}

ImportStructureDef readStructure(const JsonNode& node) {
  ImportStructureDef s;
  if (node.has("file")) s.files = {node.text("file")};
  if (node.has("files")) {
    if (node.has("file")) node.fail("has both \"file\" and \"files\"", "Keep one of them.");
    s.files = node.texts("files");
  }
  if (int(s.files.size()) > kMaxFrames)
    node.fail(fmt::format("more than {} frames", kMaxFrames), "Cut the sequence.");
  for (const std::string& f : s.files) checkInside(node, f);
  if (s.files.size() > 1)
    for (const std::string& f : s.files)
      if (f.find('%') != std::string::npos)
        node.fail("a pattern stands alone", "Use \"file\" for it.");
  s.object = node.text("object", "");
  s.name = node.text("structure");
  if (s.name.empty() || s.name.size() > 64 ||
      s.name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") !=
          std::string::npos)
    node.fail(fmt::format("\"{}\" can't be a structure's name", s.name),
              "Use letters, digits and _, as in soft_palate or arytenoid_L.");
  s.rigid = node.choice("kind", {"rigid", "wall"}) == "rigid";
  s.material = node.choice("material", kMaterials, s.rigid ? "bone" : "mucosa");
  const std::size_t carrier =
      indexOf(kCarriers, node.choice("carrier", kCarriers, usualCarrier(s.name)));
  s.carrier = carrier < kCarriers.size() ? Carrier(carrier) : Carrier::skull;
  const std::string half = node.choice("half", {"left", "right", "whole", "guess"}, "guess");
  s.half = half == "left"    ? HalfSide::left
           : half == "right" ? HalfSide::right
           : half == "whole" ? HalfSide::whole
                             : HalfSide::guess;
  const std::string closure =
      node.choice("closure", {"repair", "draw_only", "require_closed"}, "require_closed");
  s.closure = closure == "repair"      ? SurfaceClosure::repair
              : closure == "draw_only" ? SurfaceClosure::drawOnly
                                       : SurfaceClosure::requireClosed;
  return s;
}

std::map<std::string, Vec3> readLandmarks(const JsonNode& root) {
  std::map<std::string, Vec3> landmarks;
  if (!root.has("landmarks_mm")) return landmarks;
  for (const auto& [name, node] : root.object("landmarks_mm").members()) {
    if (node.isText()) continue;  // comment, source
    const std::vector<double> x = node.asNumbers();
    if (x.size() != 3 || !std::isfinite(x[0] + x[1] + x[2]))
      node.fail(fmt::format("landmark {} needs three numbers", name), "Write [x, y, z] in mm.");
    else
      landmarks[name] = Vec3(x[0], x[1], x[2]) * kMetrePerMm;
  }
  return landmarks;
}
}  // namespace

Result<ImportDef> loadMapping(const fs::path& path) {
  auto file = JsonFile::load(path);
  if (!file) return std::unexpected(file.error());
  const JsonNode root = file->root();
  ImportDef def;
  const std::string unit = root.choice("unit", {"mm", "cm", "m", "guess"}, "guess");
  def.unit = unit == "mm"   ? LengthUnit::mm
             : unit == "cm" ? LengthUnit::cm
             : unit == "m"  ? LengthUnit::m
                            : LengthUnit::guess;
  bool axesAreGuessed = false;
  for (const auto& [key, node] : root.members())
    if (key == "axes" && node.isText()) {
      axesAreGuessed = true;
      if (node.asText() != "guess")
        node.fail("\"axes\" is neither \"guess\" nor a table", "Write {\"x\": \"left\", ...}.");
    } else if (static const std::set<std::string> known{
                   "unit", "axes", "origin_mm", "stitch_tolerance_mm", "start_s", "rate_hz",
                   "landmarks_mm", "structures", "comment", "source"};
               !known.contains(key)) {
      const std::string near = nearestName(key, {known.begin(), known.end()});
      node.fail(fmt::format("unknown key \"{}\"", key),
                near.empty() ? "Remove it." : "Did you mean \"" + near + "\"?");
    }
  if (!axesAreGuessed) def.axes = readAxes(root);
  def.origin_m = root.vec3("origin_mm", Vec3::Zero()) * kMetrePerMm;
  def.stitchTolerance_m =
      root.number("stitch_tolerance_mm", 0, 5, def.stitchTolerance_m / kMetrePerMm) * kMetrePerMm;
  def.start_s = root.number("start_s", -60, 60, def.start_s);
  def.rate_hz = root.number("rate_hz", 1, 1000, def.rate_hz);
  def.landmarks = readLandmarks(root);
  std::set<std::string> names;
  for (const JsonNode& node : root.array("structures")) {
    def.structures.push_back(readStructure(node));
    if (!names.insert(def.structures.back().name).second)
      node.fail(fmt::format("structure \"{}\" is there twice", def.structures.back().name),
                "Give each its own name.");
  }
  if (auto done = file->finish(); !done) return std::unexpected(done.error());
  return def;
}

// ---- imported scenes on disk ----
namespace {
std::string plyHeader(std::size_t vertices, std::size_t triangles) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment swallowclip, metres\nelement "
      "vertex {}\nproperty double x\nproperty double y\nproperty double z\nelement "
      "face {}\nproperty list uchar int vertex_indices\nend_header\n",
      vertices, triangles);
}

/// Little-endian machines only, like the rest of the program (x86-64, ARM64).
std::string plyBytes(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles) {
  std::string bytes = plyHeader(positions.size(), triangles.size());
  for (const Vec3& p : positions) bytes.append(reinterpret_cast<const char*>(p.data()), 24);
  for (const Triangle& t : triangles) {
    bytes.push_back(3);
    bytes.append(reinterpret_cast<const char*>(t.data()), 12);
  }
  return bytes;
}

/// Only what plyBytes writes; scene.json tells the counts.
Result<TriMesh> readPly(const fs::path& path, int vertices, int triangles) {
  const auto bytes = readFile(path);
  if (!bytes) return std::unexpected(bytes.error());
  const std::string header = plyHeader(std::size_t(vertices), std::size_t(triangles));
  const std::size_t needed =
      header.size() + std::size_t(vertices) * 24 + std::size_t(triangles) * 13;
  const char* remedy = "Import the scene again.";
  if (!bytes->starts_with(header) || bytes->size() != needed)
    return usageError(path.string(),
                      fmt::format("is not the mesh of {} vertices and {} triangles ({} bytes) that "
                                  "scene.json names",
                                  vertices, triangles, needed),
                      remedy);
  TriMesh mesh;
  mesh.positions.resize(std::size_t(vertices));
  mesh.triangles.resize(std::size_t(triangles));
  const char* at = bytes->data() + header.size();
  for (Vec3& p : mesh.positions) std::memcpy(p.data(), std::exchange(at, at + 24), 24);
  for (Triangle& t : mesh.triangles) std::memcpy(t.data(), std::exchange(at, at + 13) + 1, 12);
  for (const Vec3& p : mesh.positions)
    if (!p.allFinite())
      return usageError(path.string(), "has a coordinate that is no number", remedy);
  for (const Triangle& t : mesh.triangles)
    for (int v : t)
      if (v < 0 || v >= vertices)
        return usageError(path.string(), fmt::format("a triangle names vertex {}", v), remedy);
  return mesh;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto u = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      (out += '\\') += c;
    else if (u < 0x20)
      out += fmt::format("\\u{:04x}", u);
    else
      out += u < 0x80 ? c : '?';  // file names in report lines need not be UTF-8
  }
  return out + "\"";
}

std::string frameFile(const std::string& name, std::size_t frame, bool isSequence) {
  return isSequence ? fmt::format("{}_{:04d}.ply", name, frame) : name + ".ply";
}
}  // namespace

Result<void> saveImportedScene(const ImportedScene& scene, const fs::path& folder) {
  if (auto ready = prepareFolder(folder); !ready) return ready;
  std::vector<std::pair<std::string, std::string>> files;
  std::string list, digests;
  for (const Structure& s : scene.anatomy.structures) {
    const ImportedSequence* sequence = nullptr;
    for (const ImportedSequence& q : scene.sequences)
      if (q.name == s.name) sequence = &q;
    const std::size_t frames = sequence ? sequence->frames.size() : 1;
    for (std::size_t k = 0; k < frames; ++k) {
      const auto& positions = sequence ? sequence->frames[k] : s.mesh.positions;
      files.emplace_back(frameFile(s.name, k, sequence), plyBytes(positions, s.mesh.triangles));
      digests += files.back().first + sha256Hex(files.back().second);
    }
    list += fmt::format(
        "{}    {{\"structure\": {}, \"material\": {}, \"kind\": \"{}\", \"carrier\": \"{}\", "
        "\"draw_only\": {}, \"vertices\": {}, \"triangles\": {}, \"frames\": {}}}",
        list.empty() ? "" : ",\n", quoted(s.name), quoted(s.material), s.rigid ? "rigid" : "wall",
        kCarriers[std::size_t(s.carrier)], s.drawOnly, s.mesh.positions.size(),
        s.mesh.triangles.size(), frames);
  }
  const std::string meshes = "meshes-" + sha256Hex(digests).substr(0, 12);
  if (auto ready = prepareFolder(folder / meshes); !ready) return ready;
  for (const auto& [name, bytes] : files)
    if (auto written = writeFile(folder / meshes / name, bytes); !written) return written;
  std::string landmarks, report;
  for (const auto& [name, p_m] : scene.anatomy.landmarks) {
    const Vec3 p = p_m / kMetrePerMm;
    landmarks += fmt::format("{}    {}: [{}, {}, {}]", landmarks.empty() ? "" : ",\n", quoted(name),
                             p.x(), p.y(), p.z());
  }
  for (const std::string& line : scene.report)
    report += (report.empty() ? "    " : ",\n    ") + quoted(line);
  const std::string json = fmt::format(
      "{{\n  \"kind\": \"imported\",\n  \"version\": {},\n  \"meshes\": \"{}\",\n  \"start_s\": "
      "{},\n  "
      "\"rate_hz\": {},\n  \"structures\": [\n{}\n  ],\n  \"landmarks_mm\": {{\n{}\n  }},\n  "
      "\"report\": [\n{}\n  ]\n}}\n",
      kSceneVersion, meshes, scene.start_s, scene.rate_hz, list, landmarks, report);
  if (auto written = writeFile(folder / "scene.json", json); !written) return written;
  // the new scene stands: folders of former ones are waste
  std::error_code ec;
  std::vector<fs::path> former;
  for (const auto& entry : fs::directory_iterator(folder, ec)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_directory(ec) && name.size() == meshes.size() && name.starts_with("meshes-") &&
        name != meshes)
      former.push_back(entry.path());
  }
  for (const fs::path& path : former) fs::remove_all(path, ec);
  return {};
}

Result<ImportedScene> loadImportedScene(const fs::path& folder) {
  auto file = JsonFile::load(folder / "scene.json");
  if (!file) return std::unexpected(file.error());
  const JsonNode root = file->root();
  root.choice("kind", {"imported"});
  root.integer("version", kSceneVersion, kSceneVersion);
  const std::string meshes = root.text("meshes");
  if (!meshes.starts_with("meshes-") || meshes.find('/') != std::string::npos)
    root.fail("\"meshes\" names no mesh folder", "Import the scene again.");
  ImportedScene scene;
  scene.start_s = root.number("start_s", -60, 60);
  scene.rate_hz = root.number("rate_hz", 1, 1000);
  scene.anatomy.landmarks = readLandmarks(root);
  scene.report = root.texts("report");
  struct Counts {
    int vertices, triangles, frames;
  };
  std::vector<Counts> counts;
  for (const JsonNode& node : root.array("structures")) {
    const ImportStructureDef d = readStructure(node);
    Structure s;
    s.name = d.name, s.material = d.material, s.rigid = d.rigid, s.carrier = d.carrier;
    s.drawOnly = node.boolean("draw_only", false);
    counts.push_back({node.integer("vertices", 3, 1 << 28), node.integer("triangles", 1, 1 << 28),
                      node.integer("frames", 1, kMaxFrames)});
    scene.anatomy.structures.push_back(std::move(s));
  }
  if (auto done = file->finish(); !done) return std::unexpected(done.error());
  for (std::size_t i = 0; i < counts.size(); ++i) {
    Structure& s = scene.anatomy.structures[i];
    const auto [vertices, triangles, frames] = counts[i];
    ImportedSequence sequence{.name = s.name, .frames = {}};
    for (int k = 0; k < frames; ++k) {
      const fs::path path = folder / meshes / frameFile(s.name, std::size_t(k), frames > 1);
      auto mesh = readPly(path, vertices, triangles);
      if (!mesh) return std::unexpected(mesh.error());
      if (k == 0) s.mesh = *mesh;
      if (mesh->triangles != s.mesh.triangles)
        return usageError(path.string(), "has other triangles than frame 0",
                          "Import the scene again.");
      sequence.frames.push_back(std::move(mesh->positions));
    }
    if (frames > 1) scene.sequences.push_back(std::move(sequence));
  }
  return scene;
}

bool isImportedScene(const fs::path& folder) {
  auto file = JsonFile::load(folder / "scene.json");
  return file && file->root().isObject() && file->root().text("kind", "") == "imported";
}

Result<ImportedScene> importScene(const fs::path& source, const fs::path& mapping,
                                  const fs::path& out) {
  const auto def = loadMapping(mapping);
  if (!def) return std::unexpected(def.error());
  auto scene = importMeshes(source, *def);
  if (!scene) return scene;
  if (auto saved = saveImportedScene(*scene, out); !saved) return std::unexpected(saved.error());
  return scene;
}
}  // namespace swallowclip::scene
