// SPDX-License-Identifier: MIT
// The default scene's bones, cartilages and teeth: closed, outward, exactly symmetric, of adult
// size (clinical-reference section 5), clear of tongue, palate mucosa and pharyngeal wall.
#include "anatomy/rigid_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "anatomy/anatomy_builder.h"
#include "anatomy/half_surface.h"
#include "scene/anatomy_file.h"

namespace swallowclip::anatomy {
namespace {

const AnatomyDef& adultDef() {
  static const AnatomyDef def = [] {
    auto loaded = scene::loadAnatomyDef(SWALLOWCLIP_SOURCE_DIR "/scenes/adult/anatomy.json");
    EXPECT_TRUE(loaded) << loaded.error().text();
    return loaded ? *loaded : AnatomyDef{};
  }();
  return def;
}
const Anatomy& adult() {
  static const Anatomy built = [] {
    auto anatomy = buildRigidParts(adultDef());
    EXPECT_TRUE(anatomy) << anatomy.error().text();
    return anatomy ? *anatomy : Anatomy{};
  }();
  return built;
}
const TriMesh& meshOf(const std::string& name) {
  const Structure* s = adult().find(name);
  static const TriMesh empty;
  EXPECT_NE(s, nullptr) << name;
  return s ? s->mesh : empty;
}
Eigen::AlignedBox3d box_mm(const std::string& name) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : meshOf(name).positions) box.extend(p * 1e3);
  return box;
}
Vec3 landmark_mm(const std::string& name) {
  const auto it = adult().landmarks.find(name);
  EXPECT_NE(it, adult().landmarks.end()) << name;
  return it == adult().landmarks.end() ? Vec3(Vec3::Zero()) : Vec3(it->second * 1e3);
}
void expectWithin(const char* what, double value, double low, double high) {
  EXPECT_GE(value, low) << what;
  EXPECT_LE(value, high) << what;
}

TEST(RigidParts, HasAllStructures) {
  for (const char* name : {"maxilla",
                           "upper_teeth",
                           "lower_teeth",
                           "mandible",
                           "hyoid",
                           "thyroid",
                           "cricoid",
                           "arytenoid_L",
                           "arytenoid_R",
                           "epiglottis",
                           "trachea",
                           "c2",
                           "c3",
                           "c4",
                           "c5",
                           "c6",
                           "disc_c2c3",
                           "disc_c3c4",
                           "disc_c4c5",
                           "disc_c5c6",
                           "c1",
                           "c7",
                           "palate_mucosa",
                           "upper_gum",
                           "lower_gum",
                           "uvula",
                           "palatoglossal_arch_L",
                           "palatopharyngeal_arch_R",
                           "floor_of_mouth",
                           "face"})
    EXPECT_NE(adult().find(name), nullptr) << name;
  EXPECT_EQ(adult().find("epiglottis")->carrier, Carrier::epiglottis);
  EXPECT_EQ(adult().find("arytenoid_R")->carrier, Carrier::arytenoidR);
  EXPECT_EQ(adult().find("lower_teeth")->carrier, Carrier::mandible);
}

TEST(RigidParts, EverySolidIsClosedAndFacesOutwards) {
  size_t total = 0;
  for (const Structure& s : adult().structures) {
    const ManifoldReport report =
        checkManifold(s.mesh.triangles, static_cast<int>(s.mesh.positions.size()));
    EXPECT_TRUE(report.closed()) << s.name << ": " << report.text();
    EXPECT_GT(volume(s.mesh), 0) << s.name;
    total += s.mesh.triangles.size();
  }
  EXPECT_LE(total, 32000u);  // views cut or hide half of what there is: 40k in view
}

TEST(RigidParts, NoSliverOrFoldedTriangles) {
  for (const Structure& s : adult().structures)
    for (const Triangle& t : s.mesh.triangles) {
      const Vec3 &a = s.mesh.positions[t[0]], &b = s.mesh.positions[t[1]],
                 &c = s.mesh.positions[t[2]];
      EXPECT_GT((b - a).cross(c - a).norm() / 2, 1e-10) << s.name;  // 0.0001 mm2
    }
}

using Key = std::tuple<double, double, double>;
std::set<Key> pointSet(const TriMesh& mesh, bool flip) {
  std::set<Key> keys;
  for (const Vec3& p : mesh.positions)
    keys.insert({flip && p.x() != 0 ? -p.x() : p.x(), p.y(), p.z()});
  return keys;
}

TEST(RigidParts, LeftAndRightAreExactMirrorImages) {
  for (const Structure& s : adult().structures) {
    std::string twin = s.name;
    if (twin.ends_with("_L"))
      twin.back() = 'R';
    else if (twin.ends_with("_R"))
      twin.back() = 'L';
    EXPECT_EQ(pointSet(s.mesh, true), pointSet(meshOf(twin), false)) << s.name;
  }
}

TEST(RigidParts, StitchingAddsNoVertices) {
  // whole = 2 x half - shared midplane vertices, so midplane vertices appear once
  for (const Structure& s : adult().structures) {
    std::set<Key> all = pointSet(s.mesh, false);
    EXPECT_EQ(all.size(), s.mesh.positions.size()) << s.name;
  }
}

// Ranges: women's to men's mean of clinical-reference section 5, each 15 % wider. Jaw widths,
// palate length and spine (ANS-PNS of the references: 53-55 mm; section 5: 41-49) are assumed
// ranges.
TEST(RigidParts, DimensionsAreAdult) {
  const auto hyoid = box_mm("hyoid"), thyroid = box_mm("thyroid"), cricoid = box_mm("cricoid");
  expectWithin("hyoid greater horn span", hyoid.sizes().x(), 43.1 * .85, 52.6 * 1.15);
  expectWithin("hyoid length", hyoid.sizes().y(), 32.5 * .85, 39.1 * 1.15);
  expectWithin("thyroid width", thyroid.sizes().x(), 42.6 * .85, 50.6 * 1.15);
  expectWithin("cricoid width", cricoid.sizes().x(), 26.9 * .85, 30.1 * 1.15);
  expectWithin("cricoid depth", cricoid.sizes().y(), 20.0 * .85, 25.3 * 1.15);
  expectWithin("cricoid lamina height",
               landmark_mm("cricoid_lamina_top").z() - landmark_mm("cricoid_lamina_inferior").z(),
               18.4 * .85, 21.2 * 1.15);
  expectWithin("hyoid to thyroid notch",
               landmark_mm("hyoid_body_anterior_inferior").z() - landmark_mm("thyroid_notch").z(),
               10.9 * .85, 12.8 * 1.15);
  const auto epiglottis = box_mm("epiglottis");
  expectWithin("epiglottis width", epiglottis.sizes().x(), 22.1, 29.3 * 1.05);
  expectWithin("epiglottis length",
               (landmark_mm("epiglottis_tip_cartilage") - landmark_mm("epiglottis_petiole")).norm(),
               27.9, 35.9 * 1.15);
  expectWithin("trachea width", box_mm("trachea").sizes().x(), 15.3, 18.9);
  const auto mandible = box_mm("mandible");
  expectWithin("bicondylar width", mandible.sizes().x(), 100, 124);
  expectWithin("bigonial width", 2 * landmark_mm("gonion_L").x(), 86, 106);
  expectWithin("hard palate length", -landmark_mm("ANS").y(), 44, 56);
  expectWithin("C2-C4 distance",
               (landmark_mm("C2_anterior_inferior") - landmark_mm("C4_anterior_inferior")).norm(),
               30, 40);
}

TEST(RigidParts, TeethBiteWithAGap) {
  double closest_mm = 1e9;
  for (const Vec3& u : meshOf("upper_teeth").positions)
    for (const Vec3& l : meshOf("lower_teeth").positions)
      closest_mm = std::min(closest_mm, (u - l).norm() * 1e3);
  expectWithin("closest teeth, mm", closest_mm, 0.3, 1.5);
  const TriMesh& upper = meshOf("upper_teeth");
  for (const Vec3& l : meshOf("lower_teeth").positions)
    EXPECT_LT(windingNumber(l, upper.positions, upper.triangles), 0.5);
  // overbite: upper incisors reach below the lower tips and lie in front of them
  EXPECT_LT(landmark_mm("upper_incisor_tip").z(), landmark_mm("lower_incisor_tip").z());
  EXPECT_LT(landmark_mm("upper_incisor_tip").y(), landmark_mm("lower_incisor_tip").y());
}

TEST(RigidParts, PalateBoneLiesAboveTheMucosa) {
  const TriMesh& mesh = meshOf("maxilla");
  for (double y = -44; y <= -1; y += 2)
    for (double f = 0; f <= 0.96; f += 0.12) {
      const double x = f * interpolate(adultDef().palate.halfWidth_m, y * 1e-3);
      const Vec3 mucosa(x + 1e-6, y * 1e-3, palateMucosaZ_m(adultDef().palate, x, y * 1e-3));
      const auto inside = [&](double up_mm) {
        return windingNumber(mucosa + Vec3(0, 0, up_mm * 1e-3), mesh.positions, mesh.triangles);
      };
      const double thick_mm = adultDef().palate.mucosa_m * 1e3;
      EXPECT_LT(inside(thick_mm - 0.5), 0.5) << "bone in the mucosa at x " << x * 1e3 << " y " << y;
      if (f < 0.7) {
        EXPECT_GT(inside(thick_mm + 0.75), 0.5) << "no bone above x " << x * 1e3 << " y " << y;
      }
    }
}

TEST(RigidParts, MandibleClearsTheTongue) {
  // half-width of the tongue + 1 mm by y, below the crowns (assumed soft scene of the adult)
  const std::vector<Vec2> kTongue{{-48, 9}, {-30, 17}, {-18, 20}, {-6, 23}, {5, 26}};
  const Structure* s = adult().find("mandible");
  for (const Vec3& p : s->mesh.positions) {
    const Vec3 q = p * 1e3;
    if (q.y() < -30 || q.y() > 5 || q.z() < -50) continue;
    EXPECT_GE(std::abs(q.x()), interpolate(kTongue, q.y()) + 0.8)
        << "at (" << q.transpose() << ") mm";
  }
}

TEST(RigidParts, SpineStandsBehindThePharyngealWall) {
  for (const char* name : {"c2", "c3", "c4", "c5", "c6"})
    EXPECT_GE(box_mm(name).min().y(), 34.0) << name;  // mucosa at 31 mm, 3 mm thick
  EXPECT_LE(box_mm("cricoid").max().y(), 31.0);       // UES lumen behind it
}

TEST(RigidParts, TwoBuildsAreIdentical) {
  const auto again = buildRigidParts(adultDef());
  ASSERT_TRUE(again);
  for (size_t i = 0; i < adult().structures.size(); ++i) {
    EXPECT_EQ(again->structures[i].mesh.positions, adult().structures[i].mesh.positions);
    EXPECT_EQ(again->structures[i].mesh.triangles, adult().structures[i].mesh.triangles);
  }
}

TEST(RigidParts, OpenSweepIsRefusedWithAPlace) {
  AnatomyDef def;
  PartDef part;
  part.name = "rod";
  SweepDef sweep;
  sweep.start = Closure::loop;  // neither in the midplane nor capped
  sweep.stations.resize(2);
  sweep.stations[0].at_m = {0.02, 0, 0};
  sweep.stations[1].at_m = {0.02, 0, 0.02};
  part.sweeps.push_back(sweep);
  def.parts.push_back(part);
  const auto built = buildRigidParts(def);
  ASSERT_FALSE(built);
  EXPECT_NE(built.error().text().find("rod"), std::string::npos);
  EXPECT_NE(built.error().text().find("does not close"), std::string::npos);
}

TEST(RigidParts, CylinderHasItsVolume) {
  // a superellipse of exponent 2 swept straight: pi a b h, less the polygon's chord error
  AnatomyDef def;
  PartDef part;
  part.name = "rod";
  SweepDef sweep;
  sweep.half = true;
  sweep.start = Closure::dome;
  sweep.startDome_m = sweep.endDome_m = 1e-9;
  sweep.ringPoints = 49;
  for (double z : {0.0, 0.02}) {
    StationDef s;
    s.at_m = {0, 0, z};
    s.u_m = {0.005, 0, 0};
    s.v_m = {0, 0.008, 0};
    sweep.stations.push_back(s);
  }
  part.sweeps.push_back(sweep);
  def.parts.push_back(part);
  const auto built = buildRigidParts(def);
  ASSERT_TRUE(built) << built.error().text();
  const double exact = kPi * 0.005 * 0.008 * 0.02;
  EXPECT_NEAR(volume(built->structures[0].mesh) / exact, 1, 5e-3);
}
}  // namespace
}  // namespace swallowclip::anatomy
