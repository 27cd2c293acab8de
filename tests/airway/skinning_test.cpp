// SPDX-License-Identifier: MIT
#include "airway/skinning.h"

#include <gtest/gtest.h>

#include <random>

#include "mouth.h"

namespace swallowclip::airway {
namespace {

biomech::Model modelOf(const kinematics::MeshSequence& sequence) {
  auto model = biomech::Model::build(sequence);
  EXPECT_TRUE(model.has_value()) << (model ? "" : model.error().text());
  return std::move(*model);
}
AirwaySkin attached(const biomech::Model& model, SkinningDef def = test::mouthWalls(),
                    BindSkin skin = test::mouthSkin()) {
  auto out = attachSkin(std::move(skin), model, def);
  EXPECT_TRUE(out.has_value()) << (out ? "" : out.error().text());
  return std::move(*out);
}

TEST(Skinning, WeightsSumToOne) {
  const auto model = modelOf(test::squeezingMouth(5, 0.004));
  const AirwaySkin skin = attached(model);
  for (size_t v = 0; v < skin.bind().wall.size(); ++v) {
    ASSERT_NEAR(skin.attachment().weightSum(static_cast<int>(v)), 1, 1e-12);
    for (int i = skin.attachment().softBegin[v]; i < skin.attachment().softBegin[v + 1]; ++i)
      ASSERT_GE(skin.attachment().soft[i].barycentric.minCoeff(), -1e-15);
  }
  const AttachReport& r = skin.report();
  EXPECT_EQ(r.onSoft + r.onRigid + r.blended + r.offSurface,
            static_cast<int>(skin.bind().wall.size()));
  EXPECT_GT(r.onSoft, 200);
  EXPECT_GT(r.onRigid, 200);
  EXPECT_GT(r.blended, 10);
  EXPECT_LE(r.maxDistance_m, test::kHeight_m / 2 + 1e-9);
}

TEST(Skinning, IdentityAtRest) {
  const auto model = modelOf(test::squeezingMouth(5, 0.004));
  for (RigidBlend blend : {RigidBlend::linear, RigidBlend::dualQuaternion}) {
    SkinningDef def = test::mouthWalls();
    def.blend = blend;
    const AirwaySkin skin = attached(model, def);
    const auto now = skin.deform(model, model.rest());
    for (size_t v = 0; v < now.size(); ++v)
      ASSERT_LT((now[v] - skin.bind().mesh.positions[v]).norm(), 1e-15);
  }
}

// One rigid motion of all masters, nodes and frames alike, is one of the skin, on and off surfaces.
TEST(Skinning, OneRigidMotionOfAllMastersMovesTheSkinRigidly) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Pose> poses(1);
  for (int k = 1; k < 30; ++k)
    poses.push_back(test::poseAt(kPi * u(random), {u(random), u(random), u(random)},
                                 0.2 * Vec3(u(random), u(random), u(random))));
  const auto model = modelOf(test::mouth(
      30, [&](int k, std::vector<Vec3> p) { return test::applied(poses[k], p); },
      [&](int k) { return poses[k]; }));
  // lumen pulled in by 0.4 mm all round: every vertex is off its surface
  BindSkin inside = test::mouthSkin();
  for (Vec3& p : inside.mesh.positions)
    p = test::kLow + Vec3::Constant(4e-4) +
        (p - test::kLow)
            .cwiseProduct(Vec3::Ones() -
                          (Vec3::Constant(8e-4).cwiseQuotient(test::kHigh - test::kLow)));
  for (const BindSkin& bind : {test::mouthSkin(), inside})
    for (RigidBlend blend : {RigidBlend::linear, RigidBlend::dualQuaternion}) {
      SkinningDef def = test::mouthWalls();
      def.blend = blend;
      const AirwaySkin skin = attached(model, def, bind);
      for (int k = 0; k < 30; ++k) {
        const auto now = skin.deform(model, model.at(model.start_s() + k / model.rate_hz()));
        for (size_t v = 0; v < now.size(); ++v)
          ASSERT_LT((now[v] - poses[k].apply(bind.mesh.positions[v])).norm(), 1e-12);
      }
    }
}

TEST(Skinning, VertexOnASoftSurfaceFollowsItExactly) {
  const auto model = modelOf(test::squeezingMouth(9, 0.004));
  const AirwaySkin skin = attached(model);
  const auto state = model.at(0.05);
  const auto now = skin.deform(model, state);
  const auto& tongue = state.structures[0].positions;
  const TriMesh& rest = model.structures()[0].rest;
  int seen = 0;
  for (size_t v = 0; v < now.size(); ++v) {
    const Vec3& q0 = skin.bind().mesh.positions[v];
    if (q0.z() != 0) continue;
    ASSERT_EQ(skin.attachment().softBegin[v + 1] - skin.attachment().softBegin[v], 1);
    ASSERT_EQ(skin.attachment().rigidBegin[v + 1], skin.attachment().rigidBegin[v]);
    const SoftMaster& m = skin.attachment().soft[skin.attachment().softBegin[v]];
    Vec3 expected = Vec3::Zero(), start = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      expected += m.barycentric[k] * tongue[m.nodes[k]];
      start += m.barycentric[k] * rest.positions[m.nodes[k]];
    }
    ASSERT_LT((start - q0).norm(), 1e-15);
    ASSERT_LT((now[v] - expected).norm(), 1e-15);
    ++seen;
  }
  EXPECT_GT(seen, 200);
}

// Bound with the seal closed to 0.05 mm, the palate's skin still stays when the tongue drops.
TEST(Skinning, AClosedSealIsNotGluedTogether) {
  const auto drop = [](int k, std::vector<Vec3> p) {
    for (Vec3& x : p) x.z() += (k == 0 ? 1 : 0) * (test::kHeight_m - 5e-5);
    return p;
  };
  auto sequence = test::mouth(2, drop, [](int) { return Pose{}; });
  sequence.structures[0].rest = sequence.structures[0].frames[0];
  const auto model = modelOf(sequence);
  BindSkin bind = test::mouthSkin();
  for (Vec3& p : bind.mesh.positions)
    p.z() = test::kHeight_m - 5e-5 * (1 - p.z() / test::kHeight_m);
  const AirwaySkin skin = attached(model, test::mouthWalls(), bind);
  const auto now = skin.deform(model, model.at(model.end_s()));
  for (size_t v = 0; v < now.size(); ++v) {
    const Vec3& q0 = bind.mesh.positions[v];
    if (std::abs(q0.x()) > 0.0149 || q0.y() < 1e-4 || q0.y() > 0.0599) continue;  // the seams
    if (bind.wall[v] == test::kPalate)
      EXPECT_LT((now[v] - q0).norm(), 1e-12);
    else
      EXPECT_NEAR(now[v].z() - q0.z(), -(test::kHeight_m - 5e-5), 1e-12);
  }
}

// Half way between a fixed frame and one turned by 120 degrees, dual quaternions turn by 60
// degrees at full radius; linear blending falls in to half of it (|1 + e^{i 120}|/2).
TEST(Skinning, DualQuaternionsKeepTheRadiusThatLinearBlendingLoses) {
  kinematics::MeshSequence s;
  const auto still = [](int, std::vector<Vec3> p) { return p; };
  const Pose turn = test::poseAt(2 * kPi / 3, {0, 0, 1}, Vec3::Zero());
  s.structures.push_back(
      test::sequenceOf("left", true, test::box({0.01, -0.012, 0}, {0.02, -0.002, 0.01}), 2, still));
  s.structures.push_back(test::sequenceOf(
      "right", true, test::box({0.01, 0.002, 0}, {0.02, 0.012, 0.01}), 2,
      [&](int k, std::vector<Vec3> p) { return k == 1 ? test::applied(turn, p) : p; }));
  const auto model = modelOf(s);
  BindSkin bind;
  bind.mesh = test::refined(test::ellipsoid({1e-4, 1e-3, 1e-3}, 0, {0.015, 0, 0.005}), false);
  bind.wall.assign(bind.mesh.positions.size(), 0);
  for (RigidBlend blend : {RigidBlend::linear, RigidBlend::dualQuaternion}) {
    SkinningDef def;
    def.walls = {{0, {"left", "right"}}};
    def.blend = blend;
    const AirwaySkin skin = attached(model, def, bind);
    const auto now = skin.deform(model, model.at(model.end_s()));
    const Vec3 middle = bind.mesh.positions[0];  // (0.0151, 0, 0.005)
    const double radius = middle.head<2>().norm();
    EXPECT_NEAR(now[0].head<2>().norm() / radius, blend == RigidBlend::linear ? 0.5 : 1, 1e-12);
    EXPECT_NEAR(std::atan2(now[0].y(), now[0].x()), kPi / 3, 1e-9);
    EXPECT_NEAR(now[0].z(), middle.z(), 1e-15);
  }
}

TEST(Skinning, SaysWhatIsWrong) {
  const auto model = modelOf(test::squeezingMouth(3, 0.004));
  SkinningDef def = test::mouthWalls();
  def.walls[0].structures[0] = "pallate";
  auto skin = attachSkin(test::mouthSkin(), model, def);
  ASSERT_FALSE(skin.has_value());
  EXPECT_NE(skin.error().remedy.find("palate"), std::string::npos);
  def = test::mouthWalls();
  def.walls.pop_back();
  skin = attachSkin(test::mouthSkin(), model, def);
  ASSERT_FALSE(skin.has_value());
  EXPECT_NE(skin.error().problem.find("wall 3"), std::string::npos);
  BindSkin open = test::mouthSkin();
  open.mesh.triangles.pop_back();
  skin = attachSkin(open, model, test::mouthWalls());
  ASSERT_FALSE(skin.has_value());
  EXPECT_NE(skin.error().problem.find("watertight"), std::string::npos);
  BindSkin insideOut = test::mouthSkin();
  for (Triangle& t : insideOut.mesh.triangles) std::swap(t[0], t[1]);
  EXPECT_FALSE(attachSkin(insideOut, model, test::mouthWalls()).has_value());
  BindSkin few = test::mouthSkin();
  few.s_m.pop_back();
  EXPECT_FALSE(attachSkin(few, model, test::mouthWalls()).has_value());
}
}  // namespace
}  // namespace swallowclip::airway
