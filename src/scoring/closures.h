// SPDX-License-Identifier: MIT
// Doors that a swallow shuts: components 7 (soft palate against the wall) and 11 (laryngeal
// vestibule).
#pragma once
#include "frame/history.h"
#include "scoring/decision.h"
#include "scoring/lumen.h"

namespace swallowclip::scoring {

struct Component7Measures {
  double ratio = 0, gap_m = 0;  ///< least width of the velopharyngeal port
  double nasopharynx = 0;       ///< most of V0 that is in it at any frame, as a share
  double nasal = 0;             ///< of that, what lies before the posterior nasal spine
};
std::optional<int> scoreComponent7(const Component7Measures& m, const ScoringRules& rules);
ComponentReport measureComponent7(const frame::History& history, const LumenProfile& lumen,
                                  const ScoringRules& rules);

struct Component11Measures {
  double ratio = 0, gap_m = 0;  ///< least width of the vestibule
  int particles = 0;            ///< in the airway at that frame
};
std::optional<int> scoreComponent11(const Component11Measures& m, const ScoringRules& rules);
ComponentReport measureComponent11(const frame::History& history, const LumenProfile& lumen,
                                   const ScoringRules& rules);
}  // namespace swallowclip::scoring
