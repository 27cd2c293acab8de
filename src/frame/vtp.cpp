// SPDX-License-Identifier: MIT
// VTK XML PolyData: arrays inline as base64, little-endian, each behind its byte count (UInt32).
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "frame/exporter.h"

namespace swallowclip::frame {
namespace {
static_assert(std::endian::native == std::endian::little, "arrays are written as they are");

template <class T>
constexpr const char* vtkType() {
  if constexpr (std::is_same_v<T, float>) return "Float32";
  if constexpr (std::is_same_v<T, std::int32_t>) return "Int32";
  return "UInt8";
}

std::string base64(const unsigned char* bytes, std::size_t size) {
  static constexpr char kLetters[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    const std::size_t left = std::min<std::size_t>(3, size - i);
    std::uint32_t group = std::uint32_t{bytes[i]} << 16;
    if (left > 1) group |= std::uint32_t{bytes[i + 1]} << 8;
    if (left > 2) group |= bytes[i + 2];
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= left ? kLetters[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

/// The XML of one PolyData piece, element by element.
class Piece {
 public:
  Piece(std::size_t points, std::size_t vertices, std::size_t triangles, double time_s,
        const std::string& names = {}) {
    xml_ =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
        "byte_order=\"LittleEndian\" header_type=\"UInt32\">\n<PolyData>\n<FieldData>\n";
    xml_ += fmt::format(
        "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">"
        "{:.9g}</DataArray>\n",
        time_s);
    if (!names.empty()) xml_ += names;
    xml_ += fmt::format(
        "</FieldData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" "
        "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
        points, vertices, triangles);
  }
  void open(const std::string& tag) { xml_ += "<" + tag + ">\n"; }
  void shut(const std::string& tag) { xml_ += "</" + tag + ">\n"; }

  template <class T>
  void array(const std::string& name, int components, const std::vector<T>& values) {
    raw(name, vtkType<T>(), components, values.data(), values.size() * sizeof(T));
  }
  void array(const std::string& name, const std::vector<Vec3f>& values) {
    raw(name, "Float32", 3, values.data(), values.size() * sizeof(Vec3f));
  }
  /// Enums of one byte.
  template <class E>
  void words(const std::string& name, const std::vector<E>& values) {
    static_assert(sizeof(E) == 1);
    raw(name, "UInt8", 1, values.data(), values.size());
  }
  void points(const std::vector<Vec3f>& positions) {
    open("Points");
    array("position_m", positions);
    shut("Points");
  }
  /// Cells of `corners` points each.
  void cells(const std::string& tag, int corners, const std::vector<std::int32_t>& connectivity) {
    std::vector<std::int32_t> offsets;
    for (std::size_t end = static_cast<std::size_t>(corners); end <= connectivity.size();
         end += static_cast<std::size_t>(corners))
      offsets.push_back(static_cast<std::int32_t>(end));
    open(tag);
    array("connectivity", 1, connectivity);
    array("offsets", 1, offsets);
    shut(tag);
  }
  std::string finish() { return xml_ + "</Piece>\n</PolyData>\n</VTKFile>\n"; }

 private:
  void raw(const std::string& name, const char* type, int components, const void* data,
           std::size_t bytes) {
    std::vector<unsigned char> block(sizeof(std::uint32_t) + bytes);
    const auto size = static_cast<std::uint32_t>(bytes);
    std::memcpy(block.data(), &size, sizeof size);
    if (bytes > 0) std::memcpy(block.data() + sizeof size, data, bytes);
    xml_ += fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" "
        "format=\"binary\">",
        type, name, components);
    xml_ += base64(block.data(), block.size()) + "</DataArray>\n";
  }
  std::string xml_;
};

/// VTK keeps a string array in XML as character codes, each string ended by a zero.
std::string nameField(const std::vector<StructureTrack>& structures) {
  std::string codes;
  for (const StructureTrack& s : structures) {
    for (unsigned char c : s.name) codes += fmt::format("{} ", c);
    codes += "0 ";
  }
  return fmt::format(
      "<Array type=\"String\" Name=\"names\" NumberOfTuples=\"{}\" "
      "format=\"ascii\">{}</Array>\n",
      structures.size(), codes);
}
}  // namespace

std::string structuresVtp(const History& h, int frame) {
  std::vector<Vec3f> positions;
  std::vector<std::int32_t> corners, part;
  for (std::size_t k = 0; k < h.structures.size(); ++k) {
    const auto first = static_cast<std::int32_t>(positions.size());
    const std::vector<Vec3f> moved = h.structures[k].at(frame);
    positions.insert(positions.end(), moved.begin(), moved.end());
    for (const Triangle& t : h.structures[k].triangles) {
      for (int v : t) corners.push_back(first + v);
      part.push_back(static_cast<std::int32_t>(k));
    }
  }
  Piece piece(positions.size(), 0, part.size(), h.time_s[static_cast<std::size_t>(frame)],
              nameField(h.structures));
  piece.open("CellData");
  piece.array("structure", 1, part);
  piece.shut("CellData");
  piece.points(positions);
  piece.cells("Polys", 3, corners);
  return piece.finish();
}

std::string skinVtp(const History& h, int frame) {
  const SkinTrack& s = h.skin;
  const auto f = static_cast<std::size_t>(frame);
  std::vector<std::int32_t> corners;
  for (const Triangle& t : s.triangles) corners.insert(corners.end(), t.begin(), t.end());
  Piece piece(s.positions[f].size(), 0, s.triangles.size(), h.time_s[f]);
  piece.open("PointData");
  piece.array("velocity", s.velocities[f]);
  piece.array("s_m", 1, s.s_m);
  piece.array("u", 1, s.u);
  piece.words("wall", s.wall);
  piece.shut("PointData");
  if (!s.film_m.empty()) {
    piece.open("CellData");
    piece.array("film_m", 1, s.film_m[f]);
    piece.shut("CellData");
  }
  piece.points(s.positions[f]);
  piece.cells("Polys", 3, corners);
  return piece.finish();
}

std::string bolusVtp(const History& h, int frame) {
  const BolusTrack& b = h.bolus;
  const auto f = static_cast<std::size_t>(frame);
  const std::size_t particles = b.positions[f].size();
  std::vector<std::int32_t> id(particles);
  for (std::size_t i = 0; i < particles; ++i) id[i] = static_cast<std::int32_t>(i);
  std::vector<float> density = b.densityRatio[f];
  for (float& d : density) d *= static_cast<float>(h.meta.density_kgm3);
  Piece piece(particles, particles, 0, h.time_s[f]);
  piece.open("PointData");
  piece.array("id", 1, id);
  piece.array("velocity", b.velocities[f]);
  piece.array("density", 1, density);
  piece.array("density_ratio", 1, b.densityRatio[f]);
  piece.words("state", b.state[f]);
  piece.words("region", b.region[f]);
  piece.array("s_m", 1, b.s_m[f]);
  piece.shut("PointData");
  piece.points(b.positions[f]);
  piece.cells("Verts", 1, id);
  return piece.finish();
}
}  // namespace swallowclip::frame
