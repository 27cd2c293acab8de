// SPDX-License-Identifier: MIT
#include "kinematics/mesh_sequence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace swallowclip::kinematics {
namespace {

constexpr double kStart_s = -0.2, kRate_hz = 34;

std::vector<std::vector<Vec3>> randomFrames(int frames, int vertices) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> step(-0.004, 0.004);
  std::vector<std::vector<Vec3>> out(frames, std::vector<Vec3>(vertices, Vec3::Zero()));
  for (int f = 1; f < frames; ++f)
    for (int v = 0; v < vertices; ++v)
      out[f][v] = out[f - 1][v] + Vec3(step(random), step(random), step(random));
  return out;
}

TEST(MeshSequence, EndIsTheLastFrame) {
  MeshSequence s;
  s.structures.push_back({});
  s.structures[0].frames.resize(109);
  EXPECT_EQ(s.frames(), 109);
  EXPECT_NEAR(s.end_s(), 3.18, 0.01);
}

TEST(Locate, ClampsToTheSequence) {
  EXPECT_EQ(locate(-5, 0, 10, 4).frame, 0);
  EXPECT_EQ(locate(-5, 0, 10, 4).x, 0);
  EXPECT_EQ(locate(9, 0, 10, 4).frame, 2);
  EXPECT_EQ(locate(9, 0, 10, 4).x, 1);
  EXPECT_NEAR(locate(0.125, 0, 10, 4).x, 0.25, 1e-12);
  EXPECT_EQ(locate(0.3, 0, 10, 1).frame, 0);
}

TEST(SequenceSampler, PassesThroughItsSamples) {
  const auto frames = randomFrames(12, 9);
  const SequenceSampler sampler(kStart_s, kRate_hz, frames);
  std::vector<Vec3> p, v;
  for (int f = 0; f < 12; ++f) {
    sampler.at(kStart_s + f / kRate_hz, p, v);
    for (size_t i = 0; i < p.size(); ++i) EXPECT_LT((p[i] - frames[f][i]).norm(), 1e-14);
  }
}

TEST(SequenceSampler, NeverOvershootsNeighbouringSamples) {
  const auto frames = randomFrames(40, 20);
  const SequenceSampler sampler(0, 1, frames);
  std::vector<Vec3> p, v;
  for (int f = 0; f + 1 < 40; ++f)
    for (int k = 0; k <= 50; ++k) {
      sampler.at(f + k / 50.0, p, v);
      for (size_t i = 0; i < p.size(); ++i)
        for (int c = 0; c < 3; ++c) {
          const double a = frames[f][i][c], b = frames[f + 1][i][c];
          ASSERT_GE(p[i][c], std::min(a, b) - 1e-16);
          ASSERT_LE(p[i][c], std::max(a, b) + 1e-16);
        }
    }
}

TEST(SequenceSampler, VelocityIsTheDerivativeOfPosition) {
  const SequenceSampler sampler(kStart_s, kRate_hz, randomFrames(30, 8));
  std::vector<Vec3> p0, p1, p, v, ignored;
  const double h_s = 1e-6;
  for (double t = kStart_s - 0.01; t < kStart_s + 0.9; t += 0.00317) {
    sampler.at(t, p, v);
    sampler.at(t - h_s, p0, ignored);
    sampler.at(t + h_s, p1, ignored);
    for (size_t i = 0; i < p.size(); ++i)
      ASSERT_LT(((p1[i] - p0[i]) / (2 * h_s) - v[i]).norm(), 5e-4) << "t " << t;
  }
}

TEST(SequenceSampler, VelocityIsContinuousAcrossFramesAndBeyondTheEnds) {
  const SequenceSampler sampler(kStart_s, kRate_hz, randomFrames(30, 8));
  std::vector<Vec3> p, before, after;
  for (int f = 0; f < 30; ++f) {
    const double t = kStart_s + f / kRate_hz;
    sampler.at(t - 1e-9, p, before);
    sampler.at(t + 1e-9, p, after);
    for (size_t i = 0; i < p.size(); ++i) ASSERT_LT((after[i] - before[i]).norm(), 1e-5);
  }
}

TEST(SequenceSampler, UniformMotionHasUniformVelocityInside) {
  std::vector<std::vector<Vec3>> frames;
  for (int f = 0; f < 6; ++f) frames.push_back({Vec3(0.001 * f, 0, -0.002 * f)});
  const SequenceSampler sampler(0, 10, frames);
  std::vector<Vec3> p, v;
  sampler.at(0.237, p, v);
  EXPECT_LT((v[0] - Vec3(0.01, 0, -0.02)).norm(), 1e-15);
  EXPECT_LT((p[0] - Vec3(0.00237, 0, -0.00474)).norm(), 1e-15);
}

TEST(SequenceSampler, OneFrameRests) {
  const SequenceSampler sampler(0, 10, {{Vec3(1, 2, 3)}});
  std::vector<Vec3> p, v;
  sampler.at(4, p, v);
  EXPECT_EQ(p[0], Vec3(1, 2, 3));
  EXPECT_EQ(v[0], Vec3(0, 0, 0));
}
}  // namespace
}  // namespace swallowclip::kinematics
