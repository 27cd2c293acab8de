// SPDX-License-Identifier: MIT
#include <map>
#include <sstream>

#include "core/file.h"
#include "frame/exporter.h"
#include "frame/sample_history.h"

namespace swallowclip::frame {
namespace {

/// Lines of a CSV without quoted fields.
std::vector<std::vector<std::string>> parseCsv(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

TEST(Exporter, ParticlesCsvReadsBack) {
  const Scratch folder;
  const History h = sampleHistory();
  ASSERT_EQ(exportHistory(h, ExportFormat::csv, folder.path()).value_or(0), 2);
  const auto rows = parseCsv(*readFile(folder / "particles.csv"));
  ASSERT_EQ(rows.size(), 1u + 5 * 7);
  EXPECT_EQ(rows[0],
            (std::vector<std::string>{"frame", "time_s", "id", "x_mm", "y_mm", "z_mm", "region"}));
  for (std::size_t r = 1; r < rows.size(); ++r) {
    ASSERT_EQ(rows[r].size(), 7u);
    const std::size_t f = std::stoul(rows[r][0]), i = std::stoul(rows[r][2]);
    EXPECT_EQ(f, (r - 1) / 7);
    EXPECT_EQ(i, (r - 1) % 7);
    EXPECT_NEAR(std::stod(rows[r][1]), h.time_s[f], 5e-7);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(std::stod(rows[r][static_cast<std::size_t>(3 + k)]),
                  1000.0 * h.bolus.positions[f][i][k], 6e-6);
    const bool gone = h.bolus.state[f][i] == ParticleState::swallowed;
    EXPECT_EQ(rows[r][6], gone ? "swallowed" : name(h.bolus.region[f][i]));
  }
}

TEST(Exporter, LandmarksCsvReadsBackAndQuotes) {
  const Scratch folder;
  History h = sampleHistory();
  ASSERT_TRUE(exportHistory(h, ExportFormat::csv, folder.path()));
  const auto rows = parseCsv(*readFile(folder / "landmarks.csv"));
  ASSERT_EQ(rows.size(), 1u + 5 * 2);
  EXPECT_EQ(rows[4][2], "tongue_tip");
  EXPECT_NEAR(std::stod(rows[4][5]), 1000.0 * h.landmarks[1].positions[1].z(), 6e-6);
  h.landmarks[0].name = "a, \"b\"";
  ASSERT_TRUE(exportHistory(h, ExportFormat::csv, folder.path()));
  EXPECT_NE(readFile(folder / "landmarks.csv")->find("0,0.000000,\"a, \"\"b\"\"\","),
            std::string::npos);
}

TEST(Exporter, ObjHoldsTheMovedVertices) {
  const Scratch folder;
  const History h = sampleHistory();
  EXPECT_EQ(exportHistory(h, ExportFormat::obj, folder.path()).value_or(0), 5 * 4);
  std::istringstream obj(*readFile(folder / "obj/hyoid_0003.obj"));
  std::vector<Vec3> v;
  std::size_t faces = 0;
  for (std::string line; std::getline(obj, line);) {
    std::istringstream words(line);
    std::string kind;
    double x = 0, y = 0, z = 0;
    words >> kind >> x >> y >> z;
    if (kind == "v") v.emplace_back(x, y, z);
    if (kind == "f") ++faces;
  }
  const auto expected = h.find("hyoid")->at(3);
  ASSERT_EQ(v.size(), expected.size());
  EXPECT_EQ(faces, h.find("hyoid")->triangles.size());
  for (std::size_t i = 0; i < v.size(); ++i)
    EXPECT_LT((v[i] - 1000.0 * expected[i].cast<double>()).norm(), 2e-5);
}

TEST(Exporter, VtpHasACollectionAndEveryFrame) {
  const Scratch folder;
  const History h = sampleHistory();
  EXPECT_EQ(exportHistory(h, ExportFormat::vtp, folder.path()).value_or(0), 5 * 3 + 1);
  const std::string pvd = *readFile(folder / "swallow.pvd");
  for (const char* file : {"vtp/structures_0000.vtp", "vtp/skin_0004.vtp", "vtp/bolus_0004.vtp"}) {
    EXPECT_NE(pvd.find(file), std::string::npos);
    EXPECT_TRUE(std::filesystem::exists(folder / file));
  }
  const std::string bolus = *readFile(folder / "vtp/bolus_0002.vtp");
  for (const char* array : {"\"velocity\"", "\"density\"", "\"state\"", "\"region\""})
    EXPECT_NE(bolus.find(array), std::string::npos) << array;
}

TEST(Exporter, EmptyBolusGivesAHeaderOnly) {
  const Scratch folder;
  ASSERT_TRUE(exportHistory(sampleHistory(2, 3, 0), ExportFormat::csv, folder.path()));
  EXPECT_EQ(*readFile(folder / "particles.csv"), "frame,time_s,id,x_mm,y_mm,z_mm,region\n");
}

TEST(Exporter, UnknownFormatNamesTheNearest) {
  EXPECT_EQ(exportFormat("vtp").value(), ExportFormat::vtp);
  EXPECT_EQ(exportFormat("cvs").error().remedy, "Did you mean csv?");
}

TEST(Exporter, UnwritableFolderIsAnError) {
  const Scratch folder;
  ASSERT_TRUE(writeFile(folder / "file", "x"));
  const Result<int> done = exportHistory(sampleHistory(), ExportFormat::csv, folder / "file/in");
  ASSERT_FALSE(done);
  EXPECT_FALSE(done.error().remedy.empty());
}
}  // namespace
}  // namespace swallowclip::frame
