// SPDX-License-Identifier: MIT
// A swallow's motion tracks moved so that its events fall where the patient's do; the bolus is
// then simulated anew and follows.
#pragma once
#include <string>
#include <vector>

#include "kinematics/swallow_def.h"
#include "overlay/retime.h"

namespace swallowclip::overlay {

struct MovedSwallow {
  kinematics::SwallowDef swallow;
  double cue_s = 0;  ///< study time of the swallow's own time 0
};

/// The whole timeline follows a warp through as many pairs as keep the model's order, BPM first;
/// each of the others moves its own tracks: HYB the hyoid's, LVC and LVCoff the arytenoids', UESO,
/// UESMax and UESC the sphincter's. So do those of them that lie next to another in the model, and
/// their corrections always, so that they leave the bolus alone. The rate of a rocking tongue
/// stays.
Result<MovedSwallow> movedTo(const kinematics::SwallowDef& swallow,
                             const std::vector<EventPair>& pairs, double frame_s);
}  // namespace swallowclip::overlay
