// SPDX-License-Identifier: MIT
// XDMF 2 text: one temporal collection; in each step a spatial collection of the structures, the
// skin and the bolus, all pointing into the HDF5 file.
#include <iterator>

#include "frame/history_file.h"

namespace swallowclip::frame {
namespace {

std::string escaped(const std::string& text) {
  std::string safe;
  for (char c : text) {
    if (c == '&')
      safe += "&amp;";
    else if (c == '<')
      safe += "&lt;";
    else if (c == '>')
      safe += "&gt;";
    else if (c == '"')
      safe += "&quot;";
    else
      safe += c;
  }
  return safe;
}

/// Writes data items that point into one HDF5 file.
class Text {
 public:
  explicit Text(const std::string& h5Name) : h5_(escaped(h5Name)) {}

  template <class... A>
  void add(fmt::format_string<A...> format, A&&... values) {
    fmt::format_to(std::back_inserter(text), format, std::forward<A>(values)...);
  }
  void whole(const std::string& type, const std::string& shape, const std::string& path) {
    add("<DataItem Format=\"HDF\" {} Dimensions=\"{}\">{}:{}</DataItem>", type, shape, h5_,
        escaped(path));
  }
  /// Entry `frame` of a [frames, n] or [frames, n, 3] data set.
  void slice(const std::string& type, int frames, int frame, std::size_t n, int columns,
             const std::string& path) {
    if (columns == 1) {
      add("<DataItem ItemType=\"HyperSlab\" Dimensions=\"1 {}\"><DataItem Format=\"XML\" "
          "Dimensions=\"3 2\">{} 0 1 1 1 {}</DataItem>",
          n, frame, n);
      whole(type, fmt::format("{} {}", frames, n), path);
    } else {
      add("<DataItem ItemType=\"HyperSlab\" Dimensions=\"1 {} {}\"><DataItem Format=\"XML\" "
          "Dimensions=\"3 3\">{} 0 0 1 1 1 1 {} {}</DataItem>",
          n, columns, frame, n, columns);
      whole(type, fmt::format("{} {} {}", frames, n, columns), path);
    }
    add("</DataItem>");
  }
  /// One column of an [n, 3] data set.
  void column(const std::string& type, std::size_t n, int which, const std::string& path) {
    add("<DataItem ItemType=\"HyperSlab\" Dimensions=\"{} 1\"><DataItem Format=\"XML\" "
        "Dimensions=\"3 2\">0 {} 1 1 {} 1</DataItem>",
        n, which, n);
    whole(type, fmt::format("{} 3", n), path);
    add("</DataItem>");
  }
  void triangles(std::size_t count, const std::string& group) {
    add("<Topology TopologyType=\"Triangle\" NumberOfElements=\"{}\">", count);
    whole("NumberType=\"Int\" Precision=\"4\"", fmt::format("{} 3", count), group + "/triangles");
    add("</Topology>\n");
  }
  void attribute(const char* name, const char* center, int columns) {
    add("<Attribute Name=\"{}\" Center=\"{}\" AttributeType=\"{}\">", name, center,
        columns == 3 ? "Vector" : "Scalar");
  }
  std::string text;

 private:
  std::string h5_;
};

const std::string kFloat = "NumberType=\"Float\" Precision=\"4\"";
const std::string kByte = "NumberType=\"UChar\" Precision=\"1\"";

/// A rigid structure's points, moved by the reader: row k of R times rest, plus t_k.
void rigidGeometry(Text& x, const StructureTrack& s, int frame, const std::string& group) {
  const Pose& pose = s.poses[static_cast<std::size_t>(frame)];
  const Mat3 r = pose.q.toRotationMatrix();
  x.add("<Geometry GeometryType=\"X_Y_Z\">");
  for (int k = 0; k < 3; ++k) {
    x.add(
        "<DataItem ItemType=\"Function\" Dimensions=\"{}\" Function=\"({:.9f} * $0) + "
        "({:.9f} * $1) + ({:.9f} * $2) + {:.9f}\">",
        s.rest.size(), r(k, 0), r(k, 1), r(k, 2), pose.t[k]);
    for (int column = 0; column < 3; ++column)
      x.column(kFloat, s.rest.size(), column, group + "/rest");
    x.add("</DataItem>");
  }
  x.add("</Geometry>\n");
}

void structureGrid(Text& x, const StructureTrack& s, int frames, int frame) {
  if (s.triangles.empty()) return;
  const std::string group = "/structures/" + s.name;
  x.add("<Grid Name=\"{}\" GridType=\"Uniform\">\n", escaped(s.name));
  x.triangles(s.triangles.size(), group);
  if (s.rigid) {
    rigidGeometry(x, s, frame, group);
  } else {
    x.add("<Geometry GeometryType=\"XYZ\">");
    x.slice(kFloat, frames, frame, s.rest.size(), 3, group + "/positions");
    x.add("</Geometry>\n");
  }
  x.add("</Grid>\n");
}

void skinGrid(Text& x, const SkinTrack& s, int frames, int frame) {
  if (s.triangles.empty()) return;
  const std::size_t vertices = s.wall.size();
  x.add("<Grid Name=\"skin\" GridType=\"Uniform\">\n");
  x.triangles(s.triangles.size(), "/skin");
  x.add("<Geometry GeometryType=\"XYZ\">");
  x.slice(kFloat, frames, frame, vertices, 3, "/skin/positions");
  x.add("</Geometry>\n");
  x.attribute("velocity", "Node", 3);
  x.slice(kFloat, frames, frame, vertices, 3, "/skin/velocities");
  x.add("</Attribute>\n");
  x.attribute("s_m", "Node", 1);
  x.whole(kFloat, std::to_string(vertices), "/skin/s_m");
  x.add("</Attribute>\n");
  x.attribute("wall", "Node", 1);
  x.whole(kByte, std::to_string(vertices), "/skin/wall");
  x.add("</Attribute>\n");
  if (!s.film_m.empty()) {
    x.attribute("film_m", "Cell", 1);
    x.slice(kFloat, frames, frame, s.triangles.size(), 1, "/skin/film_m");
    x.add("</Attribute>\n");
  }
  x.add("</Grid>\n");
}

void bolusGrid(Text& x, const BolusTrack& b, int frames, int frame) {
  if (b.positions.empty() || b.positions[0].empty()) return;
  const std::size_t n = b.positions[0].size();
  x.add(
      "<Grid Name=\"bolus\" GridType=\"Uniform\">\n<Topology TopologyType=\"Polyvertex\" "
      "NumberOfElements=\"{}\" NodesPerElement=\"1\"/>\n<Geometry GeometryType=\"XYZ\">",
      n);
  x.slice(kFloat, frames, frame, n, 3, "/bolus/positions");
  x.add("</Geometry>\n");
  const auto attribute = [&](const char* name, const std::string& type, int columns,
                             const char* path) {
    x.attribute(name, "Node", columns);
    x.slice(type, frames, frame, n, columns, path);
    x.add("</Attribute>\n");
  };
  attribute("velocity", kFloat, 3, "/bolus/velocities");
  attribute("density_ratio", kFloat, 1, "/bolus/density_ratio");
  attribute("s_m", kFloat, 1, "/bolus/s_m");
  attribute("state", kByte, 1, "/bolus/state");
  attribute("region", kByte, 1, "/bolus/region");
  x.add("</Grid>\n");
}
}  // namespace

std::string xdmfText(const History& h, const std::string& h5Name) {
  Text x(h5Name);
  x.add(
      "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\">\n<Domain>\n"
      "<Grid Name=\"swallow\" GridType=\"Collection\" CollectionType=\"Temporal\">\n");
  for (int f = 0; f < h.frames(); ++f) {
    x.add(
        "<Grid Name=\"frame\" GridType=\"Collection\" CollectionType=\"Spatial\">\n"
        "<Time Value=\"{:.9g}\"/>\n",
        h.time_s[static_cast<std::size_t>(f)]);
    for (const StructureTrack& s : h.structures) structureGrid(x, s, h.frames(), f);
    skinGrid(x, h.skin, h.frames(), f);
    bolusGrid(x, h.bolus, h.frames(), f);
    x.add("</Grid>\n");
  }
  x.add("</Grid>\n</Domain>\n</Xdmf>\n");
  return x.text;
}
}  // namespace swallowclip::frame
