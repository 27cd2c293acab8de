// SPDX-License-Identifier: MIT
#include "scoring/conservation.h"

#include <cmath>

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

/// Fluid, film, what is swallowed and what coats the walls, against the start: the worst frame's.
double worstVolumeError(const frame::History& h, double start) {
  const frame::BolusTrack& bolus = h.bolus;
  double worst = 0;
  const auto look = [&worst, start](double particles) {
    const double error = particles / start - 1;
    if (std::abs(error) > std::abs(worst)) worst = error;
  };
  if (bolus.lentShare.empty())
    for (const frame::LedgerRow& row : h.ledger) look(row.fluid + row.film + row.swallowed);
  for (std::size_t k = 0; k < bolus.lentShare.size(); ++k) {
    const int frame = static_cast<int>(k);
    double held_m3 = coatingVolume_m3(h.skin, frame);
    for (std::size_t i = 0; i < bolus.state[k].size(); ++i) held_m3 += bolus.volume_m3(frame, i);
    look(held_m3 / bolus.particleVolume_m3);
  }
  return worst;
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
  double swallowed_m3 = 0;  // without what they have lent
  for (std::size_t k = 0; k < state.size(); ++k) {
    if (state[k] == ParticleState::swallowed || region[k] == Region::swallowed) {
      ++c.swallowed;
      swallowed_m3 += bolus.volume_m3(last, k);
      continue;
    }
    c.coated += state[k] == ParticleState::coating;
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
    c.coating_m3 = coatingVolume_m3(history.skin, last);
    c.swallowedFraction = swallowed_m3 / (bolus.particleVolume_m3 * start);
  }
  c.volumeError = worstVolumeError(history, start);
  c.filmFraction = film / start;
  c.meanDensityError = history.meta.meanDensityError;
  c.maxDensityError = history.meta.maxDensityError;
  c.shareAboveTenPercent = history.meta.shareAboveTenPercent;
  c.velocityClamps = history.meta.velocityClamps;
  return c;
}
}  // namespace swallowclip::scoring
