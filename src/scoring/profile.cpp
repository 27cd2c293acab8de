// SPDX-License-Identifier: MIT
#include "scoring/profile.h"

#include <cmath>
#include <limits>

namespace swallowclip::scoring {

double crossingForward_m(const std::vector<int>& chain, const std::vector<Vec3f>& x,
                         const Spine& spine, double height_m, bool rearmost) {
  double best = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t k = 1; k < chain.size(); ++k) {
    const Vec3 a = x[chain[k - 1]].cast<double>(), b = x[chain[k]].cast<double>();
    const double ha = spine.height_m(a) - height_m, hb = spine.height_m(b) - height_m;
    if (ha * hb > 0 || ha == hb) continue;
    const double w = ha / (ha - hb);
    const double at = (1 - w) * spine.forward_m(a) + w * spine.forward_m(b);
    if (!std::isfinite(best) || (rearmost ? at < best : at > best)) best = at;
  }
  return best;
}

}  // namespace swallowclip::scoring
