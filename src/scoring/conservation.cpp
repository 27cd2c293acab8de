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
}  // namespace

std::optional<Conservation> countParticles(const frame::History& history) {
  const frame::BolusTrack& bolus = history.bolus;
  if (bolus.state.empty() || bolus.state.back().empty()) return std::nullopt;
  const auto& state = bolus.state.back();
  const auto& region = bolus.region.back();

  Conservation c;
  int film = 0;
  for (std::size_t k = 0; k < state.size(); ++k) {
    if (state[k] == ParticleState::swallowed || region[k] == Region::swallowed) {
      ++c.swallowed;
      continue;
    }
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
  c.filmFraction = film / start;
  c.meanDensityError = history.meta.meanDensityError;
  c.maxDensityError = history.meta.maxDensityError;
  return c;
}
}  // namespace swallowclip::scoring
