// SPDX-License-Identifier: MIT
// Known answers by name. Every number they need comes from the case itself.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "core/error.h"
#include "verify/case.h"

namespace swallowclip::verify {

/// Where and when an answer is wanted.
struct Probe {
  Vec3 at = Vec3::Zero();  ///< in the frame of the walls, m
  double along = 0;        ///< the profile's coordinate, m (tables are read at it)
  double time_s = 0;
};
/// Not a number where the reference says nothing.
using Reference = std::function<double(const Probe&)>;

std::vector<std::string> referenceNames();
/// Profiles are functions of place and time, series of time alone. (Tables may be either.)
bool referenceIsProfile(const std::string& name);
/// Fails when the case lacks what the formula needs.
Result<Reference> makeReference(const CaseDef& def, const ReferenceDef& reference);
}  // namespace swallowclip::verify
