// SPDX-License-Identifier: MIT
#include "scoring/conservation.h"

namespace swallowclip::scoring {
namespace {
using frame::ParticleState;
using frame::Region;

void countRegion(Region region, Conservation& c) {
  switch (region) {
    case Region::oral:
      ++c.leftInOral;
      break;
    case Region::oropharynx:
    case Region::hypopharynx:
      ++c.leftInPharynx;
      break;
    case Region::larynx:
      ++c.inAirway;
      break;
    case Region::nasopharynx:
      ++c.inNasopharynx;
      break;
    case Region::esophagus:
      ++c.inEsophagus;
      break;
    case Region::swallowed:
      break;  // the caller counts them by state
  }
}

double coatingVolume_m3(const frame::SkinTrack& skin, int frame) {
  double sum_m3 = 0;
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    const Triangle& tri = skin.triangles[t];
    const auto at = [&](int v) -> Vec3 { return skin.positions[frame][v].cast<double>(); };
    const Vec3 a = at(tri[0]);
    sum_m3 += (at(tri[1]) - a).cross(at(tri[2]) - a).norm() / 2 * skin.film_m[frame][t];
  }
  return sum_m3;
}
}  // namespace

std::optional<Conservation> countParticles(const frame::History& history) {
  const frame::BolusTrack& bolus = history.bolus;
  if (bolus.state.empty() || bolus.state.back().empty()) return std::nullopt;
  const auto& state = bolus.state.back();
  const auto& region = bolus.region.back();

  Conservation c;
  const int last = static_cast<int>(bolus.state.size()) - 1;
  int film = 0;
  double swallowed_m3 = 0, left_m3 = 0;  // of particles, without what they have lent
  for (std::size_t k = 0; k < state.size(); ++k) {
    if (state[k] == ParticleState::swallowed || region[k] == Region::swallowed) {
      ++c.swallowed;
      swallowed_m3 += bolus.volume_m3(last, k);
      continue;
    }
    c.coated += state[k] == ParticleState::coating;
    left_m3 += bolus.volume_m3(last, k);
    if (state[k] == ParticleState::coating) continue;
    countRegion(region[k], c);
    ++c.particlesEnd;
    film += state[k] == ParticleState::film;
  }
  c.particlesStart = static_cast<int>(state.size());
  if (!history.ledger.empty()) {
    c.particlesStart = history.ledger.front().start;
    // The solver knows best how many it lost; they have no place of their own in the track.
    for (const auto& row : history.ledger) c.escaped = std::max(c.escaped, row.escaped);
    c.particlesEnd = history.ledger.back().fluid + history.ledger.back().film;
  }
  const double start = c.particlesStart > 0 ? c.particlesStart : 1;
  c.swallowedFraction = c.swallowed / start;
  if (!bolus.lentShare.empty()) {
    const double start_m3 = bolus.particleVolume_m3 * start;
    c.coating_m3 = coatingVolume_m3(history.skin, last);
    c.swallowedFraction = swallowed_m3 / start_m3;
    c.volumeError = (swallowed_m3 + left_m3 + *c.coating_m3) / start_m3 - 1;
  }
  c.filmFraction = film / start;
  c.meanDensityError = history.meta.meanDensityError;
  c.maxDensityError = history.meta.maxDensityError;
  c.shareAboveTenPercent = history.meta.shareAboveTenPercent;
  c.velocityClamps = history.meta.velocityClamps;
  return c;
}
}  // namespace swallowclip::scoring
