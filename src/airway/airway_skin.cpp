// SPDX-License-Identifier: MIT
#include "airway/airway_skin.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "kinematics/mesh_sequence.h"

namespace swallowclip::airway {

struct BakedSkin::Motion {
  TimeBlend blend = TimeBlend::pchip;
  std::optional<kinematics::SequenceSampler> sampler;  ///< pchip
  std::vector<std::vector<Vec3>> frames;               ///< convex
};

namespace {
// Uniform quadratic B-spline with the frames as control points, the first and last repeated:
// around frame k, with w from 0 half a frame before it to 1 half a frame after,
//   p = (1-w)^2/2 P(k-1) + (1/2 + w(1-w)) P(k) + w^2/2 P(k+1).
void convexAt(double place, double rate_hz, const std::vector<std::vector<Vec3>>& frames,
              std::vector<Vec3>& positions, std::vector<Vec3>& velocities) {
  const int last = static_cast<int>(frames.size()) - 1;
  place = std::clamp(place, -0.5, last + 0.5);
  const int k = std::min(static_cast<int>(place + 0.5), last);
  const double w = place - k + 0.5;
  const auto &a = frames[std::max(k - 1, 0)], &b = frames[k], &c = frames[std::min(k + 1, last)];
  positions.resize(b.size());
  velocities.resize(b.size());
  for (size_t v = 0; v < b.size(); ++v) {
    const Vec3 before = a[v] - b[v], after = c[v] - b[v];
    positions[v] = b[v] + (1 - w) * (1 - w) / 2 * before + w * w / 2 * after;
    velocities[v] = rate_hz * (w * after - (1 - w) * before);
  }
}
}  // namespace

void BakedSkin::at(double t_s, std::vector<Vec3>& positions, std::vector<Vec3>& velocities) const {
  if (motion_->blend == TimeBlend::pchip)
    motion_->sampler->at(t_s, positions, velocities);
  else
    convexAt((t_s - start_s_) * rate_hz_, rate_hz_, motion_->frames, positions, velocities);
}

int BakedSkin::frames() const {
  return motion_->sampler ? motion_->sampler->frames() : static_cast<int>(motion_->frames.size());
}

bolus::WallMotion BakedSkin::wallMotion() const {
  bolus::WallMotion w;
  w.triangles = bind_->mesh.triangles;
  w.wall = bind_->wall;
  w.s_m = bind_->s_m;
  w.u = bind_->u;
  w.branch = bind_->branch;
  w.at = [skin = *this](double t_s, std::vector<Vec3>& p, std::vector<Vec3>& v) {
    skin.at(t_s, p, v);
  };
  return w;
}

std::vector<Vec3> AirwaySkin::deform(const biomech::Model& model,
                                     const biomech::ModelState& state) const {
  return airway::deform(*bind_, attachment_, model, state, blend_);
}

Result<BakedSkin> BakedSkin::fromFrames(std::shared_ptr<const BindSkin> bind, double start_s,
                                        double rate_hz, std::vector<std::vector<Vec3>> frames,
                                        TimeBlend blend) {
  if (frames.empty() || !(rate_hz > 0))
    return usageError("airway-skin",
                      fmt::format("{} frames at {} per second", frames.size(), rate_hz),
                      "give at least one frame and a positive rate");
  for (size_t f = 0; f < frames.size(); ++f) {
    if (frames[f].size() != bind->mesh.positions.size())
      return usageError("airway-skin",
                        fmt::format("frame {} has {} vertices and the bind pose {}", f,
                                    frames[f].size(), bind->mesh.positions.size()),
                        "keep the same vertices in every frame");
    for (size_t v = 0; v < frames[f].size(); ++v)
      if (!frames[f][v].allFinite())
        return failure("airway-skin", fmt::format("vertex {} of frame {} is not finite", v, f),
                       "check the structures that it hangs on at that time");
  }
  auto motion = std::make_shared<Motion>();
  motion->blend = blend;
  if (blend == TimeBlend::pchip)
    motion->sampler.emplace(start_s, rate_hz, std::move(frames));
  else
    motion->frames = std::move(frames);
  BakedSkin out;
  out.start_s_ = start_s;
  out.rate_hz_ = rate_hz;
  out.bind_ = std::move(bind);
  out.motion_ = std::move(motion);
  return out;
}

Result<BakedSkin> AirwaySkin::bake(const biomech::Model& model, const BakeDef& def) const {
  const double rate_hz = def.rate_hz > 0 ? def.rate_hz : model.rate_hz();
  const double span = (model.end_s() - model.start_s()) * rate_hz;
  // 10^5 frames are 49 minutes at 34 per second: more is a wrong unit, not a swallow
  if (!(span >= 0) || span > 1e5)
    return usageError("airway-skin", fmt::format("asked for {} frames", span),
                      "check the rate and the length of the swallow");
  std::vector<std::vector<Vec3>> frames(static_cast<size_t>(std::ceil(span - 1e-9)) + 1);
  ThreadPool pool(std::max(1, def.threads));
  pool.forChunks(static_cast<int>(frames.size()), 1, [&](int begin, int end, int) {
    for (int f = begin; f < end; ++f)
      frames[f] = deform(model, model.at(model.start_s() + f / rate_hz));
  });
  return BakedSkin::fromFrames(bind_, model.start_s(), rate_hz, std::move(frames), def.blend);
}

Result<AirwaySkin> attachSkin(BindSkin bind, const biomech::Model& model, const SkinningDef& def) {
  const size_t n = bind.mesh.positions.size();
  for (size_t size : {bind.s_m.size(), bind.u.size(), bind.branch.size()})
    if (size != 0 && size != n)
      return usageError("airway-skin", fmt::format("{} path coordinates for {} vertices", size, n),
                        "give one per vertex, or none");
  AirwaySkin skin;
  auto attachment = attach(bind, model, def, &skin.report_);
  if (!attachment) return std::unexpected(attachment.error());
  skin.bind_ = std::make_shared<const BindSkin>(std::move(bind));
  skin.attachment_ = std::move(*attachment);
  skin.blend_ = def.blend;
  return skin;
}
}  // namespace swallowclip::airway
