// SPDX-License-Identifier: MIT
#include "scoring/residue.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "scoring/clearance.h"

namespace swallowclip::scoring {
namespace {
using frame::History;
using frame::Region;
using frame::Wall;

struct LocationRow {
  const char* name;
  int component;
  const char* letter;
};
constexpr std::array<LocationRow, kLocations> kRows{{{"floor_of_mouth", 5, "A"},
                                                     {"palate", 5, "B"},
                                                     {"tongue", 5, "C"},
                                                     {"lateral_sulcus_left", 5, "D"},
                                                     {"lateral_sulcus_right", 5, "D"},
                                                     {"tongue_base", 16, "A"},
                                                     {"vallecula_left", 16, "B"},
                                                     {"vallecula_right", 16, "B"},
                                                     {"pharyngeal_wall", 16, "C"},
                                                     {"aryepiglottic_folds", 16, "D"},
                                                     {"pyriform_left", 16, "E"},
                                                     {"pyriform_right", 16, "E"},
                                                     {"elsewhere", 0, ""}}};

/// Path coordinates of a place on the skin.
struct Place {
  Wall wall;
  double s_m, u;
};

Location locate(const Place& at, Region region, const ScoringRules& r) {
  if (region == Region::oral) {
    if (std::abs(at.u) >= r.sulcusU) return at.u > 0 ? Location::sulcusLeft : Location::sulcusRight;
    if (at.wall == Wall::tongue)
      return at.s_m <= r.floorEnd_m ? Location::floorOfMouth : Location::tongue;
    return Location::palate;
  }
  if (region != Region::oropharynx && region != Region::hypopharynx) return Location::elsewhere;
  const bool moving = at.wall == Wall::tongue || at.wall == Wall::larynx;
  if (moving && at.s_m >= r.valleculaTop_m && at.s_m <= r.valleculaEnd_m)
    return at.u > 0 ? Location::valleculaLeft : Location::valleculaRight;
  if (at.s_m >= r.pyriformTop_m && at.s_m <= r.pyriformEnd_m && std::abs(at.u) >= r.pyriformU)
    return at.u > 0 ? Location::pyriformLeft : Location::pyriformRight;
  if (at.wall == Wall::tongue) return Location::tongueBase;
  if (at.wall == Wall::larynx && at.s_m <= r.foldsEnd_m) return Location::folds;
  return Location::pharyngealWall;
}

/// Region of a film, which has no particle to say it.
Region regionOfFilm(const Place& at, const ScoringRules& r) {
  if (at.s_m < r.ramus_m) return Region::oral;
  if (at.s_m < r.pyriformTop_m) return Region::oropharynx;
  return at.s_m < r.uesTop_m ? Region::hypopharynx : Region::esophagus;
}

Place nearestPlace(const frame::SkinTrack& skin, int frame, const Vec3f& p) {
  const auto& x = skin.positions[frame];
  std::size_t best = 0;
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t v = 0; v < x.size(); ++v) {
    const float d = (x[v] - p).squaredNorm();
    if (d < least) least = d, best = v;
  }
  return {skin.wall[best], skin.s_m[best], skin.u[best]};
}

void addFilm(const History& h, int frame, const ScoringRules& rules, std::vector<Deposit>& out) {
  if (static_cast<int>(h.skin.film_m.size()) <= frame) return;
  const auto& film = h.skin.film_m[frame];
  const auto& x = h.skin.positions[frame];
  for (std::size_t t = 0; t < film.size() && t < h.skin.triangles.size(); ++t) {
    if (!(film[t] > 0)) continue;
    const Triangle& tri = h.skin.triangles[t];
    const Vec3 a = x[tri[0]].cast<double>(), b = x[tri[1]].cast<double>(),
               c = x[tri[2]].cast<double>();
    Place at{h.skin.wall[tri[0]], 0, 0};
    for (int v : tri) at.s_m += h.skin.s_m[v] / 3.0, at.u += h.skin.u[v] / 3.0;
    const double area_m2 = 0.5 * (b - a).cross(c - a).norm();
    out.push_back(
        {(a + b + c) / 3, area_m2 * film[t], film[t], locate(at, regionOfFilm(at, rules), rules)});
  }
}

double meanSpeedLeft_ms(const frame::BolusTrack& bolus, int frame) {
  double sum = 0;
  int n = 0;
  for (std::size_t k = 0; k < bolus.state[frame].size(); ++k)
    if (isThere(bolus.state[frame][k])) sum += bolus.velocities[frame][k].norm(), ++n;
  return n ? sum / n : 0;
}
}  // namespace

const char* name(Location location) {
  return kRows[static_cast<std::size_t>(location)].name;
}
int componentOf(Location location) {
  return kRows[static_cast<std::size_t>(location)].component;
}
const char* letterOf(Location location) {
  return kRows[static_cast<std::size_t>(location)].letter;
}

double Residue::volume_m3(Location location) const {
  double sum = 0;
  for (const Deposit& d : deposits)
    if (d.location == location) sum += d.volume_m3;
  return sum;
}

double Residue::volume_m3(int component) const {
  double sum = 0;
  for (const Deposit& d : deposits)
    if (componentOf(d.location) == component) sum += d.volume_m3;
  return sum;
}

double Residue::thickness_m(int component, double radius_m) const {
  double thickest = 0;
  const double disc_m2 = kPi * radius_m * radius_m;
  for (const Deposit& d : deposits) {
    if (componentOf(d.location) != component) continue;
    thickest = std::max(thickest, d.film_m);
    if (d.film_m > 0) continue;
    double near_m3 = 0;
    for (const Deposit& other : deposits)
      if (componentOf(other.location) == component &&
          (other.position - d.position).norm() <= radius_m)
        near_m3 += other.volume_m3;
    thickest = std::max(thickest, near_m3 / disc_m2);
  }
  return thickest;
}

std::vector<Deposit> depositsAt(const History& h, int frame, const ScoringRules& rules) {
  std::vector<Deposit> out;
  for (std::size_t k = 0; k < h.bolus.state[frame].size(); ++k) {
    if (!isThere(h.bolus.state[frame][k])) continue;
    const Vec3f& p = h.bolus.positions[frame][k];
    out.push_back({p.cast<double>(), h.bolus.volume_m3(frame, k), 0,
                   locate(nearestPlace(h.skin, frame, p), h.bolus.region[frame][k], rules)});
  }
  addFilm(h, frame, rules, out);
  return out;
}

std::optional<Residue> measureResidue(const History& h, std::optional<int> swRest,
                                      const ScoringRules& rules) {
  if (!hasBolus(h)) return std::nullopt;
  Residue r;
  r.frame = h.frames() - 1;
  r.when = swRest ? "last frame (what is left never comes to rest)"
                  : "last frame (the structures do not come to rest)";
  for (int f = swRest.value_or(h.frames()); f < h.frames(); ++f)
    if (meanSpeedLeft_ms(h.bolus, f) < rules.residueSpeed_ms) {
      r.frame = f;
      r.when = fmt::format("first frame from SwRest on with what is left below {:g} mm/s",
                           rules.residueSpeed_ms * 1e3);
      break;
    }
  r.offered_m3 = h.bolus.particleVolume_m3 * static_cast<double>(h.bolus.s_m.front().size());
  r.deposits = depositsAt(h, r.frame, rules);
  return r;
}

std::optional<int> scoreResidue(const ResidueMeasures& m, const ScoringRules& r) {
  if (m.share > r.residueNearlyAll) return 4;
  if (m.share > r.residueMost) return 3;
  if (m.share < r.residueTrace) return 0;
  return m.share > r.residuePool || m.thickness_m >= r.poolThickness_m ? 2 : 1;
}

ComponentReport measureResidueComponent(int component, const std::optional<Residue>& residue,
                                        const ScoringRules& rules) {
  ComponentReport out;
  const std::string region = component == 5 ? "oral" : "pharyngeal";
  const std::string lack = "the history has no bolus";
  Quantity share{region + "_residue", {}, "share", -1, "", lack, {}};
  Quantity thick{region + "_residue_thickness", {}, "mm", -1, "", lack, {}};
  share.rule = "share of V0 left, particles and film";
  thick.rule = fmt::format(
      "largest volume per wall area within {:g} mm of a particle left there, or "
      "thickest film",
      rules.thicknessRadius_m * 1e3);
  if (!residue || !(residue->offered_m3 > 0)) {
    out.decision.reason = region + " residue: " + (residue ? "particles without volume" : lack);
    share.reason = thick.reason = out.decision.reason;
  } else {
    const ResidueMeasures m{residue->volume_m3(component) / residue->offered_m3,
                            residue->thickness_m(component, rules.thicknessRadius_m)};
    share.rule += "; " + residue->when;
    set(share, m.share, residue->frame), set(thick, m.thickness_m * 1e3, residue->frame);
    out.frame = residue->frame;
    std::string letters;
    for (int k = 0; k < kLocations; ++k) {
      const auto at = static_cast<Location>(k);
      if (componentOf(at) != component ||
          residue->volume_m3(at) < rules.residueTrace * residue->offered_m3)
        continue;
      if (letters.find(letterOf(at)) == std::string::npos) letters += letterOf(at);
    }
    out.decision =
        decide([&](const ScoringRules& r) { return scoreResidue(m, r); }, rules,
               fmt::format("{:.1f} % of V0 left, {:.2f} mm thick{}{}", 100 * m.share,
                           m.thickness_m * 1e3, letters.empty() ? "" : ", at ", letters));
  }
  out.quantities = {share, thick};
  out.liveSeries = region + "_share";
  return out;
}
}  // namespace swallowclip::scoring
