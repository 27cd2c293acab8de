// SPDX-License-Identifier: MIT
// A night put together beside the others, read back, and only then shown to the world.
#pragma once
#include "library/manifest.h"

namespace swallowclip::library {

/// The night that `current` points to; empty when there is none or its manifest is damaged.
std::optional<Night> publishedNight(const Root& root);

/// Are all files of the published night as its manifest says?
bool nightHolds(const Root& root, const Night& night, Stamps& stamps);

/// Copies the products of `night` into nights/NAME (files that the last one has already are
/// linked to it), reads every file back, and swaps `current`. On an error nothing has changed.
/// Fills the name.
Result<void> publishNight(Night& night, const std::optional<Night>& last, const Plan& plan,
                          const Root& root, Stamps& stamps);

/// Deletes old nights beyond the count and size of the spec, never the published one, and what
/// killed nights have left. Returns how many.
int pruneNights(const Root& root, const PublishDef& limits);
}  // namespace swallowclip::library
