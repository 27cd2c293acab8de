// SPDX-License-Identifier: MIT
// Where the model's midsagittal plane lies in the patient's picture: a similarity per frame, by
// least squares over landmarks of skull and spine. Plane coordinates: u = y (posterior), v = -z
// (down), metres, so that an unturned model faces left as in the lateral view. A patient who faces
// right is mirrored.
#pragma once
#include <string>
#include <vector>

#include "core/curve.h"
#include "core/error.h"
#include "frame/history.h"
#include "overlay/marks.h"

namespace swallowclip::overlay {

/// study_px = scale * R(angle) * [mirror * u, v] + offset; angle clockwise on the screen.
struct Similarity {
  double scale = 1;  ///< pixels per metre of the model
  double angle_rad = 0;
  Vec2 offset_px = Vec2::Zero();
  bool mirrored = false;

  Vec2 apply(const Vec2& plane_m) const;
  Vec2 inverse(const Vec2& at_px) const;
};

/// A point of the model and where it is seen.
struct PointPair {
  std::string name;
  Vec2 plane_m = Vec2::Zero(), at_px = Vec2::Zero();
  int frame = -1;        ///< -1: the whole clip
  bool outlier = false;  ///< left out of the fit
};

/// Least squares over pairs that are no outliers; at least two needed. `scale` > 0 is kept as
/// given, else fitted.
Similarity fitSimilarity(const std::vector<PointPair>& pairs, bool mirrored, double scale = 0);

/// Least median of squares over all pairs of points (Rousseeuw & Leroy 1987, ch. 5): marks what
/// lies further from the best of them than 2.5 robust standard deviations. More than three needed.
void markOutliers(std::vector<PointPair>& pairs, bool mirrored, double scale);

class Registration {
 public:
  /// `model` has the study's frames in its frames (retimed). Landmarks that move with the swallow
  /// do not take part; their distances are reported.
  static Result<Registration> make(const Marks& marks, const frame::History& model,
                                   const std::vector<int>& modelFrameOfStudyFrame);

  Similarity at(double studyFrame) const;
  double scale() const { return scale_; }
  double rms_px() const { return rms_px_; }
  double rms_mm() const { return rms_px_ / pixelsPerPatientMetre_ * 1e3; }
  /// Model metres times this are patient metres: from the calibration object, else 1 by definition
  /// of "the patient is as large as the model".
  double patientPerModel() const { return scale_ / pixelsPerPatientMetre_; }
  bool followsMotion() const { return keys_ > 1; }
  const std::vector<PointPair>& pairs() const { return pairs_; }

 private:
  double scale_ = 1, rms_px_ = 0, pixelsPerPatientMetre_ = 1;
  bool mirrored_ = false;
  int keys_ = 0;                   ///< frames with landmarks of their own
  Curve angle_rad_, x_px_, y_px_;  ///< over the study frame; the offset of the pivot
  Vec2 pivot_m_ = Vec2::Zero();    ///< mean of the landmarks: turning about it moves least
  std::vector<PointPair> pairs_;
};
}  // namespace swallowclip::overlay
