// SPDX-License-Identifier: MIT
#include <cmath>
#include <functional>
#include <limits>

#include "frame/sample_history.h"

namespace swallowclip::frame {
namespace {

TEST(History, SampleIsSound) {
  EXPECT_EQ(sampleHistory().validate(), "");
}

TEST(History, FindsByName) {
  const History h = sampleHistory();
  ASSERT_NE(h.find("tongue"), nullptr);
  EXPECT_EQ(h.find("tongue")->material, "muscle");
  EXPECT_EQ(h.find("nose"), nullptr);
  ASSERT_NE(h.landmark("tongue_tip"), nullptr);
  EXPECT_EQ(h.landmark("tongue"), nullptr);
  EXPECT_STREQ(name(Region::hypopharynx), "hypopharynx");
  EXPECT_STREQ(name(Region::swallowed), "swallowed");
}

TEST(History, RigidPositionsFollowThePose) {
  StructureTrack s;
  s.rest = {Vec3f(1, 0, 0)};
  s.poses = {{Quat(Eigen::AngleAxisd(kPi / 2, Vec3::UnitZ())), Vec3(0, 0, 0.5)}};
  EXPECT_LT((s.at(0)[0] - Vec3f(0, 1, 0.5f)).norm(), 1e-7f);
}

TEST(History, DigestSeesEveryPartOfItsFrameAndNoOther) {
  const History h = sampleHistory();
  const std::vector<std::function<void(History&)>> changes = {
      [](History& x) { x.structures[0].poses[2].t.x() += 1e-15; },
      [](History& x) { x.structures[1].positions[2][0].x() += 1e-6f; },
      [](History& x) { x.skin.positions[2][3].y() += 1e-6f; },
      [](History& x) { x.skin.velocities[2][3].y() += 1e-6f; },
      [](History& x) { x.skin.film_m[2][1] += 1e-7f; },
      [](History& x) { x.bolus.positions[2][6].z() += 1e-6f; },
      [](History& x) { x.bolus.state[2][6] = ParticleState::film; },
      [](History& x) { x.bolus.densityRatio[2][0] += 1e-6f; }};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    History changed = h;
    changed.bolus.state[2][6] = ParticleState::fluid;
    History same = changed;
    changes[i](changed);
    EXPECT_NE(changed.digest(2), same.digest(2)) << "change " << i;
    EXPECT_EQ(changed.digest(1), same.digest(1)) << "change " << i;
  }
}

/// One fault each, and a word its message must hold.
struct Fault {
  const char* word;
  std::function<void(History&)> make;
};

TEST(History, EveryFaultIsNamed) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Fault> faults = {
      {"version", [](History& h) { h.meta.version = 2; }},
      {"fps", [](History& h) { h.meta.fps = 0; }},
      {"cue_s", [](History& h) { h.meta.cue_s = std::nan(""); }},
      {"time_s", [](History& h) { h.time_s.clear(); }},
      {"time_s", [](History& h) { h.time_s[2] = h.time_s[1]; }},
      {"mandible poses", [](History& h) { h.structures[0].poses.pop_back(); }},
      {"quaternion", [](History& h) { h.structures[0].poses[1].q.w() = 3; }},
      {"tongue positions frame 3", [](History& h) { h.structures[1].positions[3].pop_back(); }},
      {"tongue triangles", [](History& h) { h.structures[1].triangles[0][2] = 16; }},
      {"used twice", [](History& h) { h.structures[1].name = "hyoid"; }},
      {"plain word", [](History& h) { h.structures[1].name = "../x"; }},
      {"skin positions frame 1", [=](History& h) { h.skin.positions[1][2].x() = nan; }},
      {"metres", [](History& h) { h.skin.positions[1][2].x() = 40; }},
      {"skin wall", [](History& h) { h.skin.wall[4] = static_cast<Wall>(9); }},
      {"skin u", [](History& h) { h.skin.u.pop_back(); }},
      {"skin film_m", [](History& h) { h.skin.film_m.pop_back(); }},
      {"bolus velocities", [=](History& h) { h.bolus.velocities[4][0].z() = nan; }},
      {"bolus region", [](History& h) { h.bolus.region[4][0] = static_cast<Region>(7); }},
      {"bolus state", [](History& h) { h.bolus.state.clear(); }},
      {"ledger", [](History& h) { h.ledger.pop_back(); }},
      {"landmark", [](History& h) { h.landmarks[0].positions.pop_back(); }},
      {"event", [](History& h) { h.plannedEvents[0].name = "two\nlines"; }}};
  for (const Fault& fault : faults) {
    History h = sampleHistory();
    fault.make(h);
    EXPECT_NE(h.validate().find(fault.word), std::string::npos)
        << "expected \"" << fault.word << "\" in \"" << h.validate() << "\"";
  }
}
}  // namespace
}  // namespace swallowclip::frame
