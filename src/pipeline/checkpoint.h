// SPDX-License-Identifier: MIT
// A run's bolus so far, kept in a file beside it: frames and the state of the solver. Everything
// else in a history follows from the scene and is computed again.
#pragma once
#include <filesystem>

#include "bolus/solver.h"
#include "frame/history.h"

namespace swallowclip::pipeline {

/// Of the frames 0 .. h.ledger.size() - 1. Written aside and renamed.
Result<void> writeCheckpoint(const std::filesystem::path& path, const bolus::Solver& solver,
                             const frame::History& h);

/// Fills the bolus and ledger of `h` and sets the solver back to that moment. Errors when the file
/// is damaged or was written for other inputs (h.meta.inputsSha256).
Result<void> readCheckpoint(const std::filesystem::path& path, bolus::Solver& solver,
                            frame::History& h);
}  // namespace swallowclip::pipeline
