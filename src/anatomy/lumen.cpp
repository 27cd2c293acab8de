// SPDX-License-Identifier: MIT
#include "anatomy/lumen.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace swallowclip::anatomy {
namespace {
constexpr double kNormalSpan_m = 6e-3;    // half span of the midline's tangent; assumed, 4-8 mm
constexpr double kClampWidth_m = 0.5e-3;  // softness of velum-wall contact; assumed, 0.2-1 mm
constexpr double kClosingLead = 1;        // by how much the folds lead the mouth; assumed, 0.5-2
constexpr double kArchPower = 2.5;        // palate arch fitted to the shape of clinical-reference 5
constexpr double kPortHalfU = 0.5, kInletHalfU = 0.42;  // share of the width the openings take

double archShape(double u) {
  return std::pow(std::abs(u), kArchPower);
}

// Maps the square (a, b) in [-1,1]^2 to the unit disc, so that a grid loop becomes a round tube.
Vec2 squareToDisc(double a, double b) {
  return {a * std::sqrt(1 - b * b / 2), b * std::sqrt(1 - a * a / 2)};
}

// d > 0 unchanged, d < 0 becomes a small positive number: C-infinity contact.
double softPositive(double d) {
  return 0.5 * (d + std::sqrt(d * d + kClampWidth_m * kClampWidth_m));
}
}  // namespace

std::array<int, 2> Lumen::Hole::at(int k) const {
  const int nc = columnSpan(), nr = rowSpan();
  if (k < nc) return {firstRow, firstColumn + k};
  k -= nc;
  if (k < nr) return {firstRow + k, lastColumn};
  k -= nr;
  if (k < nc) return {lastRow, lastColumn - k};
  k -= nc;
  return {lastRow - k, firstColumn};
}

Lumen::Lumen(LumenDef def) : def_(std::move(def)) {
  CHECK_EQ(def_.columns % 2, 1);
  rows_ = static_cast<int>(std::lround(def_.length_m / def_.rowStep_m)) + 1;
  step_ = def_.length_m / (rows_ - 1);
  const auto columnsWithin = [&](double halfU) {
    const int mid = def_.columns / 2;
    const int half = static_cast<int>(std::floor(halfU * mid));
    return std::array{mid - half, mid + half};
  };
  const auto portColumns = columnsWithin(kPortHalfU), inletColumns = columnsWithin(kInletHalfU);
  port_ = {rowAt(def_.uvula_m), std::max(rowAt(def_.wallStart_m), rowAt(def_.uvula_m) + 2),
           portColumns[0], portColumns[1]};
  inletHole_ = {rowAt(def_.epiglottisTip_m), rowAt(def_.arytenoid_m), inletColumns[0],
                inletColumns[1]};
  buildSkin();
}

int Lumen::rowAt(double s_m) const {
  return std::clamp(static_cast<int>(std::lround(s_m / step_)), 0, rows_ - 1);
}

double Lumen::valleculaShear(double at, double uAt) const {
  // 10 mm deep cups either side of the median glossoepiglottic fold, which leaves 3.5 mm (assumed
  // 2-5); clinical-reference 5 has 8-10 mm, weak.
  return 10e-3 * plateau(at, 0.0970, 0.1025, 0.1035, 0.1075) *
         (0.35 + 0.65 * smoothstep(std::abs(uAt) / 0.3)) *
         (1 - smoothstep((std::abs(uAt) - 0.6) / 0.35));
}

double Lumen::pyriformGap(double at, double uAt) const {
  // about 20 mm tall and 10 mm deep beside the larynx; clinical-reference 5, weak. Between them and
  // the inlet its rim rises as the aryepiglottic folds, 1.8 mm (assumed 1-3).
  const double off = (std::abs(uAt) - kInletHalfU) / 0.1;
  return 6e-3 * plateau(at, 0.122, 0.132, 0.141, 0.149) *
             plateau(std::abs(uAt), 0.5, 0.68, 0.8, 0.98) -
         1.8e-3 * plateau(at, 0.110, 0.115, 0.128, 0.134) * std::exp(-off * off);
}

LumenPose Lumen::neutralPose() const {
  LumenPose p;
  p.bulge_m.assign(rows_, 0.0);
  p.gap_m.resize(static_cast<std::size_t>(rows_) * columns());
  p.shear_m.resize(p.gap_m.size());
  for (int r = 0; r < rows_; ++r) {
    p.sigmaF_m.push_back(s(r));
    for (int c = 0; c < columns(); ++c) {
      const double gap_m = def_.restGap(s(r)) * (1 - u(c) * u(c)) + pyriformGap(s(r), u(c));
      p.gap_m[index(r, c)] = std::max(def_.closedGap_m, gap_m);
      p.shear_m[index(r, c)] = valleculaShear(s(r), u(c));
    }
  }
  p.sigmaM_m = p.sigmaF_m;
  return p;
}

Vec3 Lumen::midline(double sigma, double raise, Vec3* normal) const {
  const auto point = [&](double at) {
    Vec3 p(0, def_.roofY(at), def_.roofZ(at));
    if (raise != 0 && at > def_.velumStart_m && at < def_.wallStart_m + 2 * kNormalSpan_m)
      p += raise * (Vec3(0, def_.raisedVelumY(at), def_.raisedVelumZ(at)) - p);
    return p;
  };
  if (normal) {
    const double lo = std::max(0.0, sigma - kNormalSpan_m);
    const double hi = std::min(def_.length_m, sigma + kNormalSpan_m);
    const Vec3 t = (point(hi) - point(lo)).normalized();
    *normal = Vec3(0, t.z(), -t.y());
  }
  return point(sigma);
}

LumenSheets Lumen::evaluate(const LumenPose& pose) const {
  CHECK_EQ(pose.gap_m.size(), static_cast<std::size_t>(rows_ * columns()));
  LumenSheets out;
  const std::size_t n = pose.gap_m.size();
  out.f.resize(n);
  out.m.resize(n);
  out.velumTop.resize(n, Vec3::Zero());
  out.fNormal.resize(rows_);
  const Curve materialOfF(pose.sigmaF_m, [&] {  // s of the tissue of F that lies at sigma
    std::vector<double> v;
    for (int r = 0; r < rows_; ++r) v.push_back(s(r));
    return v;
  }());
  std::vector<double> rowS(rows_);
  for (int r = 0; r < rows_; ++r) rowS[r] = s(r);
  const Curve bulge(rowS, pose.bulge_m), sigmaF(rowS, pose.sigmaF_m);
  const std::vector<double> still(rowS.size(), 0.0);
  const Curve leftOut(rowS, pose.leftOut_m.empty() ? still : pose.leftOut_m);
  const Curve rightOut(rowS, pose.rightOut_m.empty() ? still : pose.rightOut_m);
  const auto fixedPoint = [&](double sMaterial, double uAt, Vec3* normal) {
    Vec3 nrm;
    Vec3 p = midline(sigmaF(sMaterial), pose.velumRaise, &nrm);
    p += nrm * (def_.arch(sMaterial) * archShape(uAt) + bulge(sMaterial) * (1 - uAt * uAt));
    // A wall that bows takes the tissue beside it along, the midline stays.
    const double out_m = uAt > 0 ? leftOut(sMaterial) : rightOut(sMaterial);
    p.x() += def_.halfWidth(sMaterial) * uAt + out_m * uAt * uAt * uAt;
    if (normal) *normal = nrm;
    return p;
  };
  const int velumFirst = rowAt(def_.velumStart_m), velumLast = port_.firstRow;
  for (int r = 0; r < rows_; ++r) {
    const double partner = materialOfF(pose.sigmaM_m[r]) - s(r);  // M slides along F by this
    for (int c = 0; c < columns(); ++c) {
      const int i = index(r, c);
      out.f[i] = fixedPoint(s(r), u(c), &out.fNormal[r]);
      // All of the inlet slides as one; the slip fades out over the lateral walls.
      const double inner = 1 - smoothstep((std::abs(u(c)) - 0.5) / 0.5);
      Vec3 nrm;
      const double at = s(r) + partner * inner + pose.shear_m[i];
      const double gap_m = std::max(pose.gap_m[i], def_.closedGap_m);
      Vec3 foot = fixedPoint(std::clamp(at, 0.0, def_.length_m), u(c), &nrm);
      // An open tongue does not copy the step from the hanging uvula to the wall behind it.
      const double away =
          smoothstep((gap_m - 1e-3) / 5e-3) * plateau(at, 0.068, 0.078, 0.094, 0.106);
      if (away > 0) {
        Vec3 mean = Vec3::Zero(), meanNormal = Vec3::Zero();
        for (int k = -4; k <= 4; ++k) {
          Vec3 one;
          mean += fixedPoint(at + k * 2.5e-3, u(c), &one) / 9;
          meanNormal += one / 9;
        }
        foot += away * (mean - foot);
        nrm = (nrm + away * (meanNormal - nrm)).normalized();
      }
      out.m[i] = foot + nrm * gap_m;
      if (r < velumFirst || r > velumLast) continue;
      Vec3 top = out.f[i] - out.fNormal[r] * def_.velumThickness(s(r)) * (1 - 0.6 * u(c) * u(c));
      const double wall_y = def_.nasalWallY(top.z()) - 3e-3 * archShape(u(c));  // assumed bow 3 mm
      top.y() = wall_y - def_.closedGap_m - softPositive(wall_y - def_.closedGap_m - top.y());
      out.velumTop[i] = top;
    }
  }
  evaluatePort(pose, out);
  evaluateInlet(pose, out);
  return out;
}

void Lumen::evaluatePort(const LumenPose&, LumenSheets& out) const {
  const int loop = port_.loop(), nc = port_.columnSpan(), nr = port_.rowSpan();
  const double zLow = def_.roofZ(def_.wallStart_m) + 2e-3, zHigh = 8e-3;
  const auto frontAt = [&](int d, int c) {
    return out.velumTop[index(std::max(0, port_.firstRow - (d - 1)), c)];
  };
  const auto backAt = [&](int d, int c) {
    const double z = zLow + (zHigh - zLow) * (d - 0.5) / portDepths_;
    const double uc = u(c);
    const Vec3& hole = out.f[index(port_.lastRow, c)];
    return Vec3(hole.x(), def_.nasalWallY(z) - 3e-3 * archShape(uc), z);
  };
  out.nasal.clear();
  for (int d = 1; d <= portDepths_; ++d) {
    for (int k = 0; k < loop; ++k) {
      const auto [r, c] = port_.at(k);
      const double a = static_cast<double>(r - port_.firstRow) / nr;
      out.nasal.push_back((1 - a) * frontAt(d, c) + a * backAt(d, c));
    }
  }
  for (int i = 1; i < nr; ++i)
    for (int j = 1; j < nc; ++j) {
      const double a = static_cast<double>(i) / nr;
      const int c = port_.firstColumn + j;
      out.nasal.push_back((1 - a) * frontAt(portDepths_, c) + a * backAt(portDepths_, c));
    }
}

void Lumen::evaluateInlet(const LumenPose& pose, LumenSheets& out) const {
  const int loop = inletHole_.loop(), nc = inletHole_.columnSpan(), nr = inletHole_.rowSpan();
  const int middle = columns() / 2;
  const double mouth_m =
      (out.m[index(inletHole_.lastRow, middle)] - out.m[index(inletHole_.firstRow, middle)]).norm();
  const double restMouth_m =
      Vec2(def_.inletBackY(0) - def_.inletFrontY(0), def_.inletBackZ(0) - def_.inletFrontZ(0))
          .norm();
  const double mouth = std::min(1.0, mouth_m / restMouth_m);
  const auto section = [&](double d, double a, double b) {
    const Vec3 front(0, def_.inletFrontY(d), def_.inletFrontZ(d));
    const Vec3 back(0, def_.inletBackY(d), def_.inletBackZ(d));
    // Vestibule closes in the sagittal plane, from the folds (at d = 0.55, which close from the
    // sides) upwards (clinical-reference section 2), so that what has got in is pushed out.
    const double closing =
        std::min((1 - pose.inletOpen) * (1 + kClosingLead * std::min(d / 0.53, 1.0)), 1.0);
    const double shut = closing * (1 - smoothstep((d - 0.53) / 0.12));
    const double glottis = (1 - pose.glottisOpen) * plateau(d, 0.47, 0.53, 0.57, 0.64);
    const double depth_m = (back - front).norm();
    // Near its mouth the vestibule is as open as the mouth itself.
    const double open =
        std::min(mouth, 1 - shut) + (1 - shut - std::min(mouth, 1 - shut)) * smoothstep(d / 0.35);
    const double ap = std::max(def_.closedGap_m / depth_m, open);
    const double half = def_.inletHalfWidth(d);
    const double width = std::max(def_.closedGap_m / 2 / half, 1 - glottis);
    const Vec2 q = squareToDisc(2 * a - 1, b);
    // the trachea stretches: its lower end stays at its height and comes half as far forward,
    // assumed
    const double height = 1 - smoothstep((d - 0.62) / 0.38);
    const double forward = 1 - 0.5 * smoothstep((d - 0.7) / 0.3);
    const Vec3 shift = pose.larynxShift_m.cwiseProduct(Vec3(forward, forward, height));
    return Vec3(front + (back - front) * ap * (0.5 + 0.5 * q.x()) +
                Vec3::UnitX() * half * width * q.y() + shift);
  };
  const auto place = [&](int i, int j) {
    return std::array{static_cast<double>(i) / nr, 2.0 * j / nc - 1};
  };
  const auto fade = [&](double d) { return 1 - smoothstep(d / 0.35); };
  out.inlet.clear();
  for (int dep = 1; dep <= inletDepths_; ++dep) {
    const double d = static_cast<double>(dep) / inletDepths_;
    for (int k = 0; k < loop; ++k) {
      const auto [r, c] = inletHole_.at(k);
      const auto [a, b] = place(r - inletHole_.firstRow, c - inletHole_.firstColumn);
      const Vec3 deviation = out.m[index(r, c)] - section(0, a, b);
      out.inlet.push_back(section(d, a, b) + fade(d) * deviation);
    }
  }
  for (int i = 1; i < nr; ++i)
    for (int j = 1; j < nc; ++j) {
      const auto [a, b] = place(i, j);
      out.inlet.push_back(section(1, a, b));
    }
}

std::vector<Vec3> Lumen::skinPositions(const LumenSheets& sheets) const {
  std::vector<Vec3> p;
  p.reserve(source_.size());
  for (const auto& [sheet, i] : source_)
    p.push_back(sheet == 0   ? sheets.f[i]
                : sheet == 1 ? sheets.m[i]
                : sheet == 2 ? sheets.nasal[i]
                             : sheets.inlet[i]);
  return p;
}
}  // namespace swallowclip::anatomy
