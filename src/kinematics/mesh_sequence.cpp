// SPDX-License-Identifier: MIT
#include "kinematics/mesh_sequence.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"

namespace swallowclip::kinematics {

HermiteWeights locate(double t_s, double start_s, double rate_hz, int frames) {
  if (frames < 2) return {};
  const double place = std::clamp((t_s - start_s) * rate_hz, 0.0, frames - 1.0);
  const int frame = std::min(static_cast<int>(place), frames - 2);
  return {frame, place - frame};
}

namespace {
// Tangent where two secants meet, evenly spaced samples. Their harmonic mean is at most twice the
// smaller one, which lies inside the monotone region |tangent| <= 3 |secant| of Fritsch & Carlson
// (1980, eq. 2.3), so neither neighbouring interval can overshoot. At a turning point it is zero.
double monotoneTangent(double before, double after) {
  if (!(before * after > 0)) return 0;
  return 2 * before * after / (before + after);
}
}  // namespace

// The first and last tangents are zero: the pose is held outside the sequence, and so the motion
// stays C1 there as well.
SequenceSampler::SequenceSampler(double start_s, double rate_hz,
                                 std::vector<std::vector<Vec3>> frames)
    : start_s_(start_s), rate_hz_(rate_hz), frames_(std::move(frames)) {
  CHECK_GT(rate_hz_, 0.0);
  CHECK_GT(frames_.size(), 0u);
  const size_t vertices = frames_.front().size();
  for (const auto& f : frames_) CHECK_EQ(f.size(), vertices);
  tangents_.assign(frames_.size(), std::vector<Vec3>(vertices, Vec3::Zero()));
  for (size_t f = 1; f + 1 < frames_.size(); ++f)
    for (size_t v = 0; v < vertices; ++v)
      for (int c = 0; c < 3; ++c)
        tangents_[f][v][c] = monotoneTangent(frames_[f][v][c] - frames_[f - 1][v][c],
                                             frames_[f + 1][v][c] - frames_[f][v][c]);
}

// Cubic Hermite form: p = h0 p0 + h1 p1 + k0 m0 + k1 m1, written around p0 so that a resting
// vertex keeps its very bits.
void SequenceSampler::at(double t_s, std::vector<Vec3>& positions,
                         std::vector<Vec3>& velocities) const {
  const size_t vertices = frames_.front().size();
  positions.resize(vertices);
  velocities.assign(vertices, Vec3::Zero());
  const HermiteWeights w = locate(t_s, start_s_, rate_hz_, frames());
  if (frames() < 2) {
    positions = frames_.front();
    return;
  }
  const double x = w.x, y = 1 - x;
  const double h1 = x * x * (3 - 2 * x), k0 = x * y * y, k1 = -x * x * y;
  const double dh1 = 6 * x * y, dk0 = y * (1 - 3 * x), dk1 = x * (3 * x - 2);
  const auto &p0 = frames_[w.frame], &p1 = frames_[w.frame + 1];
  const auto &m0 = tangents_[w.frame], &m1 = tangents_[w.frame + 1];
  for (size_t v = 0; v < vertices; ++v) {
    const Vec3 d = p1[v] - p0[v];
    positions[v] = p0[v] + h1 * d + k0 * m0[v] + k1 * m1[v];
    velocities[v] = rate_hz_ * (dh1 * d + dk0 * m0[v] + dk1 * m1[v]);
  }
  // arriving at a sample gives that sample, not one rounded next to it
  if (x == 1) positions = p1;
}

}  // namespace swallowclip::kinematics
