// SPDX-License-Identifier: MIT
// Displacements as a reader of an x-ray measures them: relative to the vertebrae, along the spine
// (superior: from the antero-inferior corner of C4 to that of C2) and across it (anterior, in the
// midsagittal plane), in mm or as a share of that distance.
#pragma once
#include <optional>
#include <string_view>
#include <vector>

#include "frame/history.h"

namespace swallowclip::scoring {

struct Spine {
  Vec3 origin = Vec3::Zero();  ///< C4, antero-inferior corner
  Vec3 superior = Vec3::UnitZ(), anterior = -Vec3::UnitY();
  double c2c4_m = 37e-3;  ///< mean of adults, F about 35, M about 40

  double height_m(const Vec3& p) const { return superior.dot(p - origin); }
  double forward_m(const Vec3& p) const { return anterior.dot(p - origin); }
};

/// Without the two landmarks: upright axes and the mean adult's scale.
Spine spineAt(const frame::History& history, int frame);

/// The track of that name, if it has every frame.
const frame::LandmarkTrack* wholeLandmark(const frame::History& history, std::string_view name);

/// How a point has moved since frame `rest`, relative to the vertebrae. [frame]
struct Displacement {
  std::vector<double> anterior_m, superior_m;
  std::vector<double> magnitude_m() const;
};
/// Of a landmark, else of the centre of a rigid structure; empty when the history has neither.
Displacement displacementOf(const frame::History& history, std::string_view landmark,
                            std::string_view structure, int rest);

/// [frame] angle of the epiglottis' long axis (petiole to tip) from superior, turning backwards:
/// about 25 deg at rest, 90 level, beyond 115 inverted. Empty without its landmarks.
std::vector<double> epiglottisAngle_rad(const frame::History& history);
}  // namespace swallowclip::scoring
