// SPDX-License-Identifier: MIT
#include "biomech/model.h"

#include <gtest/gtest.h>

#include "shapes.h"

namespace swallowclip::biomech {
namespace {

Pose jawPose(int k) {
  return test::poseAt(0.02 * k, {1, 0, 0}, Vec3(0, 1e-4 * k, -2e-4 * k));
}

kinematics::MeshSequence jawAndTongue(int frames) {
  kinematics::MeshSequence sequence;
  sequence.structures.push_back(
      test::sequenceOf("mandible", true, test::refinedBox({-0.02, 0, 0}, {0.02, 0.04, 0.02}, 2),
                       frames, [](int k, auto p) { return test::applied(jawPose(k), p); }));
  sequence.structures.push_back(test::sequenceOf(
      "tongue", false, test::ellipsoid({0.02, 0.03, 0.015}, 3), frames, [](int k, auto p) {
        for (Vec3& x : p) x.z() *= 1 + 0.02 * std::sin(0.3 * k);
        return p;
      }));
  return sequence;
}

TEST(Model, RigidStructuresBecomeBodiesAndSoftOnesWedges) {
  const auto model = Model::build(jawAndTongue(20));
  ASSERT_TRUE(model.has_value()) << model.error().text();
  const ModelStructure& jaw = model->structures()[model->find("mandible")];
  ASSERT_TRUE(jaw.body.has_value());
  EXPECT_NEAR(jaw.body->mass_kg, 1920 * 0.04 * 0.04 * 0.02, 1e-12);
  EXPECT_LT(model->maxRigidResidual_m(), 1e-15);
  const ModelStructure& tongue = model->structures()[model->find("tongue")];
  ASSERT_TRUE(tongue.wedges.has_value());
  EXPECT_EQ(tongue.wedges->elements(), 2 * static_cast<int>(tongue.rest.triangles.size()));
  EXPECT_EQ(model->find("nose"), -1);
}

TEST(Model, PosesAndNodesFollowTheSequence) {
  const auto sequence = jawAndTongue(20);
  const auto model = Model::build(sequence);
  ASSERT_TRUE(model.has_value());
  for (int k = 0; k < 20; ++k) {
    const ModelState state = model->at(sequence.start_s + k / sequence.rate_hz);
    EXPECT_EQ(state.validate(), "");
    for (int i = 0; i < 2; ++i) {
      const auto p = model->positions(state, i);
      for (size_t v = 0; v < p.size(); ++v)
        ASSERT_LT((p[v] - sequence.structures[i].frames[k][v]).norm(), 1e-12);
    }
  }
}

TEST(Model, TwistAndNodeVelocitiesAreDerivatives) {
  const auto model = Model::build(jawAndTongue(20));
  ASSERT_TRUE(model.has_value());
  const double h_s = 1e-6;
  for (double t = 0.011; t < 0.55; t += 0.037) {
    const ModelState now = model->at(t), before = model->at(t - h_s), after = model->at(t + h_s);
    const ModelStructure& jaw = model->structures()[0];
    const Vec3 corner = jaw.rest.positions[7];
    const StructureState& s = now.structures[0];
    const Vec3 arm = s.worldFromRest.q * (corner - jaw.body->centre_m);
    const Vec3 moved = (after.structures[0].worldFromRest.apply(corner) -
                        before.structures[0].worldFromRest.apply(corner)) /
                       (2 * h_s);
    EXPECT_LT((moved - s.twist.linear_ms - s.twist.angular_rads.cross(arm)).norm(), 1e-6);
    for (size_t v = 0; v < now.structures[1].positions.size(); ++v)
      ASSERT_LT(
          ((after.structures[1].positions[v] - before.structures[1].positions[v]) / (2 * h_s) -
           now.structures[1].velocities[v])
              .norm(),
          1e-6);
  }
}

TEST(Model, RestIsUnstrainedAndMotionIsNot) {
  const auto model = Model::build(jawAndTongue(20));
  ASSERT_TRUE(model.has_value());
  ThreadPool pool(2);
  const StrainField rest = model->strain(model->rest(), 1, pool);
  EXPECT_LT(*std::max_element(rest.vonMises_Pa.begin(), rest.vonMises_Pa.end()), 1e-6);
  const StrainField moved = model->strain(model->at(0.15), 1, pool);
  EXPECT_GT(*std::max_element(moved.vonMises_Pa.begin(), moved.vonMises_Pa.end()), 10);
  EXPECT_GT(moved.minJacobianRatio, 0.5);
}

TEST(Model, ReportsHowRigidARigidStructureIs) {
  auto sequence = jawAndTongue(5);
  for (Vec3& p : sequence.structures[0].frames[3]) p.x() *= 1.1;
  const auto model = Model::build(sequence);
  ASSERT_TRUE(model.has_value());
  EXPECT_GT(model->maxRigidResidual_m(), 5e-4);
  EXPECT_GE(model->structures()[0].worstVertex_m, model->maxRigidResidual_m());
}

TEST(Model, NamesTheStructureThatIsWrong) {
  auto sequence = jawAndTongue(5);
  sequence.structures[1].frames[2].pop_back();
  auto model = Model::build(sequence);
  ASSERT_FALSE(model.has_value());
  EXPECT_NE(model.error().text().find("tongue"), std::string::npos);
  EXPECT_NE(model.error().problem.find("frame 2"), std::string::npos);
  sequence = jawAndTongue(5);
  sequence.structures[1].material = "muscel";
  model = Model::build(sequence);
  ASSERT_FALSE(model.has_value());
  EXPECT_NE(model.error().remedy.find("muscle"), std::string::npos);
  sequence = jawAndTongue(5);
  sequence.structures[0].frames[1][3].y() = std::nan("");
  EXPECT_FALSE(Model::build(sequence).has_value());
  EXPECT_FALSE(Model::build({}).has_value());
}
}  // namespace
}  // namespace swallowclip::biomech
