// SPDX-License-Identifier: MIT
#include "kinematics/choreography.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/tri_mesh.h"

namespace swallowclip::kinematics {
namespace {
// Length of the contact front's shoulder: tongue against palate, then tongue base and constrictors
// against each other; assumed 10-20 and 15-30.
constexpr double kOralShoulder_m = 14e-3, kPharyngealShoulder_m = 16e-3;
constexpr double kSidesLead_m = 10e-3;     // lateral walls shut ahead of the midline; assumed 5-15
constexpr double kLarynxForwardGap = 1.0;  // share of anterior larynx travel that opens the lumen
constexpr double kInvertedTip_m = 0.127;   // where the inverted epiglottis ends; assumed 0.12-0.13
// Share of that way by which the tongue's end follows it, so that the little tissue between them is
// not stretched until it cuts through the posterior wall's bulge; assumed 0.3-0.5.
constexpr double kTongueEndFollows = 0.3;
constexpr double kArytenoidTilt_rad = 0.35;  // 20 degrees forward at closure; assumed 15-30
// What is left open behind the contact front. Zones along s: tongue base, lateral walls.
constexpr double kSideSlit_m =
    5e-3;  // gap beside a lateral wall that does not come in; assumed 3-7
constexpr double kPouchAt_m = 0.118;  // near the thyrohyoid membrane; clinical-reference 3
constexpr double kPouchHalfHeight_m = 4e-3, kPouchGap_m = 4e-3;  // 8 mm tall; gap assumed 2-5
constexpr double kWidestGroove_m = 16e-3, kGrooveEnd_m = 60e-3;  // what the mouth has; assumed
// The sphincter opens wider for more (Cook 1989); exponent of the volume assumed, 0.15-0.3.
constexpr double kUesGrowth = 0.2;
constexpr double kThickestCoat_m = 2e-3;  // assumed, 1.5-3
// The tongue lifts as a large bolus leaves it, else groove and chute together would displace more
// tongue than can go elsewhere; share of the depth for an endless volume, assumed 0.5-0.8.
constexpr double kGrooveGive = 0.65;
// A larger bolus is longer: what follows its tail comes later, what lets it through stays longer
// (closure and opening last longer, Cook 1989). Per doubling and time that the contact front takes
// over the held bolus, so that a slow tongue leaves its bolus room too; assumed, 0.22-0.45.
constexpr double kLaterTail = 1. / 3, kHeldEnd_m = 50e-3;
bool followsTheTail(const std::string& track) {
  return track == "ppw_bulge" || track == "tongue_base" || track.starts_with("wall_") ||
         track.starts_with("pouch_") || track.ends_with("_return");
}
const Vec3 kCricoarytenoidJoint_m(0, 28e-3, -96e-3);  // assumed, of the default scene

// Map of [0, end] onto itself: the given knots inside, the identity before the first one. Knots
// close together below it keep the curve's bend from reaching back to the palate.
Curve identityExcept(const std::vector<std::array<double, 2>>& knots, double end) {
  std::vector<double> x{0}, y{0};
  for (double back : {0.010, 0.005}) {
    x.push_back(knots.front()[0] - back);
    y.push_back(x.back());
  }
  for (const auto& k : knots) {
    x.push_back(k[0]);
    y.push_back(k[1]);
  }
  x.push_back(end);
  y.push_back(end);
  return Curve(x, y);
}

// Smooth maximum of non-negative lengths (p-norm): C1 where the plain maximum has a kink.
double smoothMax(std::initializer_list<double> values) {
  double sum = 0;
  for (double v : values) {
    const double q = std::max(v, 0.0);
    sum += q * q * q * q;
  }
  return std::sqrt(std::sqrt(sum));
}

double pouchHeight(double s) {
  return plateau(s, kPouchAt_m - kPouchHalfHeight_m, kPouchAt_m - 1e-3, kPouchAt_m + 1e-3,
                 kPouchAt_m + kPouchHalfHeight_m);
}
}  // namespace

double Track::at(double tau) const {
  const double x = tau - delay_s - onset_s;
  if (x <= 0) return 0;
  const auto scaled = [&](double t) { return (t - onset_s) / speed; };
  const double rise = peak_s > onset_s ? minimumJerk(x / scaled(peak_s)) : 1;
  const double fall = offset_s > hold_s
                          ? minimumJerk((x - scaled(hold_s)) / (scaled(offset_s) - scaled(hold_s)))
                          : 0;
  return amplitude * peakValue * rise * (1 - fall);
}

const std::vector<TrackKind>& trackKinds() {
  static const std::vector<TrackKind> kinds{{"chute", true},           {"seal", false},
                                            {"velum", false},          {"vocal_folds", false},
                                            {"hyoid_pre", true},       {"hyoid_superior", true},
                                            {"hyoid_anterior", true},  {"larynx_superior", true},
                                            {"larynx_anterior", true}, {"arytenoid", false},
                                            {"epiglottis", false},     {"shortening", true},
                                            {"ppw_bulge", true},       {"ues", true},
                                            {"tongue_base", false},    {"wall_left", false},
                                            {"wall_right", false},     {"pouch_left", true},
                                            {"pouch_right", true},     {"oral_return", false},
                                            {"tongue_return", false},  {"pharynx_return", false}};
  return kinds;
}

void SwallowDef::offer(double offered_m3) {
  const double more = offered_m3 / volume_m3, size = std::cbrt(more);
  grooveHalfWidth_m = std::min(size * grooveHalfWidth_m, kWidestGroove_m);
  const double farthest_m = std::max(grooveEnd_m, kGrooveEnd_m - 2 * rockAmplitude_m);
  grooveEnd_m = std::min(grooveStart_m + size * (grooveEnd_m - grooveStart_m), farthest_m);
  tracks["chute"].peakValue *= std::min(size, 1.0);
  for (Hollow& h : hollows) {  // keeps about the same share; a coat gets no thicker, none thinner
    const double middle_m = 0.5 * (h.start_m + h.end_m), half_m = 0.5 * (h.end_m - h.start_m);
    h.start_m = middle_m - size * half_m, h.end_m = middle_m + size * half_m;
    h.halfWidth_m *= size;
    if (h.depth_m > kThickestCoat_m) h.depth_m *= std::max(size, 1.0);
  }
  grooveGive = kGrooveGive * std::max(0.0, 1 - 1 / more);
  tracks["ues"].peakValue *= std::pow(more, kUesGrowth);
  const double sweep_s = front_m.reaches(kHeldEnd_m) - front_m.reaches(0);
  const double later_s = std::max(0.0, kLaterTail * sweep_s * std::log2(more));
  duration_s += later_s;
  for (auto& [key, track] : tracks) {
    if (followsTheTail(key)) {
      track.delay_s += later_s;
    } else if (track.hold_s < 10) {
      track.hold_s += later_s;
      track.offset_s += later_s;
    }
  }
  front_m = front_m.shifted(later_s);
  volume_m3 = offered_m3;
}

const Track& SwallowDef::track(const std::string& key) const {
  static const Track none{0, 0, 0, 0, 0, 0, 0, 1};
  const auto it = tracks.find(key);
  return it == tracks.end() ? none : it->second;
}

Choreography::Choreography(const anatomy::Lumen& lumen, SwallowDef def)
    : lumen_(lumen), def_(std::move(def)) {
  // The groove's depth follows from the room that the skin must have beyond that without a groove:
  // a curved path makes it less than footprint times depth. Nearly linear: few secant steps.
  const auto room_m3 = [&](double depth_m) {
    grooveDepth_m_ = depth_m;
    return volume(lumen.skinPositions(lumen.evaluate(lumenPose(0))), lumen.skin().triangles);
  };
  const double none_m3 = room_m3(0), wanted_m3 = def_.roomFactor * def_.volume_m3;
  double depth_m = 10e-3;
  for (int i = 0; i < 4; ++i) depth_m *= wanted_m3 / (room_m3(depth_m) - none_m3);
  grooveDepth_m_ = depth_m;
}

double Choreography::track(const char* name, double tau) const {
  return def_.track(name).at(tau);
}

double Choreography::restPosture(double s, double u) const {
  // Tongue lies 2 mm under the palate, tongue base and hypopharynx stand open, UES shut; assumed.
  static const Curve midline({0, 0.04, 0.07, 0.084, 0.094, 0.099, 0.1035, 0.108, 0.116, 0.126,
                              0.134, 0.142, 0.150, 0.186, 0.192, 0.205},
                             {2e-3, 2e-3, 2e-3, 7e-3, 10e-3, 10.2e-3, 12.5e-3, 5.5e-3, 6.5e-3, 6e-3,
                              4e-3, 2e-3, 0, 0, 6e-3, 6e-3});
  return midline(s) * (1 - u * u) + lumen_.pyriformGap(s, u);
}

double Choreography::chamber(double s, double u, double tau) const {
  const double x = u * lumen_.def().halfWidth(s);
  const double q = std::min(1.0, std::abs(x) / def_.grooveHalfWidth_m);
  const double rockTime = tau + def_.bpm_s - def_.rockStart_s;
  const double cycles = std::clamp(rockTime * def_.rockRate_hz, 0.0, def_.rockCycles);
  const double shift = -def_.rockAmplitude_m * std::cos(2 * kPi * cycles) +
                       (def_.rockCycles > 0 ? def_.rockAmplitude_m : 0.0);
  const double lifted = 1 - def_.grooveGive * track("seal", tau);
  const double groove = lifted * grooveDepth_m_ * (1 - q * q * q) *
                        plateau(s - shift, def_.grooveStart_m, def_.grooveStart_m + 8e-3,
                                def_.grooveEnd_m - 8e-3, def_.grooveEnd_m);
  const double au = std::abs(u);
  // The back of the tongue drops first; the seal against the velum then gives way from front to
  // back.
  const double chuteEnd = 0.067 + 0.029 * track("seal", tau);
  const double chuteStart = def_.grooveEnd_m - 14e-3;  // overlaps the held bolus, no neck between
  const double chute = track("chute", tau) *
                       plateau(s, chuteStart, chuteStart + 12e-3, chuteEnd - 10e-3, chuteEnd) *
                       (1 - au * au * au);
  const double larynxForward =
      kLarynxForwardGap * track("larynx_anterior", tau) * plateau(s, 0.104, 0.12, 0.145, 0.153);
  const double body =
      restPosture(s, u) * smoothstep((s - 0.072) / 0.012) + larynxForward * (1 - u * u);
  const double ues = track("ues", tau) * plateau(s, 0.143, 0.151, 0.184, 0.190) *
                     std::sqrt(std::max(0.0, 1 - u * u));
  return smoothMax({groove, chute, body, ues});
}

double Choreography::release(double s, double tau) const {
  const double tongue = track("tongue_return", tau);
  const double mouth = smoothstep((0.080 - s) / 0.014), pharynx = smoothstep((s - 0.098) / 0.02);
  return tongue + mouth * (track("oral_return", tau) - tongue) +
         pharynx * (track("pharynx_return", tau) - tongue);
}

// Gap that stays once the contact front has passed: hollows of the tongue, what the tongue base
// leaves of the way to the posterior wall, slits beside lateral walls that do not come in.
double Choreography::leftBehind(double s, double u, double bulge, double tau) const {
  const double x = u * lumen_.def().halfWidth(s), au = std::abs(u);
  double hollow = 0;
  for (const Hollow& h : def_.hollows) {
    const double q = std::min(1.0, std::abs(x - h.centre_m) / h.halfWidth_m);
    const double edge = std::min(6e-3, (h.end_m - h.start_m) / 3);
    hollow = std::max(hollow, h.depth_m * (1 - q * q * q) *
                                  plateau(s, h.start_m, h.start_m + edge, h.end_m - edge, h.end_m));
  }
  const double away = std::max(0.0, restPosture(s, u) - bulge * (1 - u * u));
  const double tongueBase =
      (1 - track("tongue_base", tau)) * away * plateau(s, 0.086, 0.092, 0.100, 0.106);
  const double gain = track(u > 0 ? "wall_left" : "wall_right", tau);
  const double slit = (1 - gain) * kSideSlit_m * plateau(s, 0.104, 0.114, 0.140, 0.150) *
                      smoothstep((au - 0.12) / 0.3) * (1 - au * au);
  const double pouch = std::min(1.0, track(u > 0 ? "pouch_left" : "pouch_right", tau) / 1e-3) *
                       kPouchGap_m * pouchHeight(s) * smoothstep((au - 0.6) / 0.25) *
                       (1 - au * au * au * au);
  return smoothMax({hollow, tongueBase, slit, pouch});
}

// Outward travel of the lateral wall: gains below 0 bow it, pouches bulge out of it.
double Choreography::wallOut(double s, double side, double tau) const {
  const double gain = track(side > 0 ? "wall_left" : "wall_right", tau);
  return std::max(0.0, -gain) * lumen_.def().halfWidth(s) * plateau(s, 0.100, 0.112, 0.138, 0.150) +
         track(side > 0 ? "pouch_left" : "pouch_right", tau) * pouchHeight(s);
}

anatomy::LumenPose Choreography::lumenPose(double t) const {
  const anatomy::LumenDef& d = lumen_.def();
  const double tau = t - def_.bpm_s;
  anatomy::LumenPose p;
  p.velumRaise = track("velum", tau);
  const double up = track("larynx_superior", tau), forward = track("larynx_anterior", tau);
  p.larynxShift_m = Vec3(0, -forward, up);
  const double closure = track("arytenoid", tau), inversion = track("epiglottis", tau);
  p.inletOpen = 1 - closure;
  p.glottisOpen = 1 - track("vocal_folds", tau);
  // Tissue of M: the tongue stays, the inlet folds shut, the larynx rises.
  const double tip = d.epiglottisTip_m + inversion * (kInvertedTip_m - d.epiglottisTip_m);
  const double arytenoidFree = d.arytenoid_m - up;
  const double shut = tip + 2e-4;
  const double arytenoid = arytenoidFree + closure * (shut - arytenoidFree);
  const double end = d.length_m;
  const Curve sigmaM = identityExcept(
      {{0.099, 0.099},
       {d.tongueEnd_m, d.tongueEnd_m + kTongueEndFollows * (tip - d.epiglottisTip_m)},
       {d.epiglottisTip_m, tip},
       {d.arytenoid_m, std::max(arytenoid, shut)},
       {d.uesStart_m, std::max(d.uesStart_m - up, shut + 5e-3)},
       {0.185, 0.185 - 0.8 * up}},
      end);
  const double lift = track("shortening", tau);
  const Curve sigmaF = identityExcept(
      {{0.090, 0.090}, {d.uesStart_m, d.uesStart_m - lift}, {0.185, 0.185 - 0.8 * lift}}, end);
  // Over the shut inlet the lumen is one even channel from the tongue base to the post-cricoid
  // wall: the folded tissue takes its gap from where it lies, not from what it is.
  constexpr double kAbove_m = 0.100, kBelow_m = 0.142;
  const auto along = [&](double s) {
    return std::clamp((sigmaM(s) - sigmaM(kAbove_m)) / (sigmaM(kBelow_m) - sigmaM(kAbove_m)), 0.0,
                      1.0);
  };
  const double frontAt = def_.frontAmplitude > 0 ? def_.front_m(tau) : -1.0;
  const double inPharynx = smoothstep((frontAt - 0.085) / 0.02);
  const double sides_m = kSidesLead_m * inPharynx;
  const double shoulder_m = kOralShoulder_m + (kPharyngealShoulder_m - kOralShoulder_m) * inPharynx;
  const double bulge = track("ppw_bulge", tau);
  p.gap_m.resize(static_cast<std::size_t>(lumen_.rows()) * lumen_.columns());
  p.shear_m.assign(p.gap_m.size(), 0.0);
  const double pocket = (1 - inversion) * (1 - smoothstep((frontAt - 0.085) / 0.012));
  const double pocketAgain = track("pharynx_return", tau);
  const double pocketOpen = std::max(pocket, std::min(1 - inversion, pocketAgain));
  for (int r = 0; r < lumen_.rows(); ++r) {
    const double s = lumen_.s(r);
    p.sigmaM_m.push_back(sigmaM(s));
    p.sigmaF_m.push_back(sigmaF(s));
    p.bulge_m.push_back(
        bulge * plateau(s, frontAt - 0.03, frontAt - 0.005, frontAt + 0.005, frontAt + 0.03) *
        plateau(s, 0.088, 0.096, 0.14, 0.15));
    const bool folds = s > kAbove_m && s < kBelow_m;
    const double share = folds ? along(s) : 0;
    const double from = folds ? s + closure * (kAbove_m + share * (kBelow_m - kAbove_m) - s) : s;
    const double back = release(from, tau);
    p.leftOut_m.push_back(wallOut(s, 1, tau));
    p.rightOut_m.push_back(wallOut(s, -1, tau));
    for (int c = 0; c < lumen_.columns(); ++c) {
      const double u = lumen_.u(c);
      const int i = lumen_.index(r, c);
      const double open = smoothstep((from - frontAt - sides_m * u * u) / shoulder_m);
      const auto gap = [&](double at) {
        const double left = leftBehind(at, u, p.bulge_m.back(), tau);
        const double closed_m = left + back * (smoothMax({left, restPosture(at, u)}) - left);
        return open * chamber(at, u, tau) + (1 - open) * closed_m;
      };
      double gap_m = gap(s);
      if (folds && closure > 0)
        gap_m += closure * ((1 - share) * gap(kAbove_m) + share * gap(kBelow_m) - gap_m);
      p.gap_m[i] = std::max(d.closedGap_m, gap_m);
      p.shear_m[i] = pocketOpen * lumen_.valleculaShear(s, u);
    }
  }
  return p;
}

bool Choreography::sealed(double t, int branch) const {
  constexpr double kShut = 0.995;  // share of full closure that leaves no more than the closed gap
  return track(branch == 1 ? "velum" : "arytenoid", t - def_.bpm_s) > kShut;
}

CarrierPoses Choreography::carriers(double t) const {
  const double tau = t - def_.bpm_s;
  CarrierPoses c;
  c.hyoid.t = Vec3(0, -track("hyoid_anterior", tau),
                   track("hyoid_superior", tau) + track("hyoid_pre", tau));
  c.thyroid.t = Vec3(0, -track("larynx_anterior", tau), track("larynx_superior", tau));
  c.cricoid = c.thyroid;
  Pose tilt;
  tilt.q = Quat(Eigen::AngleAxisd(kArytenoidTilt_rad * track("arytenoid", tau), Vec3::UnitX()));
  tilt.t = kCricoarytenoidJoint_m - tilt.q * kCricoarytenoidJoint_m;
  c.arytenoidL = c.arytenoidR = c.thyroid * tilt;
  return c;
}
}  // namespace swallowclip::kinematics
