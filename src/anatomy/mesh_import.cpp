// SPDX-License-Identifier: MIT
#include "anatomy/mesh_import.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace swallowclip::anatomy {
namespace fs = std::filesystem;
namespace {

template <class T>
bool parse(std::string_view w, T& value) {
  if (!w.empty() && w.front() == '+') w.remove_prefix(1);
  return std::from_chars(w.data(), w.data() + w.size(), value).ec == std::errc();
}

/// Where structures lie and how large they are in an adult: largest bounding-box side and centre
/// behind and above the posterior nasal spine, mm. Rounded from two adults; +-30 % does no harm.
struct Layout {
  std::string_view name;  ///< beginning of the structure's name
  double extent_mm, y_mm, z_mm;
};
constexpr Layout kLayout[] = {
    {"mandible", 120, -9, -26},    {"maxilla", 125, -28, 0},  {"lower_teeth", 60, -35, -30},
    {"upper_teeth", 60, -35, -20}, {"tongue", 75, -12, -37},  {"soft_palate", 55, 14, -20},
    {"velum", 55, 14, -20},        {"face", 150, -22, -28},   {"hyoid", 53, 13, -63},
    {"epiglottis", 35, 20, -65},   {"thyroid", 50, 14, -88},  {"cricoid", 32, 20, -105},
    {"arytenoid", 16, 24, -88},    {"larynx", 55, 18, -75},   {"trachea", 100, 20, -150},
    {"pharyn", 70, 28, -40},       {"airway", 110, -18, -43}, {"c1", 88, 60, -18},
    {"c2", 62, 63, -32},           {"c3", 62, 60, -57},       {"c4", 60, 61, -74},
    {"c5", 62, 65, -92},           {"c6", 68, 70, -107},      {"c7", 75, 78, -125},
    {"disc_c2", 18, 44, -47},      {"disc_c3", 28, 45, -65},  {"disc_c4", 27, 46, -85},
    {"disc_c5", 28, 48, -103},     {"disc_c6", 27, 54, -118}};
constexpr double kMaxUnitMisfit = 0.4;  ///< log10 of the factor 2.5; unit steps are 10 and 100
/// Alignment of file and adult layout (cosine): least accepted, and least lead over the second
/// best.
constexpr double kMinAxesFit = 0.8, kMinAxesLead = 0.05;  // assumed, 0.7..0.9 and 0.03..0.1

const Layout* layoutOf(std::string_view name) {
  for (const Layout& l : kLayout)
    if (name.starts_with(l.name)) return &l;
  return nullptr;
}

/// The 24 rotations that turn axes into axes.
std::vector<Mat3> axisRotations() {
  std::vector<Mat3> all;
  for (int a = 0; a < 6; ++a)
    for (int b = 0; b < 6; ++b) {
      if (a / 2 == b / 2) continue;
      const Vec3 x = Vec3::Unit(a / 2) * (a % 2 ? -1 : 1), y = Vec3::Unit(b / 2) * (b % 2 ? -1 : 1);
      Mat3 r;
      r << x, y, x.cross(y);
      all.push_back(r.transpose());
    }
  return all;
}
}  // namespace

std::string axesText(const Mat3& oursFromFile) {
  static const char* names[3][2] = {
      {"left", "right"}, {"posterior", "anterior"}, {"superior", "inferior"}};
  std::string text;
  for (int k = 0; k < 3; ++k) {
    Eigen::Index row = 0;
    oursFromFile.col(k).cwiseAbs().maxCoeff(&row);
    text += fmt::format("{}{} is {}", k ? ", " : "", "xyz"[k],
                        names[row][oursFromFile(row, k) < 0 ? 1 : 0]);
  }
  return text;
}

Result<double> guessUnit(const std::map<std::string, double>& extents, const std::string& place) {
  std::vector<double> misfits;  // log10 of metres per file unit, one vote per structure
  for (const auto& [name, extent] : extents)
    if (const Layout* l = layoutOf(name); l && extent > 0)
      misfits.push_back(std::log10(l->extent_mm * kMetrePerMm / extent));
  const char* remedy = "Say \"unit\": \"mm\", \"cm\" or \"m\" in the mapping.";
  if (misfits.empty())
    return usageError(place, "the unit can't be guessed: no structure of known size", remedy);
  std::nth_element(misfits.begin(), misfits.begin() + misfits.size() / 2, misfits.end());
  const double vote = misfits[misfits.size() / 2];
  for (const double unit : {1e-3, 1e-2, 1.0})
    if (std::abs(vote - std::log10(unit)) < kMaxUnitMisfit) return unit;
  return usageError(
      place,
      fmt::format("the unit can't be guessed: adult size needs {:.3g} m per file unit, "
                  "neither mm, cm nor m",
                  std::pow(10.0, vote)),
      remedy);
}

Result<Mat3> guessAxes(const std::map<std::string, Vec3>& centres, const std::string& place) {
  std::vector<Vec3> found, adult;
  for (const auto& [name, c] : centres)
    if (const Layout* l = layoutOf(name)) {
      const bool isLeft = name.ends_with("_L") || name.ends_with("_left");
      const bool isRight = name.ends_with("_R") || name.ends_with("_right");
      found.push_back(c);
      adult.emplace_back(isLeft ? 7 : isRight ? -7 : 0, l->y_mm, l->z_mm);
    }
  for (auto* cloud : {&found, &adult}) {
    Vec3 mean = Vec3::Zero();
    for (const Vec3& c : *cloud) mean += c / double(cloud->size());
    for (Vec3& c : *cloud) c -= mean;
  }
  double best = 0, second = 0, ff = 0, aa = 0;
  Mat3 choice = Mat3::Identity();
  for (std::size_t k = 0; k < found.size(); ++k)
    ff += found[k].squaredNorm(), aa += adult[k].squaredNorm();
  for (const Mat3& r : axisRotations()) {
    double fit = 0;
    for (std::size_t k = 0; k < found.size(); ++k) fit += adult[k].dot(r * found[k]);
    fit /= std::sqrt(ff * aa) + 1e-300;
    if (fit > best)
      second = best, best = fit, choice = r;
    else
      second = std::max(second, fit);
  }
  if (found.size() < 3 || best < kMinAxesFit || best - second < kMinAxesLead)
    return usageError(
        place,
        fmt::format("the axes can't be guessed from {} structures of known place (fit "
                    "{:.2f}, second best {:.2f})",
                    found.size(), best, second),
        "Say \"axes\": {\"x\": \"left\", \"y\": \"posterior\", \"z\": "
        "\"superior\"} in the mapping.");
  return choice;
}

namespace {
struct Loaded {
  const ImportStructureDef* def;
  std::vector<RawMesh> frames;
};

/// Files matching `tongue_%04d.obj`, by number; a gap in the numbers is an error.
Result<std::vector<fs::path>> numberedFiles(const fs::path& pattern) {
  const std::string name = pattern.filename().string();
  const std::size_t start = name.find('%'), end = name.find('d', start);
  const std::string head = name.substr(0, start), tail = name.substr(end + 1);
  std::map<long, fs::path> byNumber;
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(pattern.parent_path(), ec)) {
    const std::string n = entry.path().filename().string();
    if (n.size() <= head.size() + tail.size() || !n.starts_with(head) || !n.ends_with(tail))
      continue;
    const std::string digits = n.substr(head.size(), n.size() - head.size() - tail.size());
    long number = 0;
    if (digits.size() > 9 || digits.find_first_not_of("0123456789") != std::string::npos) continue;
    parse(digits, number);
    byNumber[number] = entry.path();
  }
  std::vector<fs::path> files;
  for (const auto& [number, path] : byNumber) {
    if (number != byNumber.begin()->first + long(files.size()))
      return usageError(
          pattern.string(),
          fmt::format("frame {} is missing: the next is {}",
                      byNumber.begin()->first + long(files.size()), path.filename().string()),
          "Number the frames without gaps.");
    files.push_back(path);
  }
  if (files.empty())
    return usageError(pattern.string(), "no file fits this pattern", "Check folder and name.");
  return files;
}

Result<Loaded> load(const fs::path& source, const ImportStructureDef& def) {
  std::error_code ec;
  std::vector<fs::path> files;
  for (const std::string& f : def.files) files.push_back(source / f);
  if (fs::is_regular_file(source, ec)) files = {source};
  if (files.empty())
    return usageError(source.string(), fmt::format("{}: no \"file\" in the mapping", def.name),
                      "Name its file, or give a mesh file as source.");
  if (files.size() == 1 && files[0].filename().string().find('%') != std::string::npos) {
    auto numbered = numberedFiles(files[0]);
    if (!numbered) return std::unexpected(numbered.error());
    files = std::move(*numbered);
  }
  Loaded loaded{.def = &def, .frames = {}};
  for (const fs::path& file : files) {
    auto mesh = readMeshFile(file, def.object);
    if (!mesh) return std::unexpected(mesh.error());
    loaded.frames.push_back(std::move(*mesh));
  }
  return loaded;
}

/// Unit and axes, given or guessed on all frames 0; then everything is moved to metres in our
/// frame.
Result<void> toOurFrame(const fs::path& source, const ImportDef& def, std::vector<Loaded>& all,
                        std::vector<std::string>& report) {
  std::map<std::string, double> extents;
  std::map<std::string, Vec3> centres;
  Eigen::AlignedBox3d whole;
  for (const Loaded& l : all) {
    Eigen::AlignedBox3d box;
    for (const Vec3& x : l.frames[0].corners) box.extend(x);
    whole.extend(box);
    extents[l.def->name] = box.sizes().maxCoeff();
    centres[l.def->name] = box.center();
  }
  double unit = def.unit == LengthUnit::mm ? 1e-3 : def.unit == LengthUnit::cm ? 1e-2 : 1;
  if (def.unit == LengthUnit::guess) {
    const auto guessed = guessUnit(extents, source.string());
    if (!guessed) return std::unexpected(guessed.error());
    unit = *guessed;
  }
  Mat3 axes = def.axes.oursFromFile;
  if (def.axes.guess) {
    const auto guessed = guessAxes(centres, source.string());
    if (!guessed) return std::unexpected(guessed.error());
    axes = *guessed;
  }
  const Vec3 size = whole.sizes();
  report.push_back(fmt::format(
      "unit {} {}: bounding box of all {:.4g} x {:.4g} x {:.4g} file units",
      unit == 1      ? "m"
      : unit == 1e-2 ? "cm"
                     : "mm",
      def.unit == LengthUnit::guess ? "guessed" : "given", size.x(), size.y(), size.z()));
  report.push_back(
      fmt::format("axes {}: {}", def.axes.guess ? "guessed" : "given", axesText(axes)));
  for (Loaded& l : all)
    for (RawMesh& m : l.frames) {
      for (Vec3& x : m.corners) x = axes * x * unit - def.origin_m;
      if (axes.determinant() < 0)
        for (auto& face : m.faces) std::reverse(face.begin(), face.end());
    }
  return {};
}

Result<void> build(const ImportDef& def, const Loaded& l, ImportedScene& out) {
  const RawMesh& rest = l.frames.front();
  const std::string& name = l.def->name;
  const bool isSequence = l.frames.size() > 1;
  if (rest.unusedVertices > 0)
    out.report.push_back(fmt::format("{}: the last {} vertices are in no face: cut off?", rest.file,
                                     rest.unusedVertices));
  auto map = weldFrames(l.frames, out.report);
  if (!map) return std::unexpected(map.error());
  if (auto done = mirrorHalf(*map, rest, l.def->half, def.stitchTolerance_m, name, out.report);
      !done)
    return done;
  if (auto done = closeSurface(*map, rest, l.def->closure, isSequence, name, out.report); !done)
    return done;
  Structure s{.name = name,
              .material = l.def->material,
              .rigid = l.def->rigid,
              .carrier = l.def->carrier,
              .drawOnly = l.def->closure == SurfaceClosure::drawOnly,
              .mesh = {map->apply(rest.corners), map->triangles}};
  const std::string size = checkManifold(s.mesh.triangles, int(s.mesh.positions.size())).closed()
                               ? fmt::format("{:.2f} cm3", volume(s.mesh) * 1e6)
                               : "open";
  out.report.push_back(fmt::format("{}: {} vertices, {} triangles, {}, from {}", name,
                                   s.mesh.positions.size(), s.mesh.triangles.size(), size,
                                   fs::path(rest.file).filename().string()));
  out.anatomy.structures.push_back(std::move(s));
  if (!isSequence) return {};
  ImportedSequence sequence{.name = name, .frames = {}};
  double farthest = 0;
  for (const RawMesh& m : l.frames) {
    if (const double shift = map->seamShift(m.corners); shift > def.stitchTolerance_m)
      return usageError(m.file,
                        fmt::format("its seam leaves the midsagittal plane by {:.2f} mm "
                                    "(tolerance {:.2f} mm)",
                                    shift * 1e3, def.stitchTolerance_m * 1e3),
                        "Keep the cut of a half mesh in the plane, or raise stitch_tolerance_mm.");
    sequence.frames.push_back(map->apply(m.corners));
    const auto& now = sequence.frames.back();
    const auto& before = sequence.frames[std::max<std::size_t>(sequence.frames.size(), 2) - 2];
    for (std::size_t v = 0; v < now.size(); ++v)
      farthest = std::max(farthest, (now[v] - before[v]).norm());
  }
  out.report.push_back(
      fmt::format("{}: {} frames with the same {} vertices and faces; no vertex "
                  "moves more than {:.2f} mm between frames",
                  name, l.frames.size(), map->corner.size(), farthest * 1e3));
  out.sequences.push_back(std::move(sequence));
  return {};
}
}  // namespace

Result<ImportedScene> importMeshes(const fs::path& source, const ImportDef& def) {
  std::vector<Loaded> all;
  for (const ImportStructureDef& s : def.structures) {
    auto loaded = load(source, s);
    if (!loaded) return std::unexpected(loaded.error());
    all.push_back(std::move(*loaded));
  }
  if (all.empty())
    return usageError(source.string(), "the mapping names no structure", "Add to \"structures\".");
  ImportedScene out{
      .anatomy = {}, .start_s = def.start_s, .rate_hz = def.rate_hz, .sequences = {}, .report = {}};
  out.anatomy.landmarks = def.landmarks;
  if (auto moved = toOurFrame(source, def, all, out.report); !moved)
    return std::unexpected(moved.error());
  for (const Loaded& l : all)
    if (auto built = build(def, l, out); !built) return std::unexpected(built.error());
  return out;
}
}  // namespace swallowclip::anatomy
