// SPDX-License-Identifier: MIT
// Proofs of the default scene's motion, for every sequential mesh of every swallow that ships.
#include <gtest/gtest.h>

#include <cmath>

#include "airway/interpenetration.h"
#include "anatomy/anatomy_builder.h"
#include "kinematics/choreography.h"
#include "kinematics/events.h"
#include "scene/anatomy_file.h"
#include "scene/lumen_file.h"
#include "scene/swallow_file.h"

namespace swallowclip {
namespace {
const std::filesystem::path kScenes = std::filesystem::path(SWALLOWCLIP_SOURCE_DIR) / "scenes";

struct Scene {
  anatomy::Lumen lumen;
  anatomy::SoftParts soft;
  Scene(anatomy::LumenDef l, anatomy::SoftDef d) : lumen(std::move(l)), soft(lumen, std::move(d)) {}
};

const Scene& adult() {
  static const Scene scene(scene::loadLumenDef(kScenes / "adult/lumen.json").value(),
                           scene::loadSoftDef(kScenes / "adult/soft.json").value());
  return scene;
}

kinematics::SwallowDef swallow(const std::string& name) {
  auto def = scene::loadSwallow(kScenes / "swallows" / (name + ".json"));
  EXPECT_TRUE(def) << (def ? "" : def.error().text());
  return def ? *def : kinematics::SwallowDef{};
}

class Motion : public testing::TestWithParam<const char*> {};

TEST(DefaultScene, SolidsAndSkinAreClosed) {
  const auto& skin = adult().lumen.skin();
  const auto report = checkManifold(skin.triangles, static_cast<int>(skin.wall.size()));
  EXPECT_TRUE(report.closed()) << report.text();
  for (const auto& s : adult().soft.structures()) {
    const auto r = checkManifold(s.mesh.triangles, static_cast<int>(s.mesh.positions.size()));
    EXPECT_TRUE(r.closed()) << s.name << ": " << r.text();
    EXPECT_GT(volume(s.mesh), 0) << s.name;
  }
}

TEST(DefaultScene, TongueHasTheThesisBreadthAndAPlausibleVolume) {
  const auto& tongue = adult().soft.structures().front();
  double lo = 0, hi = 0;
  for (const Vec3& p : tongue.mesh.positions) {
    lo = std::min(lo, p.x());
    hi = std::max(hi, p.x());
  }
  EXPECT_NEAR(hi - lo, 51.9e-3, 0.05e-3);  // Hopkin 1967
  const double volume_cm3 = adult().soft.tongueVolume_m3() * 1e6;
  EXPECT_GT(volume_cm3, 60);  // clinical-reference 5: 67-83, body without floor of mouth
  EXPECT_LT(volume_cm3, 103);
}

TEST(DefaultScene, NormalSwallowIs109MeshesOver318Centiseconds) {
  const auto baked = kinematics::bake({}, adult().lumen, adult().soft, swallow("c04-s0"), 34);
  EXPECT_EQ(baked.sequence.frames(), 109);
  EXPECT_NEAR(baked.sequence.end_s(), 3.18, 0.01);
}

TEST_P(Motion, TongueKeepsItsVolumeAndWallsNeverCross) {
  const auto baked = kinematics::bake({}, adult().lumen, adult().soft, swallow(GetParam()), 34);
  ThreadPool pool(2);
  const auto& tongue = baked.sequence.structures.front();
  double worst = 0;
  for (int k = 0; k < baked.sequence.frames(); ++k) {
    const double v = volume(tongue.frames[k], tongue.triangles);
    ASSERT_NEAR(v / adult().soft.tongueVolume_m3(), 1, 0.02) << "frame " << k;
    const auto hit =
        airway::maxInterpenetration(baked.skin[k], adult().lumen.skin().triangles, pool);
    worst = std::max(worst, hit.depth_m);
    EXPECT_LE(hit.depth_m, 0.5e-3)
        << "frame " << k << ", vertex " << hit.vertex << ", s "
        << adult().lumen.skin().s_m[hit.vertex] << ", u " << adult().lumen.skin().u[hit.vertex];
  }
  RecordProperty("deepest_mm", fmt::format("{:.3f}", worst * 1e3));
}

// The dorsum is prescribed and the volume kept, so the floor gives way: not into bone.
TEST_P(Motion, TheTongueStaysOutOfTheMandible) {
  static const auto bones =
      anatomy::buildRigidParts(scene::loadAnatomyDef(kScenes / "adult/anatomy.json").value());
  ASSERT_TRUE(bones) << bones.error().text();
  const TriMesh& mandible = bones->find("mandible")->mesh;
  const auto baked = kinematics::bake({}, adult().lumen, adult().soft, swallow(GetParam()), 34);
  const auto& tongue = baked.sequence.structures.front();
  ThreadPool pool(2);
  double worst = 0;
  for (int k = 0; k < baked.sequence.frames(); k += 2) {
    const auto hit = airway::depthInside({tongue.frames[k], tongue.triangles}, mandible, pool);
    worst = std::max(worst, hit.depth_m);
    EXPECT_LE(hit.depth_m, 1.2e-3)
        << "frame " << k << ", at (" << tongue.frames[k][std::max(0, hit.vertex)].transpose()
        << ") m";
  }
  RecordProperty("deepest_mm", fmt::format("{:.3f}", worst * 1e3));
}

double tet(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a) / 6;
}

// Room of the first `stretches` open stretches of the main lumen behind the contact front: where
// the bolus is. A row of the lattice is shut when no particle could be in it (gap below 0.5 mm
// everywhere).
double pocket_m3(const anatomy::Lumen& lumen, const anatomy::LumenPose& pose, double end_m,
                 int stretches = 1) {
  const anatomy::LumenSheets sheets = lumen.evaluate(pose);
  const auto open = [&](int r) {
    for (int c = 0; c < lumen.columns(); ++c)
      if (pose.gap_m[lumen.index(r, c)] > 0.5e-3) return true;
    return false;
  };
  double sum = 0;
  for (int r = 0; r + 1 < lumen.rowAt(end_m); ++r) {
    if (!open(r)) {
      if (r > 0 && open(r - 1) && --stretches == 0) break;
      continue;
    }
    for (int c = 0; c + 1 < lumen.columns(); ++c) {
      const auto f = [&](int dr, int dc) { return sheets.f[lumen.index(r + dr, c + dc)]; };
      const auto m = [&](int dr, int dc) { return sheets.m[lumen.index(r + dr, c + dc)]; };
      // Two wedges of three tetrahedra each: exact however much the sheets' normals fan out.
      const auto wedge = [&](int r1, int c1, int r2, int c2) {
        const Vec3 a = f(0, 0), b = f(r1, c1), d = f(r2, c2), top = m(r1, c1);
        return tet(a, b, d, m(0, 0)) + tet(b, d, m(0, 0), top) + tet(d, m(0, 0), top, m(r2, c2));
      };
      sum += std::abs(wedge(1, 0, 1, 1) + wedge(1, 1, 0, 1));
    }
  }
  return sum;
}

TEST_P(Motion, TheHeldBolusAlwaysHasRoom) {
  const auto def = swallow(GetParam());
  const kinematics::Choreography motion(adult().lumen, def);
  // What a hollow keeps, or a tongue base that does not come all the way, is a second one.
  const bool keeps = !def.hollows.empty() || def.track("tongue_base").amplitude < 1;
  const int stretches = keeps ? 2 : 1;
  for (double t = 0; t <= def.duration_s; t += 1.0 / 34) {
    const double tau = t - def.bpm_s;
    if (def.frontAmplitude > 0 && def.front_m(tau) > 0.12) break;  // tail is in the pharynx
    // A shut UES adds nothing; an open one has the head of the bolus in it.
    const double room = pocket_m3(adult().lumen, motion.lumenPose(t), 0.184, stretches);
    ASSERT_GE(room, 1.1 * def.volume_m3) << "t = " << t;
  }
  const double held = pocket_m3(adult().lumen, motion.lumenPose(0), 0.068);
  EXPECT_GE(held, 1.15 * def.volume_m3);
  EXPECT_LE(held, 1.3 * def.volume_m3);
}

class Volume : public testing::TestWithParam<std::pair<const char*, int>> {};
INSTANTIATE_TEST_SUITE_P(Offered, Volume,
                         testing::Values(std::pair{"c04-s0", 1}, std::pair{"c04-s0", 2},
                                         std::pair{"c04-s0", 10}, std::pair{"c04-s0", 20},
                                         std::pair{"c04-s1", 15}, std::pair{"c04-s2", 10},
                                         std::pair{"c04-s3", 10}, std::pair{"c15-s4", 20}),
                         [](const auto& i) {
                           std::string name = fmt::format("{}_{}mL", i.param.first, i.param.second);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST_P(Volume, HasRoomAndWallsThatNeverCross) {
  auto def = swallow(GetParam().first);
  def.offer(GetParam().second * 1e-6);
  const anatomy::Lumen& lumen = adult().lumen;
  const kinematics::Choreography motion(lumen, def);
  for (double t = 0; t <= def.duration_s; t += 1.0 / 34) {
    const double tau = t - def.bpm_s;
    if (def.track("ues").at(tau) > 0.5 * def.track("ues").peakValue) break;  // the bolus leaves
    ASSERT_GE(pocket_m3(lumen, motion.lumenPose(t), 0.184), 1.1 * def.volume_m3) << "t = " << t;
  }
  const double held = pocket_m3(lumen, motion.lumenPose(0), 0.068);
  EXPECT_GE(held, 1.15 * def.volume_m3);
  EXPECT_LE(held, 1.3 * def.volume_m3);
  const auto baked = kinematics::bake({}, lumen, adult().soft, def, 34);
  const auto& tongue = baked.sequence.structures.front();
  ThreadPool pool(2);
  for (int k = 0; k < baked.sequence.frames(); k += 2) {
    EXPECT_LE(airway::maxInterpenetration(baked.skin[k], lumen.skin().triangles, pool).depth_m,
              0.5e-3)
        << "frame " << k;
    EXPECT_NEAR(volume(tongue.frames[k], tongue.triangles) / adult().soft.tongueVolume_m3(), 1,
                0.02);  // DESIGN section 3
  }
}

TEST(Offer, OnlyAnotherVolumeChangesTheSwallow) {
  const auto file = swallow("c04-s0");
  auto same = file, twice = file;
  same.offer(file.volume_m3), twice.offer(2 * file.volume_m3);
  EXPECT_DOUBLE_EQ(same.grooveEnd_m, file.grooveEnd_m);
  for (const auto& [key, track] : file.tracks) {
    EXPECT_EQ(same.track(key).peakValue, track.peakValue) << key;
    EXPECT_EQ(same.track(key).delay_s, track.delay_s) << key;
    EXPECT_EQ(same.track(key).hold_s, track.hold_s) << key;
  }
  EXPECT_GT(twice.track("ues").peakValue, file.track("ues").peakValue);
  EXPECT_GT(twice.track("tongue_base").delay_s, file.track("tongue_base").delay_s);
  EXPECT_GT(twice.track("hyoid_superior").hold_s, file.track("hyoid_superior").hold_s);
}

// The mirror image of a swallow moves every wall as the swallow does, seen in a mirror.
TEST(DefaultScene, LeftAndRightVariantsAreMirrorImages) {
  const anatomy::Lumen& lumen = adult().lumen;
  const auto left = swallow("c13-s2"), right = swallow("c13-s2-right");
  const kinematics::Choreography a(lumen, left), b(lumen, right);
  double widest = 0;
  for (double t = 1.2; t < 2.6; t += 0.1) {
    const auto p = lumen.evaluate(a.lumenPose(t)), q = lumen.evaluate(b.lumenPose(t));
    for (int r = 0; r < lumen.rows(); ++r)
      for (int c = 0; c < lumen.columns(); ++c) {
        const int i = lumen.index(r, c), j = lumen.index(r, lumen.columns() - 1 - c);
        for (const auto& [x, y] : {std::pair{p.m[i], q.m[j]}, std::pair{p.f[i], q.f[j]}})
          ASSERT_LT((Vec3(-x.x(), x.y(), x.z()) - y).norm(), 1e-9) << "t " << t << ", row " << r;
        widest = std::max(widest, p.f[i].x() + p.f[j].x());
      }
  }
  EXPECT_GT(widest, 2e-3);  // the left wall is farther out than the right one
}

TEST(PlannedEvents, ComeInTheRequiredOrder) {
  std::map<std::string, double> t;
  for (const auto& [name, time] : kinematics::plannedEvents(swallow("c04-s0"))) t[name] = time;
  EXPECT_LT(t["tip_press"], t["BPM"]);
  EXPECT_LE(t["BPM"], t["HYB"] + 1e-9);
  EXPECT_LT(t["HYB"], t["LVC"]);
  EXPECT_LT(t["UESO"], t["UESMax"]);
  EXPECT_LT(t["UESMax"], t["UESC"]);
  EXPECT_LE(t["UESC"], t["LVCoff"] + 0.1);
  EXPECT_LT(t["LVCoff"], t["SwRest"]);
}

INSTANTIATE_TEST_SUITE_P(Swallows, Motion,
                         testing::Values("c04-s0", "c04-s1", "c04-s2", "c04-s3", "c04-s4", "c05-s1",
                                         "c05-s2", "c05-s3", "c08-s1", "c08-s2", "c08-s3", "c13-s1",
                                         "c13-s2", "c13-s2-right", "c13-s3", "c15-s1", "c15-s2",
                                         "c15-s3", "c15-s4"),
                         [](const auto& named) {
                           std::string name = named.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });
}  // namespace
}  // namespace swallowclip
