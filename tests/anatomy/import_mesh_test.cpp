// SPDX-License-Identifier: MIT
// Meshes from outside: halves, units, axes, sequences and files that lie.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>

#include "anatomy/mesh_import.h"
#include "core/file.h"

namespace swallowclip::anatomy {
namespace {
namespace fs = std::filesystem;

class Import : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder = fs::temp_directory_path() /
             fmt::format("swallowclip_import_{}_{}", info->name(), ::getpid());
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }
  void write(const std::string& name, const std::string& text) {
    ASSERT_TRUE(writeFile(folder / name, text).has_value());
  }
  static ImportDef plain(const std::string& file,
                         SurfaceClosure closure = SurfaceClosure::requireClosed,
                         HalfSide half = HalfSide::guess) {
    ImportDef def;
    def.unit = LengthUnit::mm;
    def.axes.guess = false;
    ImportStructureDef s;
    s.files = {file};
    s.name = "tongue";
    s.half = half;
    s.closure = closure;
    def.structures = {s};
    return def;
  }
  std::string errorOf(const ImportDef& def) {
    const auto r = importMeshes(folder, def);
    return r ? "no error" : r.error().text();
  }
  fs::path folder;
};

bool says(const std::vector<std::string>& report, const std::string& words) {
  for (const std::string& line : report)
    if (line.find(words) != std::string::npos) return true;
  return false;
}

/// Sphere-like OBJ of quads and pole triangles, longitude in [from, to] (half turn of a closed
/// one).
std::string ellipsoidObj(const Vec3& radius, bool half, double unit = 1, double swell = 1) {
  const int rings = 16, sectors = half ? 16 : 32;
  const double turn = half ? kPi : 2 * kPi;
  const int columns = half ? sectors + 1 : sectors;
  std::string v, f;
  const auto vertex = [&](double x, double y, double z) {
    v += fmt::format("v {:.9g} {:.9g} {:.9g}\n", x * unit, y * unit * swell, z * unit);
  };
  vertex(0, 0, radius.z());
  for (int i = 1; i < rings; ++i)
    for (int k = 0; k < columns; ++k) {
      const double theta = kPi * i / rings, phi = turn * k / sectors - kPi / 2;
      vertex(radius.x() * std::sin(theta) * std::cos(phi),
             radius.y() * std::sin(theta) * std::sin(phi), radius.z() * std::cos(theta));
    }
  vertex(0, 0, -radius.z());
  const int last = 2 + (rings - 1) * columns;
  const auto at = [&](int i, int k) { return 2 + (i - 1) * columns + k % columns; };
  for (int k = 0; k < sectors; ++k) {
    f += fmt::format("f 1 {} {}\n", at(1, k), at(1, k + 1));
    for (int i = 1; i + 1 < rings; ++i)
      f += fmt::format("f {} {} {} {}\n", at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1));
    f += fmt::format("f {} {} {}\n", at(rings - 1, k), last, at(rings - 1, k + 1));
  }
  return "o body\n" + v + f;
}
double ellipsoidVolume_m3(const Vec3& radius_mm) {
  return 4 / 3.0 * kPi * radius_mm.prod() * 1e-9;
}

/// The half x >= 0 of a cube of 20 mm, with its midsagittal face.
const char* kHalfCube =
    "v 0 -10 -10\nv 10 -10 -10\nv 10 10 -10\nv 0 10 -10\nv 0 -10 10\nv 10 -10 10\nv 10 10 10\n"
    "v 0 10 10\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

TEST_F(Import, HalfCubeLosesItsMidsagittalFaceAndBecomesWhole) {
  write("cube.obj", kHalfCube);
  const auto r = importMeshes(folder, plain("cube.obj"));
  ASSERT_TRUE(r) << r.error().text();
  const TriMesh& m = r->anatomy.structures[0].mesh;
  EXPECT_EQ(m.positions.size(), 12u);  // 8 + 4 mirrored, none added at the seam
  EXPECT_EQ(m.triangles.size(), 20u);  // (12 - 2 on the plane) * 2
  EXPECT_TRUE(checkManifold(m.triangles, 12).closed());
  EXPECT_NEAR(volume(m), 8e-6, 1e-12);  // 20 mm cubed
  EXPECT_TRUE(says(r->report, "guessed to be a left half"));
  EXPECT_TRUE(says(r->report, "2 midsagittal faces removed, 4 vertices mirrored, 4 stitched"));
}

TEST_F(Import, OpenHalfEllipsoidInMillimetresAndMetresIsTheSame) {
  const Vec3 radius(25, 37, 20);
  write("mm.obj", ellipsoidObj(radius, true));
  write("m.obj", ellipsoidObj(radius, true, 1e-3));
  ImportDef def = plain("mm.obj");
  def.unit = LengthUnit::guess;
  const auto mm = importMeshes(folder, def);
  def.structures[0].files = {"m.obj"};
  const auto m = importMeshes(folder, def);
  ASSERT_TRUE(mm) << mm.error().text();
  ASSERT_TRUE(m) << m.error().text();
  EXPECT_TRUE(says(mm->report, "unit mm guessed"));
  EXPECT_TRUE(says(m->report, "unit m guessed"));
  const double exact = ellipsoidVolume_m3(radius);
  EXPECT_NEAR(volume(mm->anatomy.structures[0].mesh), exact, 0.03 * exact);
  EXPECT_NEAR(volume(m->anatomy.structures[0].mesh), volume(mm->anatomy.structures[0].mesh),
              1e-5 * exact);
  EXPECT_EQ(m->anatomy.structures[0].mesh.triangles, mm->anatomy.structures[0].mesh.triangles);
}

TEST_F(Import, ASizeOfNoUnitIsNotGuessed) {
  write("odd.obj", ellipsoidObj({25, 37, 20}, false, 0.02));
  ImportDef def = plain("odd.obj");
  def.unit = LengthUnit::guess;
  EXPECT_NE(errorOf(def).find("unit can't be guessed"), std::string::npos) << errorOf(def);
}

TEST_F(Import, AHalfOffThePlaneIsNamed) {
  std::string text = kHalfCube;
  write("cube.obj", text);
  ImportDef def = plain("cube.obj", SurfaceClosure::requireClosed, HalfSide::left);
  def.origin_m = {3e-3, 0, 0};
  EXPECT_NE(errorOf(def).find("x runs from -3.00 to 7.00 mm"), std::string::npos) << errorOf(def);
}

TEST_F(Import, MirroringAxesKeepTheSurfaceFacingOutward) {
  write("body.obj", ellipsoidObj({25, 37, 20}, false));
  ImportDef def = plain("body.obj");
  def.axes.oursFromFile = Vec3(-1, 1, 1).asDiagonal();
  const auto r = importMeshes(folder, def);
  ASSERT_TRUE(r) << r.error().text();
  EXPECT_GT(volume(r->anatomy.structures[0].mesh), 0);
  EXPECT_FALSE(says(r->report, "faced inward"));
}

TEST_F(Import, AxesAreGuessedFromTheLayout) {
  // anterior is -z and superior is y, as in many animation programs: x left
  const std::map<std::string, Vec3> centres{{"mandible", {0, -26, -9}},
                                            {"hyoid", {0, -63, 13}},
                                            {"c3", {0, -57, 60}},
                                            {"cricoid", {0, -105, 20}}};
  std::map<std::string, Vec3> ours;
  const auto r = guessAxes(centres, "here");
  ASSERT_TRUE(r) << r.error().text();
  EXPECT_EQ(axesText(*r), "x is right, y is superior, z is posterior");
  EXPECT_FALSE(guessAxes({{"tongue", {0, 1, 2}}}, "here"));
}

TEST_F(Import, SequenceKeepsItsVertices) {
  for (int k = 0; k < 5; ++k)
    write(fmt::format("t_{:04d}.obj", k), ellipsoidObj({25, 37, 20}, true, 1, 1 + 0.02 * k));
  const auto r = importMeshes(folder, plain("t_%04d.obj"));
  ASSERT_TRUE(r) << r.error().text();
  ASSERT_EQ(r->sequences.size(), 1u);
  const auto& frames = r->sequences[0].frames;
  const TriMesh& rest = r->anatomy.structures[0].mesh;
  ASSERT_EQ(frames.size(), 5u);
  for (std::size_t v = 0; v < rest.positions.size(); ++v)
    for (int k = 0; k < 5; ++k) {
      const Vec3 p = rest.positions[v].cwiseProduct(Vec3(1, 1 + 0.02 * k, 1));
      ASSERT_LT((frames[k][v] - p).norm(), 1e-8) << "vertex " << v << " frame " << k;
    }
}

TEST_F(Import, SequenceWithAnotherVertexCountNamesFileAndCounts) {
  write("t_1.obj", ellipsoidObj({25, 37, 20}, false));
  write("t_2.obj", kHalfCube);
  const std::string e = errorOf(plain("t_%d.obj"));
  EXPECT_NE(e.find("t_2.obj"), std::string::npos) << e;
  EXPECT_NE(e.find("8 vertices and 6 faces"), std::string::npos) << e;
  EXPECT_NE(e.find("482 and 512"), std::string::npos) << e;
}

TEST_F(Import, SequenceWithOtherFacesOrScrambledVerticesIsRefused) {
  const std::string body = ellipsoidObj({25, 37, 20}, false);
  write("t_1.obj", body);
  // the same faces, the first line of them moved to the end
  const std::size_t first = body.find("f "), end = body.find('\n', first) + 1;
  write("t_2.obj", body.substr(0, first) + body.substr(end) + body.substr(first, end - first));
  std::string e = errorOf(plain("t_%d.obj"));
  EXPECT_NE(e.find("t_2.obj"), std::string::npos) << e;
  EXPECT_TRUE(e.find("joins other vertices") != std::string::npos ||
              e.find("come apart") != std::string::npos)
      << e;
  // the same faces over vertices in reverse order of every second line
  std::vector<std::string> v;
  for (std::size_t at = body.find("v "); at < first;) {
    const std::size_t next = body.find('\n', at) + 1;
    v.push_back(body.substr(at, next - at));
    at = next;
  }
  std::string scrambled;
  for (std::size_t k = 0; k < v.size(); ++k) scrambled += v[k * 211 % v.size()];
  write("t_2.obj", scrambled + body.substr(first));
  e = errorOf(plain("t_%d.obj"));
  EXPECT_NE(e.find("another order"), std::string::npos) << e;
}

TEST_F(Import, SequenceWithAGapInItsNumbersIsRefused) {
  write("t_0001.obj", kHalfCube);
  write("t_0003.obj", kHalfCube);
  EXPECT_NE(errorOf(plain("t_%04d.obj")).find("frame 2 is missing"), std::string::npos);
}

TEST_F(Import, SheetsThatOnlyTouchOnFrameZeroStayApart) {
  // two tetrahedra sharing the corner (0,0,0) on frame 0 only
  const auto pair = [](double lift) {
    return fmt::format(
        "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nv 0 0 {0}\nv -10 0 {0}\nv 0 -10 {0}\n"
        "v 0 0 {1}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nf 5 6 7\nf 5 8 6\nf 5 7 8\n"
        "f 6 8 7\n",
        -lift, -10 - lift);
  };
  write("t_0.obj", pair(0));
  write("t_1.obj", pair(2));
  const auto r = importMeshes(folder, plain("t_%d.obj"));
  ASSERT_TRUE(r) << r.error().text();
  EXPECT_EQ(r->anatomy.structures[0].mesh.positions.size(), 8u);
  EXPECT_TRUE(says(r->report, "1 vertices only touch"));
  EXPECT_NEAR(r->sequences[0].frames[1][4].z(), -2e-3, 1e-12);
}

TEST_F(Import, OpenMeshNamesItsEdgesAndCanBeRepairedOrDrawn) {
  std::string text = kHalfCube;
  text.erase(text.rfind("f 3 4 8 7"), 10);  // one side missing
  write("open.obj", text);
  const std::string e = errorOf(plain("open.obj", SurfaceClosure::requireClosed, HalfSide::whole));
  EXPECT_NE(e.find("4 open"), std::string::npos) << e;
  EXPECT_NE(e.find("from (0.00, 10.00, -10.00) to (10.00, 10.00, -10.00) mm"), std::string::npos)
      << e;
  const auto r = importMeshes(folder, plain("open.obj", SurfaceClosure::repair, HalfSide::whole));
  ASSERT_TRUE(r) << r.error().text();
  EXPECT_NEAR(volume(r->anatomy.structures[0].mesh), 4e-6, 1e-12);
  EXPECT_TRUE(says(r->report, "1 holes filled with 2 triangles"));
  const auto d = importMeshes(folder, plain("open.obj", SurfaceClosure::drawOnly, HalfSide::whole));
  ASSERT_TRUE(d);
  EXPECT_TRUE(d->anatomy.structures[0].drawOnly);
}

TEST_F(Import, RepairTurnsInconsistentFacesAndKeepsSequences) {
  std::string text = kHalfCube;
  text.replace(text.find("f 5 6 7 8"), 9, "f 5 8 7 6");
  write("t_0.obj", text);
  write("t_1.obj", text);
  const auto r = importMeshes(folder, plain("t_%d.obj", SurfaceClosure::repair, HalfSide::whole));
  ASSERT_TRUE(r) << r.error().text();
  EXPECT_NEAR(volume(r->anatomy.structures[0].mesh), 4e-6, 1e-12);
  EXPECT_EQ(r->sequences[0].frames[1], r->anatomy.structures[0].mesh.positions);
}

TEST_F(Import, BrokenObjFilesAreLocated) {
  write("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_NE(errorOf(plain("nan.obj")).find("nan.obj:2"), std::string::npos);
  const std::string body = ellipsoidObj({25, 37, 20}, false);
  write("cut.obj", body.substr(0, body.size() - 8));
  EXPECT_NE(errorOf(plain("cut.obj")).find("cut off"), std::string::npos)
      << errorOf(plain("cut.obj"));
  write("cut.obj", body.substr(0, body.find("f ")));
  EXPECT_NE(errorOf(plain("cut.obj")).find("no faces"), std::string::npos)
      << errorOf(plain("cut.obj"));
  write("far.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2000000000\n");
  EXPECT_NE(errorOf(plain("far.obj")).find("vertex 2000000000"), std::string::npos);
  write("empty.obj", "");
  EXPECT_NE(errorOf(plain("empty.obj")), "no error");
  EXPECT_NE(errorOf(plain("absent.obj")).find("no such file"), std::string::npos);
  write("what.xyzw", "hello");
  EXPECT_NE(errorOf(plain("what.xyzw")).find("can't be read as a mesh"), std::string::npos);
}

TEST_F(Import, BrokenPlyAndStlFilesAreRefused) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty "
      "float y\nproperty float z\nelement face {}\nproperty list uchar int "
      "vertex_indices\nend_header\n";
  const auto ply = [&](long v, long f, const std::string& body) {
    return fmt::format(fmt::runtime(head), v, f) + body;
  };
  write("huge.ply", ply(4000000000, 4000000000, "0 0 0\n"));
  EXPECT_NE(errorOf(plain("huge.ply")).find("promises"), std::string::npos);
  write("nan.ply", ply(3, 1, "0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n"));
  EXPECT_NE(errorOf(plain("nan.ply")), "no error");
  write("index.ply", ply(3, 1, "0 0 0\n1 0 0\n0 1 0\n3 0 1 77\n"));
  EXPECT_NE(errorOf(plain("index.ply", SurfaceClosure::drawOnly)), "no error");
  write("none.ply", ply(3, 0, "0 0 0\n1 0 0\n0 1 0\n"));
  EXPECT_NE(errorOf(plain("none.ply")), "no error");
  std::string stl(84 + 50 * 3, '\0');
  const std::uint32_t promised = 900;
  std::memcpy(stl.data() + 80, &promised, 4);
  write("cut.stl", stl);
  EXPECT_NE(errorOf(plain("cut.stl")).find("promises 900 triangles"), std::string::npos);
  write("text.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n");
  EXPECT_NE(errorOf(plain("text.stl")).find("endsolid"), std::string::npos);
}

TEST_F(Import, NamedObjectsOfOneFile) {
  std::string text = kHalfCube;
  text = "o cube\n" + text +
         "o other\nv 50 0 0\nv 60 0 0\nv 50 10 0\nv 50 0 10\nf 9 11 10\n"
         "f 9 10 12\nf 9 12 11\nf 10 11 12\n";
  write("all.obj", text);
  ImportDef def = plain("all.obj");
  def.structures[0].object = "other";
  const auto r = importMeshes(folder / "all.obj", def);
  ASSERT_TRUE(r) << r.error().text();
  EXPECT_EQ(r->anatomy.structures[0].mesh.triangles.size(), 4u);
  def.structures[0].object = "othr";
  EXPECT_NE(errorOf(def).find("Did you mean other?"), std::string::npos) << errorOf(def);
}
}  // namespace
}  // namespace swallowclip::anatomy
