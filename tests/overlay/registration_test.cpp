// SPDX-License-Identifier: MIT
// Registration against known places: exact without noise, within the promised error with it,
// following a turning head, undisturbed by a wrong landmark.
#include "overlay/registration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "overlay/demo.h"

namespace swallowclip::overlay {
namespace {
constexpr int kFrames = 100;

Vec3f inPlane(const Vec2& mm) {
  return Vec3f(0, static_cast<float>(mm.x()), static_cast<float>(mm.y())) * 1e-3f;
}

/// Landmarks where the reference anatomy has them (m), standing still.
frame::History headWithLandmarks() {
  const std::pair<const char*, Vec2> at[] = {{"C2_anterior_inferior", {34.2, -49}},
                                             {"C2_posterior_inferior", {53.4, -45.9}},
                                             {"C3_anterior_inferior", {35.1, -66.9}},
                                             {"C3_posterior_inferior", {54.6, -64.9}},
                                             {"C4_anterior_inferior", {36.9, -86}},
                                             {"C4_posterior_inferior", {55.4, -81.9}},
                                             {"ANS", {-54.5, 0.5}},
                                             {"PNS", {0, 0}},
                                             {"upper_incisor_tip", {-56, -26}}};
  frame::History h;
  for (int k = 0; k < kFrames; ++k) h.time_s.push_back(k / 30.0);
  for (const auto& [name, p] : at)
    h.landmarks.push_back({name, std::vector<Vec3f>(kFrames, inPlane(p))});
  return h;
}

std::vector<int> sameFrames() {
  std::vector<int> frames(kFrames);
  for (int k = 0; k < kFrames; ++k) frames[static_cast<std::size_t>(k)] = k;
  return frames;
}

/// The demonstration's pose per frame, and marks with that much noise.
struct Case {
  frame::History head = headWithLandmarks();
  DemoDef def;
  DemoTruth truth;
  Marks marks;

  explicit Case(double noise_px, double turn_deg, int every = 6) {
    def.landmarkNoise_px = noise_px;
    def.turn_deg = turn_deg;
    def.landmarkEvery = every;
    for (int k = 0; k < kFrames; ++k)
      truth.place.push_back(demoPlace(def, {-0.002, 0.05}, k, kFrames));
    marks = demoMarks(def, head, {}, truth);
  }
  /// RMS over all landmarks and frames of found against true places.
  double rms_px(const Registration& r) const {
    double sum = 0;
    for (int k = 0; k < kFrames; ++k)
      for (const auto& l : head.landmarks) {
        const Vec2 plane(l.positions[0].y(), -l.positions[0].z());
        sum += (r.at(k).apply(plane) - truth.place[static_cast<std::size_t>(k)].apply(plane))
                   .squaredNorm();
      }
    return std::sqrt(sum / (kFrames * static_cast<double>(head.landmarks.size())));
  }
};
}  // namespace

TEST(Registration, ExactWithoutNoise) {
  const Case c(0, 0);
  const auto r = Registration::make(c.marks, c.head, sameFrames());
  ASSERT_TRUE(r) << r.error().text();
  EXPECT_LT(r->rms_px(), 0.3);  // the head drifts evenly between the marked frames
  EXPECT_NEAR(r->scale() / c.truth.place[0].scale, 1, 1e-5);
  EXPECT_LT(c.rms_px(*r), 0.3);
  const Similarity s = r->at(10);
  const Vec2 p(0.02, 0.07);
  EXPECT_LT((s.inverse(s.apply(p)) - p).norm(), 1e-12);
}

// Acceptance: within 1 px RMS and 0.5 % scale with 1 px noise; 5 degrees over the clip followed.
TEST(Registration, NoisyLandmarksOfATurningHead) {
  const Case c(1, 5);
  const auto r = Registration::make(c.marks, c.head, sameFrames());
  ASSERT_TRUE(r) << r.error().text();
  EXPECT_TRUE(r->followsMotion());
  EXPECT_LT(c.rms_px(*r), 1.0);
  EXPECT_LT(std::abs(r->scale() / c.truth.place[0].scale - 1), 0.005);
  EXPECT_NEAR((r->at(kFrames - 1).angle_rad - r->at(0).angle_rad) * 180 / kPi, 5, 0.7);
  for (int k = 0; k < kFrames; ++k)
    EXPECT_NEAR(r->at(k).angle_rad, c.truth.place[static_cast<std::size_t>(k)].angle_rad,
                0.7 * kPi / 180);
}

TEST(Registration, OneSetForTheWholeClip) {
  Case c(0, 0, 1000);  // frame 0 only, which stands for the clip
  for (MarkedPoint& p : c.marks.points) p.frame.reset();
  const auto r = Registration::make(c.marks, c.head, sameFrames());
  ASSERT_TRUE(r);
  EXPECT_FALSE(r->followsMotion());
  EXPECT_NEAR(r->at(0).angle_rad, r->at(99).angle_rad, 1e-12);
  EXPECT_NEAR(r->scale() / c.truth.place[0].scale, 1, 1e-6);
}

TEST(Registration, AWrongLandmarkIsLeftOut) {
  Case c(1, 0, 1000);
  c.marks.points[3].at_px += Vec2(40, -25);
  const auto r = Registration::make(c.marks, c.head, sameFrames());
  ASSERT_TRUE(r);
  int left = 0;
  for (const PointPair& p : r->pairs())
    if (p.outlier) {
      ++left;
      EXPECT_EQ(p.name, c.marks.points[3].name);
    }
  EXPECT_EQ(left, 1);
  EXPECT_LT(std::abs(r->scale() / c.truth.place[0].scale - 1), 0.02);
}

TEST(Registration, FacingRightMirrors) {
  Case c(0, 0, 1000);
  c.marks.facesRight = true;
  for (MarkedPoint& p : c.marks.points) p.at_px.x() = 640 - p.at_px.x();
  const auto r = Registration::make(c.marks, c.head, sameFrames());
  ASSERT_TRUE(r);
  EXPECT_LT(r->rms_px(), 1e-3);
  const Vec3f& p = c.head.landmarks[0].positions[0];
  const Vec2 at = r->at(0).apply({p.y(), -p.z()});
  EXPECT_LT((at - c.marks.points[0].at_px).norm(), 1e-3);
}

TEST(Registration, CalibrationGivesTrueMillimetres) {
  Case c(0, 0, 1000);
  // 70 px for 25 mm = 2800 px/m, while the model lies at 3050 px/m: the patient is larger
  c.marks.calibration = Calibration{{10, 10}, {80, 10}, 0.025};
  auto r = Registration::make(c.marks, c.head, sameFrames());
  ASSERT_TRUE(r);
  EXPECT_NEAR(r->patientPerModel(), 3050.0 / 2800, 1e-4);
  c.marks.scale = ScaleFrom::calibration;
  r = Registration::make(c.marks, c.head, sameFrames());
  ASSERT_TRUE(r);
  EXPECT_NEAR(r->scale(), 2800, 1e-6);
  EXPECT_GT(r->rms_px(), 3);  // the model is too small, and says so
}

TEST(Registration, TooLittleIsRefused) {
  Case c(0, 0, 1000);
  c.marks.points.resize(1);
  EXPECT_FALSE(Registration::make(c.marks, c.head, sameFrames()));
  c.marks.points.clear();
  const auto none = Registration::make(c.marks, c.head, sameFrames());
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().text().find("two landmarks"), std::string::npos);
}
}  // namespace swallowclip::overlay
