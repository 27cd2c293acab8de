// SPDX-License-Identifier: MIT
// A small history with every kind of content, and a folder that goes away.
#pragma once
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "frame/history.h"
#include "scratch.h"

namespace swallowclip::frame {

/// Two rigid and one soft structure, skin with film, `particles` of bolus, landmarks, events.
/// `grid` x `grid` vertices per surface; numbers come from a fixed pseudo-random sequence.
History sampleHistory(int frames = 5, int grid = 4, int particles = 7);

using test::Scratch;
}  // namespace swallowclip::frame
