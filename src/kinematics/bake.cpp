// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numeric>

#include "kinematics/choreography.h"
#include "kinematics/follow.h"

namespace swallowclip::kinematics {
namespace {
/// A soft structure and what carries it; vertices of all carrying structures in one row.
struct Follower {
  std::size_t own = 0;
  std::vector<std::size_t> carriers;
  std::vector<Vec3> rest;
  std::vector<Attachment> attachments;
};

Follower follower(const MeshSequence& sequence, std::size_t own,
                  const std::vector<std::string>& names) {
  Follower f;
  f.own = own;
  for (std::size_t i = 0; i < sequence.structures.size(); ++i) {
    const StructureSequence& s = sequence.structures[i];
    if (std::find(names.begin(), names.end(), s.name) == names.end()) continue;
    f.carriers.push_back(i);
    f.rest.insert(f.rest.end(), s.rest.begin(), s.rest.end());
  }
  std::vector<int> all(f.rest.size());
  std::iota(all.begin(), all.end(), 0);
  for (const Vec3& p : sequence.structures[own].rest)
    f.attachments.push_back(attach(p, f.rest, all));
  return f;
}

std::vector<Vec3> followed(const Follower& f, const MeshSequence& sequence, int frame) {
  std::vector<Vec3> now;
  for (std::size_t i : f.carriers) {
    const std::vector<Vec3>& p = sequence.structures[i].frames[frame];
    now.insert(now.end(), p.begin(), p.end());
  }
  std::vector<Vec3> p = sequence.structures[f.own].rest;
  for (std::size_t v = 0; v < p.size(); ++v) p[v] += follow(f.attachments[v], f.rest, now);
  return p;
}

Pose carrierPose(anatomy::Carrier c, const CarrierPoses& p) {
  switch (c) {
    case anatomy::Carrier::mandible:
      return p.mandible;
    case anatomy::Carrier::hyoid:
      return p.hyoid;
    case anatomy::Carrier::thyroid:
      return p.thyroid;
    case anatomy::Carrier::cricoid:
      return p.cricoid;
    case anatomy::Carrier::arytenoidL:
      return p.arytenoidL;
    case anatomy::Carrier::arytenoidR:
      return p.arytenoidR;
    default:
      return {};
  }
}

anatomy::Carrier landmarkCarrier(const std::string& name) {
  using anatomy::Carrier;
  const auto starts = [&](const char* prefix) { return name.rfind(prefix, 0) == 0; };
  if (starts("hyoid")) return Carrier::hyoid;
  if (starts("thyroid") || starts("laryngeal") || starts("vocal") || starts("anterior_commissure"))
    return Carrier::thyroid;
  if (starts("cricoid") || starts("UES")) return Carrier::cricoid;
  if (starts("arytenoid")) return name.back() == 'R' ? Carrier::arytenoidR : Carrier::arytenoidL;
  if (starts("epiglottis") || starts("cuneiform")) return Carrier::epiglottis;
  if (starts("lower_") || starts("menton") || starts("pogonion") || starts("gonion"))
    return Carrier::mandible;
  return Carrier::skull;
}
}  // namespace

BakedMotion bake(const anatomy::Anatomy& rigidParts, const anatomy::Lumen& lumen,
                 const anatomy::SoftParts& soft, const SwallowDef& swallow, double rate_hz) {
  using anatomy::Carrier;
  const Choreography choreography(lumen, swallow);
  const int frames = static_cast<int>(std::lround(swallow.duration_s * rate_hz)) + 1;
  BakedMotion out;
  out.sequence.start_s = 0;
  out.sequence.rate_hz = rate_hz;
  const auto restSheets = lumen.evaluate(lumen.neutralPose());
  const std::vector<Vec3> restSkin = lumen.skinPositions(restSheets);
  std::vector<int> mucosa;
  for (std::size_t v = 0; v < restSkin.size(); ++v)
    if (lumen.skin().wall[v] == static_cast<int>(anatomy::WallId::larynx))
      mucosa.push_back(static_cast<int>(v));

  std::vector<std::vector<Attachment>> attachments(rigidParts.structures.size());
  for (const anatomy::Structure& s : soft.structures())
    out.sequence.structures.push_back(
        {s.name, s.material, false, s.mesh.triangles, s.mesh.positions, {}});
  const std::size_t softCount = soft.structures().size();
  for (std::size_t i = 0; i < rigidParts.structures.size(); ++i) {
    const anatomy::Structure& s = rigidParts.structures[i];
    const bool follows = s.carrier == Carrier::epiglottis;
    out.sequence.structures.push_back(
        {s.name, s.material, s.rigid && !follows, s.mesh.triangles, s.mesh.positions, {}});
    if (follows)
      for (const Vec3& p : s.mesh.positions) attachments[i].push_back(attach(p, restSkin, mucosa));
  }
  std::vector<Follower> followers;
  for (std::size_t i = 0; i < rigidParts.structures.size(); ++i)
    if (!rigidParts.structures[i].follows.empty())
      followers.push_back(follower(out.sequence, softCount + i, rigidParts.structures[i].follows));
  std::vector<std::pair<std::string, Vec3>> points(rigidParts.landmarks.begin(),
                                                   rigidParts.landmarks.end());
  std::vector<Attachment> pointAttachment(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    out.landmarkNames.push_back(points[i].first);
    if (landmarkCarrier(points[i].first) == Carrier::epiglottis)
      pointAttachment[i] = attach(points[i].second, restSkin, mucosa);
  }
  const int mid = lumen.columns() / 2;
  for (const char* name : {"tongue_tip", "tongue_base", "uvula_tip"})
    out.landmarkNames.push_back(name);

  for (int k = 0; k < frames; ++k) {
    const double t = k / rate_hz;
    const anatomy::LumenSheets sheets = lumen.evaluate(choreography.lumenPose(t));
    const CarrierPoses carriers = choreography.carriers(t);
    out.skin.push_back(lumen.skinPositions(sheets));
    const std::vector<Vec3>& skin = out.skin.back();
    auto softPositions = soft.positions(sheets, {carriers.hyoid.t});
    for (std::size_t i = 0; i < softCount; ++i)
      out.sequence.structures[i].frames.push_back(std::move(softPositions[i]));
    for (std::size_t i = 0; i < rigidParts.structures.size(); ++i) {
      const anatomy::Structure& s = rigidParts.structures[i];
      std::vector<Vec3> p = s.mesh.positions;
      if (s.carrier == Carrier::epiglottis) {
        for (std::size_t v = 0; v < p.size(); ++v)
          p[v] += follow(attachments[i][v], restSkin, skin);
      } else {
        const Pose pose = carrierPose(s.carrier, carriers);
        for (Vec3& v : p) v = pose.apply(v);
      }
      out.sequence.structures[softCount + i].frames.push_back(std::move(p));
    }
    for (const Follower& f : followers)
      out.sequence.structures[f.own].frames.back() = followed(f, out.sequence, k);
    std::vector<Vec3> marks;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Carrier c = landmarkCarrier(points[i].first);
      marks.push_back(c == Carrier::epiglottis
                          ? Vec3(points[i].second + follow(pointAttachment[i], restSkin, skin))
                          : carrierPose(c, carriers).apply(points[i].second));
    }
    marks.push_back(sheets.m[lumen.index(0, mid)]);
    marks.push_back(sheets.m[lumen.index(lumen.rowAt(0.094), mid)]);
    marks.push_back(sheets.f[lumen.index(lumen.port().firstRow, mid)]);
    out.landmarks.push_back(std::move(marks));
  }
  return out;
}
}  // namespace swallowclip::kinematics
