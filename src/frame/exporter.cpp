// SPDX-License-Identifier: MIT
#include "frame/exporter.h"

#include <fmt/format.h>

#include <functional>
#include <iterator>

#include "core/file.h"

namespace swallowclip::frame {
namespace {
namespace fs = std::filesystem;

constexpr double kMmPerMetre = 1000.0;

/// RFC 4180: quoted when it holds a comma or a quote, quotes doubled.
std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

// A hundredth of a micrometre: finer than float32 resolves at the edge of the head (0.1 m).
void addPosition(std::string& out, const Vec3f& p) {
  fmt::format_to(std::back_inserter(out), "{:.5f},{:.5f},{:.5f}", p.x() * kMmPerMetre,
                 p.y() * kMmPerMetre, p.z() * kMmPerMetre);
}

std::string particlesCsv(const History& h) {
  std::string csv = "frame,time_s,id,x_mm,y_mm,z_mm,region\n";
  const BolusTrack& b = h.bolus;
  for (std::size_t f = 0; f < b.positions.size(); ++f)
    for (std::size_t i = 0; i < b.positions[f].size(); ++i) {
      fmt::format_to(std::back_inserter(csv), "{},{:.6f},{},", f, h.time_s[f], i);
      addPosition(csv, b.positions[f][i]);
      const bool gone = b.state[f][i] == ParticleState::swallowed;
      csv += ',';
      csv += name(gone ? Region::swallowed : b.region[f][i]);
      csv += '\n';
    }
  return csv;
}

std::string landmarksCsv(const History& h) {
  std::string csv = "frame,time_s,name,x_mm,y_mm,z_mm\n";
  for (std::size_t f = 0; f < h.time_s.size(); ++f)
    for (const LandmarkTrack& l : h.landmarks) {
      fmt::format_to(std::back_inserter(csv), "{},{:.6f},{},", f, h.time_s[f], csvField(l.name));
      addPosition(csv, l.positions[f]);
      csv += '\n';
    }
  return csv;
}

std::string objText(const std::string& object, const std::vector<Vec3f>& positions,
                    const std::vector<Triangle>& triangles) {
  std::string obj = "# millimetres; x left, y posterior, z superior\no " + object + "\n";
  for (const Vec3f& p : positions)
    fmt::format_to(std::back_inserter(obj), "v {:.5f} {:.5f} {:.5f}\n", p.x() * kMmPerMetre,
                   p.y() * kMmPerMetre, p.z() * kMmPerMetre);
  for (const Triangle& t : triangles)
    fmt::format_to(std::back_inserter(obj), "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return obj;
}

/// Writes files until one fails; counts them.
struct Files {
  int written = 0;
  Result<void> result;

  void add(const fs::path& path, const std::function<std::string()>& content) {
    if (!result) return;
    result = writeFile(path, content());
    if (result) ++written;
  }
};

void exportVtp(Files& files, const History& h, const fs::path& folder) {
  std::string pvd =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
      "byte_order=\"LittleEndian\">\n<Collection>\n";
  const auto part = [&](int number, const char* name, int frame, auto&& content) {
    const std::string file = fmt::format("vtp/{}_{:04}.vtp", name, frame);
    files.add(folder / file, [&] { return content(h, frame); });
    pvd += fmt::format("<DataSet timestep=\"{:.9g}\" part=\"{}\" name=\"{}\" file=\"{}\"/>\n",
                       h.time_s[static_cast<std::size_t>(frame)], number, name, file);
  };
  for (int f = 0; f < h.frames(); ++f) {
    if (!h.structures.empty()) part(0, "structures", f, structuresVtp);
    if (!h.skin.positions.empty()) part(1, "skin", f, skinVtp);
    if (!h.bolus.positions.empty()) part(2, "bolus", f, bolusVtp);
  }
  files.add(folder / "swallow.pvd", [&] { return pvd + "</Collection>\n</VTKFile>\n"; });
}

void exportObj(Files& files, const History& h, const fs::path& folder) {
  for (int f = 0; f < h.frames(); ++f) {
    const auto path = [&](const std::string& object) {
      return folder / "obj" / fmt::format("{}_{:04}.obj", object, f);
    };
    for (const StructureTrack& s : h.structures)
      files.add(path(s.name), [&] { return objText(s.name, s.at(f), s.triangles); });
    if (!h.skin.positions.empty())
      files.add(path("skin"), [&] {
        return objText("skin", h.skin.positions[static_cast<std::size_t>(f)], h.skin.triangles);
      });
  }
}
}  // namespace

Result<ExportFormat> exportFormat(const std::string& word) {
  if (word == "csv") return ExportFormat::csv;
  if (word == "vtp") return ExportFormat::vtp;
  if (word == "obj") return ExportFormat::obj;
  const std::string near = nearestName(word, {"csv", "vtp", "obj"});
  return usageError("--format", fmt::format("\"{}\" is not an export format", word),
                    near.empty() ? "Use csv, vtp or obj." : fmt::format("Did you mean {}?", near));
}

Result<int> exportHistory(const History& h, ExportFormat format, const fs::path& folder) {
  if (const std::string fault = h.validate(); !fault.empty())
    return failure(folder.string(), "nothing exported, the history is not sound: " + fault,
                   "Simulate again.");
  const char* inner = format == ExportFormat::vtp   ? "vtp"
                      : format == ExportFormat::obj ? "obj"
                                                    : "";
  if (auto ready = prepareFolder(*inner ? folder / inner : folder); !ready)
    return std::unexpected(ready.error());
  Files files;
  if (format == ExportFormat::csv) {
    files.add(folder / "particles.csv", [&] { return particlesCsv(h); });
    files.add(folder / "landmarks.csv", [&] { return landmarksCsv(h); });
  } else if (format == ExportFormat::vtp) {
    exportVtp(files, h, folder);
  } else {
    exportObj(files, h, folder);
  }
  if (!files.result) return std::unexpected(files.result.error());
  return files.written;
}
}  // namespace swallowclip::frame
