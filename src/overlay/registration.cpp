// SPDX-License-Identifier: MIT
#include "overlay/registration.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>

namespace swallowclip::overlay {
namespace {
using Complex = std::complex<double>;  // a similarity of the plane is p -> a p + b

// Marking by hand is no finer than this, so nothing nearer is an outlier; assumed, range 1 to 4.
constexpr double kHandError_px = 2;
constexpr double kOutlier = 2.5;         // robust standard deviations, Rousseeuw & Leroy 1987
constexpr double kNormal = 1.4826;       // median to standard deviation of a normal distribution
constexpr double kLeastSpread_m = 5e-3;  // landmarks nearer together can't tell angle and scale

Complex toComplex(const Vec2& p) {
  return {p.x(), p.y()};
}
Vec2 toVec(const Complex& c) {
  return {c.real(), c.imag()};
}
Complex planePoint(const PointPair& p, bool mirrored) {
  return {mirrored ? -p.plane_m.x() : p.plane_m.x(), p.plane_m.y()};
}

/// Sums of one frame's points about their means.
struct Moments {
  Complex meanPlane, meanPixel, cross;  ///< cross = sum conj(plane) pixel
  double spread = 0;                    ///< sum |plane|^2
  int count = 0;
};
template <class Pick>
Moments momentsOf(const std::vector<PointPair>& pairs, bool mirrored, const Pick& pick) {
  Moments m;
  for (const PointPair& p : pairs)
    if (pick(p)) {
      m.meanPlane += planePoint(p, mirrored);
      m.meanPixel += toComplex(p.at_px);
      ++m.count;
    }
  if (m.count == 0) return m;
  m.meanPlane /= m.count;
  m.meanPixel /= m.count;
  for (const PointPair& p : pairs)
    if (pick(p)) {
      const Complex u = planePoint(p, mirrored) - m.meanPlane;
      m.cross += std::conj(u) * (toComplex(p.at_px) - m.meanPixel);
      m.spread += std::norm(u);
    }
  return m;
}

Similarity similarityOf(const Moments& m, bool mirrored, double scale) {
  Similarity s;
  s.mirrored = mirrored;
  s.scale = scale > 0 ? scale : std::abs(m.cross) / m.spread;
  s.angle_rad = std::arg(m.cross);
  s.offset_px = toVec(m.meanPixel - std::polar(s.scale, s.angle_rad) * m.meanPlane);
  return s;
}

Vec2 planeOf(const Vec3f& p) {
  return {p.y(), -p.z()};
}
}  // namespace

Vec2 Similarity::apply(const Vec2& plane_m) const {
  const Complex u(mirrored ? -plane_m.x() : plane_m.x(), plane_m.y());
  return toVec(std::polar(scale, angle_rad) * u) + offset_px;
}

Vec2 Similarity::inverse(const Vec2& at_px) const {
  const Complex u = toComplex(at_px - offset_px) / std::polar(scale, angle_rad);
  return {mirrored ? -u.real() : u.real(), u.imag()};
}

Similarity fitSimilarity(const std::vector<PointPair>& pairs, bool mirrored, double scale) {
  return similarityOf(momentsOf(pairs, mirrored, [](const PointPair& p) { return !p.outlier; }),
                      mirrored, scale);
}

void markOutliers(std::vector<PointPair>& pairs, bool mirrored, double scale) {
  const std::size_t n = pairs.size();
  if (n <= 3) return;
  double best = 1e300;
  Similarity bestFit;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = i + 1; k < n; ++k) {
      if ((pairs[i].plane_m - pairs[k].plane_m).norm() < kLeastSpread_m) continue;
      const Similarity s = fitSimilarity({pairs[i], pairs[k]}, mirrored, scale);
      std::vector<double> squares;
      for (const PointPair& p : pairs)
        squares.push_back((s.apply(p.plane_m) - p.at_px).squaredNorm());
      // with two points fitted exactly, the median is taken over those left
      const auto middle = squares.begin() + static_cast<long>((n + 2) / 2);
      std::ranges::nth_element(squares, middle);
      if (*middle < best) {
        best = *middle;
        bestFit = s;
      }
    }
  const double sigma = kNormal * (1 + 5.0 / static_cast<double>(n - 2)) * std::sqrt(best);
  const double limit = kOutlier * std::max(sigma, kHandError_px);
  // two points near each other aim badly at a far one, so those that agree have the last word
  for (int round = 0; round < 2; ++round) {
    for (PointPair& p : pairs) p.outlier = (bestFit.apply(p.plane_m) - p.at_px).norm() > limit;
    bestFit = fitSimilarity(pairs, mirrored, scale);
  }
  for (PointPair& p : pairs) p.outlier = (bestFit.apply(p.plane_m) - p.at_px).norm() > limit;
}

Result<Registration> Registration::make(const Marks& marks, const frame::History& model,
                                        const std::vector<int>& modelFrameOf) {
  const auto refuse = [](const std::string& problem) {
    return usageError("events file", problem,
                      "Mark at least C2_anterior_inferior and C4_anterior_inferior, as the contact "
                      "sheets show them.");
  };
  Registration r;
  r.mirrored_ = marks.facesRight;
  std::vector<PointPair> moving;
  std::map<int, std::vector<PointPair>> byFrame;
  for (const MarkedPoint& p : marks.points) {
    const frame::LandmarkTrack* track = model.landmark(p.name);
    if (!track) continue;  // imported scenes may lack some
    const auto at =
        static_cast<std::size_t>(modelFrameOf[static_cast<std::size_t>(p.frame.value_or(0))]);
    const PointPair pair{p.name, planeOf(track->positions[at]), p.at_px, p.frame.value_or(-1)};
    const bool fixed = std::ranges::any_of(
        landmarkKinds(), [&](const LandmarkKind& k) { return k.fixed && p.name == k.name; });
    if (fixed)
      byFrame[pair.frame].push_back(pair);
    else
      moving.push_back(pair);
  }
  // What holds for the whole clip counts only where no frame has landmarks of its own.
  if (byFrame.size() > 1) byFrame.erase(-1);
  const double given =
      marks.scale == ScaleFrom::calibration ? marks.calibration->pixelsPerMetre() : 0;
  for (auto& [frame, pairs] : byFrame) {
    markOutliers(pairs, r.mirrored_, given);
    r.pairs_.insert(r.pairs_.end(), pairs.begin(), pairs.end());
  }
  // One scale for the clip (head and tube keep their distance), one angle and place per frame: the
  // joint least squares has angle_k = arg cross_k and scale = sum |cross_k| / sum spread_k.
  std::map<int, Moments> moments;
  double cross = 0, spread = 0;
  Vec2 pivot = Vec2::Zero();
  for (const auto& [frame, pairs] : byFrame) {
    const Moments m = momentsOf(pairs, r.mirrored_, [](const PointPair& p) { return !p.outlier; });
    if (m.count < 2 || m.spread < kLeastSpread_m * kLeastSpread_m / 2) continue;
    moments[frame] = m;
    cross += std::abs(m.cross);
    spread += m.spread;
    const Vec2 mean = toVec(m.meanPlane);
    pivot += Vec2(r.mirrored_ ? -mean.x() : mean.x(), mean.y());
  }
  if (moments.empty())
    return refuse("there are not two landmarks of skull and spine 5 mm apart on one frame");
  r.keys_ = static_cast<int>(moments.size());
  r.scale_ = given > 0 ? given : cross / spread;
  r.pivot_m_ = pivot / r.keys_;
  std::vector<double> frames, angles, xs, ys;
  for (const auto& [frame, m] : moments) {
    const Similarity s = similarityOf(m, r.mirrored_, r.scale_);
    const Vec2 place = s.apply(r.pivot_m_);
    double angle = s.angle_rad;  // without jumps of a full turn
    if (!angles.empty()) angle += 2 * kPi * std::round((angles.back() - angle) / (2 * kPi));
    frames.push_back(frame);
    angles.push_back(angle);
    xs.push_back(place.x());
    ys.push_back(place.y());
  }
  r.angle_rad_ = Curve(frames, angles);
  r.x_px_ = Curve(frames, xs);
  r.y_px_ = Curve(frames, ys);
  double sum = 0;
  int count = 0;
  for (const PointPair& p : r.pairs_) {
    if (p.outlier) continue;
    sum += (r.at(p.frame).apply(p.plane_m) - p.at_px).squaredNorm();
    ++count;
  }
  r.rms_px_ = std::sqrt(sum / std::max(1, count));
  r.pixelsPerPatientMetre_ = marks.calibration ? marks.calibration->pixelsPerMetre() : r.scale_;
  for (PointPair& p : moving) {
    p.outlier = true;  // shown, not fitted
    r.pairs_.push_back(p);
  }
  return r;
}

Similarity Registration::at(double studyFrame) const {
  Similarity s;
  s.scale = scale_;
  s.mirrored = mirrored_;
  s.angle_rad = angle_rad_(studyFrame);
  s.offset_px = Vec2(x_px_(studyFrame), y_px_(studyFrame)) - s.apply(pivot_m_);
  return s;
}
}  // namespace swallowclip::overlay
