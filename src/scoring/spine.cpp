// SPDX-License-Identifier: MIT
#include "scoring/spine.h"

#include <cmath>

namespace swallowclip::scoring {
using frame::History;

const frame::LandmarkTrack* wholeLandmark(const History& h, std::string_view name) {
  for (const auto& l : h.landmarks)
    if (l.name == name && static_cast<int>(l.positions.size()) == h.frames()) return &l;
  return nullptr;
}

Spine spineAt(const History& h, int frame) {
  Spine s;
  const auto *c2 = wholeLandmark(h, "C2_anterior_inferior"),
             *c4 = wholeLandmark(h, "C4_anterior_inferior");
  if (!c2 || !c4) return s;
  const Vec3 low = c4->positions[frame].cast<double>();
  Vec3 up = c2->positions[frame].cast<double>() - low;
  up.x() = 0;  // midsagittal
  const double length_m = up.norm();
  if (!(length_m > 1e-6)) return s;
  s.origin = low;
  s.c2c4_m = length_m;
  s.superior = up / length_m;
  s.anterior = Vec3(0, -s.superior.z(), s.superior.y());
  return s;
}

std::vector<double> Displacement::magnitude_m() const {
  std::vector<double> out;
  for (std::size_t f = 0; f < anterior_m.size(); ++f)
    out.push_back(std::hypot(anterior_m[f], superior_m[f]));
  return out;
}

Displacement displacementOf(const History& h, std::string_view name, std::string_view structure,
                            int rest) {
  std::vector<Vec3> x;
  if (const auto* mark = wholeLandmark(h, name)) {
    for (const Vec3f& p : mark->positions) x.push_back(p.cast<double>());
  } else {
    for (const auto& s : h.structures) {
      if (s.name != structure || !s.rigid || s.rest.empty()) continue;
      Vec3 centre = Vec3::Zero();
      for (const Vec3f& p : s.rest) centre += p.cast<double>() / static_cast<double>(s.rest.size());
      for (const Pose& pose : s.poses) x.push_back(pose.apply(centre));
    }
  }
  Displacement out;
  if (static_cast<int>(x.size()) != h.frames()) return out;
  const Spine still = spineAt(h, rest);
  for (int f = 0; f < h.frames(); ++f) {
    const Spine spine = spineAt(h, f);
    out.anterior_m.push_back(spine.forward_m(x[f]) - still.forward_m(x[rest]));
    out.superior_m.push_back(spine.height_m(x[f]) - still.height_m(x[rest]));
  }
  return out;
}

std::vector<double> epiglottisAngle_rad(const History& h) {
  const auto *tip = wholeLandmark(h, "epiglottis_tip_cartilage"),
             *petiole = wholeLandmark(h, "epiglottis_petiole");
  std::vector<double> out;
  if (!tip || !petiole) return out;
  for (int f = 0; f < h.frames(); ++f) {
    const Spine spine = spineAt(h, f);
    const Vec3 axis = (tip->positions[f] - petiole->positions[f]).cast<double>();
    out.push_back(std::atan2(-spine.anterior.dot(axis), spine.superior.dot(axis)));
  }
  return out;
}
}  // namespace swallowclip::scoring
