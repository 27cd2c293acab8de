// SPDX-License-Identifier: MIT
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <charconv>
#include <cmath>
#include <cstring>

#include "anatomy/mesh_import.h"
#include "core/file.h"

namespace swallowclip::anatomy {
namespace fs = std::filesystem;
namespace {

// Bounds on what a file may claim; both far above any anatomy. Assumed.
constexpr std::size_t kMaxFileBytes = std::size_t(1) << 30;
constexpr std::size_t kMaxCorners = 30'000'000;
constexpr double kMaxCoordinate = 1e7;  ///< file units; a head in mm is 300

constexpr const char* kExportAgain = "Export or copy the file again.";

std::string lower(std::string s) {
  for (char& c : s) c = char(std::tolower(static_cast<unsigned char>(c)));
  return s;
}

std::string_view nextLine(std::string_view& rest) {
  const std::size_t end = rest.find('\n');
  std::string_view line = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
  return line;
}

std::vector<std::string_view> words(std::string_view line) {
  std::vector<std::string_view> w;
  while (true) {
    const std::size_t start = line.find_first_not_of(" \t");
    if (start == std::string_view::npos) return w;
    line.remove_prefix(start);
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    w.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

template <class T>
bool parse(std::string_view w, T& value) {
  if (!w.empty() && w.front() == '+') w.remove_prefix(1);
  return std::from_chars(w.data(), w.data() + w.size(), value).ec == std::errc();
}

/// What readers let pass in an OBJ: numbers that are none, faces cut off, vertices that aren't
/// there.
Result<void> checkObj(std::string_view text, const std::string& file, RawMesh& mesh) {
  int vertices = 0, number = 0, farthestLine = 0;
  long farthest = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view line = nextLine(rest);
    ++number;
    const bool isVertex = line.starts_with("v ") || line.starts_with("v\t");
    const bool isFace = line.starts_with("f ") || line.starts_with("f\t");
    if ((!isVertex && !isFace) || line.ends_with('\\')) continue;
    const std::string place = fmt::format("{}:{}", file, number);
    const std::vector<std::string_view> w = words(line.substr(2));
    if (w.size() < 3)
      return usageError(place,
                        fmt::format("{} with {} of 3 or more numbers: cut off?",
                                    isVertex ? "a vertex" : "a face", w.size()),
                        kExportAgain);
    if (isVertex) {
      ++vertices;
      for (int k = 0; k < 3; ++k)
        if (double x = 0; !parse(w[k], x) || !std::isfinite(x))
          return usageError(place, fmt::format("coordinate \"{}\" is no finite number", w[k]),
                            kExportAgain);
      continue;
    }
    for (std::string_view corner : w) {
      long index = 0;
      if (!parse(corner.substr(0, corner.find('/')), index) || index == 0 || -index > vertices)
        return usageError(place, fmt::format("\"{}\" names no vertex", corner), kExportAgain);
      if (index > farthest) farthest = index, farthestLine = number;
    }
  }
  if (farthest > vertices)
    return usageError(
        fmt::format("{}:{}", file, farthestLine),
        fmt::format("a face names vertex {}, but the file has {}", farthest, vertices),
        kExportAgain);
  mesh.fileVertices = vertices;
  mesh.unusedVertices = farthest > 0 ? vertices - int(farthest) : 0;
  return {};
}

/// Compares the counts a PLY header claims with the bytes that follow.
Result<void> checkPly(std::string_view text, const std::string& file) {
  static const std::map<std::string_view, int> sizes{
      {"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
      {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
      {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  bool ascii = false, ended = false;
  double count = 0, needed = 0;
  std::string_view rest = text;
  while (!rest.empty() && !ended) {
    const std::vector<std::string_view> w = words(nextLine(rest));
    if (w.empty()) continue;
    if (w[0] == "end_header") ended = true;
    if (w[0] == "format" && w.size() > 1) ascii = w[1] == "ascii";
    if (w[0] == "element" && (w.size() < 3 || !parse(w[2], count) || count < 0))
      return usageError(file, "a PLY element without a count", kExportAgain);
    if (w[0] != "property" || w.size() < 2) continue;
    // the least one item can take: a lone digit and its blank, or an empty list
    const std::string_view type = w[1] == "list" && w.size() > 2 ? w[2] : w[1];
    const auto size = sizes.find(type);
    if (size == sizes.end())
      return usageError(file, fmt::format("unknown PLY type \"{}\"", type), kExportAgain);
    needed += count * (ascii ? 2 : size->second);
  }
  if (!ended) return usageError(file, "the PLY header has no end_header", kExportAgain);
  if (double(rest.size()) + 1 < needed)
    return usageError(file,
                      fmt::format("the PLY header promises at least {:.0f} bytes, {} are there",
                                  needed, rest.size()),
                      kExportAgain);
  return {};
}

Result<void> checkStl(std::string_view bytes, const std::string& file) {
  if (bytes.starts_with("solid") && bytes.find("facet") != std::string_view::npos) {
    if (bytes.find("endsolid") != std::string_view::npos) return {};
    return usageError(file, "the text STL has no endsolid: cut off?", kExportAgain);
  }
  std::uint32_t count = 0;
  if (bytes.size() >= 84) std::memcpy(&count, bytes.data() + 80, 4);
  if (const std::size_t needed = 84 + std::size_t(count) * 50; bytes.size() < needed)
    return usageError(file,
                      fmt::format("the STL promises {} triangles in {} bytes, {} are there", count,
                                  needed, bytes.size()),
                      kExportAgain);
  return {};
}

/// Appends what hangs below `node`, in file order, with all transforms applied.
void collect(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent, bool inside,
             const std::string& object, RawMesh& out) {
  const aiMatrix4x4 here = parent * node.mTransformation;
  inside = inside || object.empty() || object == node.mName.C_Str();
  for (unsigned k = 0; k < node.mNumMeshes; ++k) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[k]];
    if (!inside && object != mesh.mName.C_Str()) continue;
    const int base = int(out.corners.size());
    if (out.corners.size() + mesh.mNumVertices > kMaxCorners) return;
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D x = here * mesh.mVertices[v];
      out.corners.emplace_back(x.x, x.y, x.z);
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices < 3) continue;  // points and lines
      std::vector<int> polygon;
      for (unsigned i = 0; i < face.mNumIndices; ++i)
        if (face.mIndices[i] < mesh.mNumVertices) polygon.push_back(base + int(face.mIndices[i]));
      if (polygon.size() == face.mNumIndices) out.faces.push_back(std::move(polygon));
    }
  }
  for (unsigned k = 0; k < node.mNumChildren; ++k)
    collect(scene, *node.mChildren[k], here, inside, object, out);
}

void objectNames(const aiNode& node, std::vector<std::string>& names) {
  if (node.mName.length > 0) names.push_back(node.mName.C_Str());
  for (unsigned k = 0; k < node.mNumChildren; ++k) objectNames(*node.mChildren[k], names);
}
}  // namespace

Result<RawMesh> readMeshFile(const fs::path& path, const std::string& object) {
  const std::string file = path.string();
  std::error_code ec;
  if (fs::is_regular_file(path, ec) && fs::file_size(path, ec) > kMaxFileBytes)
    return usageError(file, "is larger than 1 GB", "Decimate it, or cut it into structures.");
  const auto bytes = readFile(path);
  if (!bytes) return std::unexpected(bytes.error());
  const std::string extension = lower(path.extension().string());
  RawMesh mesh{.file = file, .fileVertices = 0, .corners = {}, .faces = {}, .unusedVertices = 0};
  Result<void> sound;
  if (extension == ".obj") sound = checkObj(*bytes, file, mesh);
  if (extension == ".ply") sound = checkPly(*bytes, file);
  if (extension == ".stl") sound = checkStl(*bytes, file);
  if (!sound) return std::unexpected(sound.error());
  try {
    Assimp::Importer importer;
    // no post-processing: joining and triangulating would differ from frame to frame
    const aiScene* scene = importer.ReadFile(file, 0);
    if (!scene || !scene->mRootNode)
      return usageError(file,
                        fmt::format("can't be read as a mesh ({})", importer.GetErrorString()),
                        "Export it as OBJ, PLY, STL or glTF.");
    collect(*scene, *scene->mRootNode, aiMatrix4x4(), false, object, mesh);
    if (!object.empty() && mesh.faces.empty()) {
      std::vector<std::string> names;
      objectNames(*scene->mRootNode, names);
      const std::string near = nearestName(object, names);
      return usageError(file, fmt::format("has no object \"{}\" with faces", object),
                        near.empty() ? "Name one of its objects." : "Did you mean " + near + "?");
    }
  } catch (const std::exception& e) {
    return usageError(file, fmt::format("can't be read as a mesh ({})", e.what()), kExportAgain);
  }
  if (mesh.faces.empty())
    return usageError(file, "has no faces", "Export its faces too, or leave it out.");
  for (const Vec3& x : mesh.corners)
    if (!x.allFinite() || x.cwiseAbs().maxCoeff() > kMaxCoordinate)
      return usageError(file, "has a coordinate that is not a number or beyond 1e7", kExportAgain);
  if (mesh.fileVertices == 0) mesh.fileVertices = int(mesh.corners.size());
  return mesh;
}

}  // namespace swallowclip::anatomy
