// SPDX-License-Identifier: MIT
// Midsagittal sections of the default scene against those of two real people after a rigid
// alignment of midline landmarks, as a printed table (facts only; without the reference folder,
// which is no part of the repository, the test is skipped).
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <limits>

#include "anatomy/anatomy_builder.h"
#include "anatomy/soft_parts.h"
#include "reference.h"
#include "scene/anatomy_file.h"
#include "scene/json_reader.h"
#include "scene/lumen_file.h"
#include "section.h"

namespace swallowclip::anatomy {
namespace {

using test::distance_mm;
using test::section;
using test::Segment;

std::vector<Segment> midsagittal(const TriMesh& mesh) {
  return section(mesh, 1e-7);  // beside the vertices of x = 0
}

struct Person {
  std::map<std::string, std::vector<Segment>> sections;
  std::map<std::string, Vec3> landmarks;  ///< m
};

// Every structure of the default scene at its bind pose.
Person adult() {
  Person person;
  const std::filesystem::path folder = SWALLOWCLIP_SOURCE_DIR "/scenes/adult";
  auto def = scene::loadAnatomyDef(folder / "anatomy.json");
  auto lumenDef = scene::loadLumenDef(folder / "lumen.json");
  auto softDef = scene::loadSoftDef(folder / "soft.json");
  EXPECT_TRUE(def && lumenDef && softDef);
  if (!def || !lumenDef || !softDef) return person;
  auto built = buildRigidParts(*def);
  EXPECT_TRUE(built);
  if (!built) return person;
  const Lumen lumen(*lumenDef);
  const SoftParts soft(lumen, *softDef);
  for (const Structure& s : soft.structures()) person.sections[s.name] = midsagittal(s.mesh);
  // the wall's face to the lumen alone: its other face may not lend itself as the nearer one
  const LumenSheets sheets = lumen.evaluate(lumen.neutralPose());
  const int first = lumen.rowAt(lumen.def().wallStart_m),
            last = lumen.rowAt(lumen.def().uesStart_m);
  for (int r = first; r < last; ++r) {
    const auto at = [&](int row) {
      return Vec2(sheets.f[lumen.index(row, lumen.columns() / 2)].tail<2>() * 1e3);
    };
    person.sections["posterior_wall"].push_back({at(r), at(r + 1)});
  }
  for (const Structure& s : built->structures) person.sections[s.name] = midsagittal(s.mesh);
  person.landmarks = built->landmarks;
  return person;
}

// Rotation and shift in the plane that bring the real person's landmarks onto ours.
Eigen::Isometry2d alignment(const Person& ours, const scene::JsonNode& theirs, double& rms_mm) {
  std::vector<Vec2> from, to;
  for (const char* name :
       {"PNS", "ANS", "upper_incisor_tip", "menton", "hyoid_body_centre", "thyroid_notch",
        "thyroid_inferior_midline", "epiglottis_tip_cartilage", "epiglottis_petiole",
        "C2_anterior_inferior", "C4_anterior_inferior", "C6_anterior_inferior"})
    if (theirs.has(name) && ours.landmarks.count(name)) {
      from.push_back(theirs.object(name).vec3("xyz").tail<2>());
      to.push_back(ours.landmarks.at(name).tail<2>() * 1e3);
    }
  Vec2 fromMean = Vec2::Zero(), toMean = Vec2::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    fromMean += from[i] / static_cast<double>(from.size());
    toMean += to[i] / static_cast<double>(to.size());
  }
  double along = 0, across = 0;  // least squares in the plane: tan(angle) = across / along
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Vec2 f = from[i] - fromMean, t = to[i] - toMean;
    along += f.dot(t);
    across += f.x() * t.y() - f.y() * t.x();
  }
  Eigen::Isometry2d move = Eigen::Isometry2d::Identity();
  move.linear() = Eigen::Rotation2Dd(std::atan2(across, along)).toRotationMatrix();
  move.translation() = toMean - move.linear() * fromMean;
  double sum = 0;
  for (std::size_t i = 0; i < from.size(); ++i) sum += (move * from[i] - to[i]).squaredNorm();
  rms_mm = std::sqrt(sum / static_cast<double>(from.size()));
  return move;
}

TEST(SectionReference, SixStructuresLieWithinSixMillimetresOfARealPerson) {
  const auto profiles = test::referenceFolder() / "profiles.json";
  const auto landmarks = test::referenceFolder() / "landmarks.json";
  if (!std::filesystem::exists(profiles)) GTEST_SKIP() << "no reference folder at " << profiles;
  auto file = scene::JsonFile::load(profiles), marks = scene::JsonFile::load(landmarks);
  ASSERT_TRUE(file && marks);
  const Person ours = adult();
  struct Row {
    const char *what, *structure, *set, *profile;
  };
  const std::vector<Row> rows{
      {"tongue", "tongue", "ql2", "tongue_dorsum_airway_surface"},
      {"tongue, underside too", "tongue", "ql2", "tongue_outline"},
      {"hard palate", "palate_mucosa", "ql2", "hard_palate_oral"},
      {"hard palate", "palate_mucosa", "cbct", "hard_palate_oral"},
      {"soft palate", "soft_palate", "ql2", "soft_palate_outline_rest"},
      {"posterior wall", "posterior_wall", "ql2", "posterior_pharyngeal_wall_airway"},
      {"posterior wall", "posterior_wall", "cbct", "posterior_wall_constrictor_inferior"},
      {"hyoid", "hyoid", "ql2", "hyoid_body"},
      {"hyoid", "hyoid", "cbct", "hyoid_body"},
      {"thyroid", "thyroid", "ql2", "thyroid_lamina"},
      {"thyroid", "thyroid", "cbct", "thyroid_lamina"},
      {"epiglottis", "epiglottis", "ql2", "epiglottis_cartilage_outline"}};
  for (const char* set : {"ql2", "cbct"}) {
    double rms_mm = 0;
    const auto move = alignment(ours, marks->root().object("landmarks").object(set), rms_mm);
    fmt::print("{}: midline landmarks agree to {:.1f} mm rms after turning by {:.1f} degrees\n",
               set, rms_mm, Eigen::Rotation2Dd(move.linear()).angle() * 180 / kPi);
    for (const Row& row : rows) {
      if (row.set != std::string(set)) continue;
      const auto points =
          file->root().object("midsagittal").object(set).object(row.profile).points2("points_yz");
      ASSERT_FALSE(points.empty()) << row.profile;
      double sum = 0, most = 0;
      for (const Vec2& p : points) {
        const double d = distance_mm(move * p, ours.sections.at(row.structure));
        sum += d;
        most = std::max(most, d);
      }
      const double mean = sum / static_cast<double>(points.size());
      fmt::print("  {:22} {:5} mean {:4.1f} mm, most {:4.1f} mm  ({})\n", row.what, set, mean, most,
                 row.profile);
      EXPECT_LT(mean, 6) << row.what << " " << set;  // mm; the two people differ by 3-6
    }
  }
}
}  // namespace
}  // namespace swallowclip::anatomy
