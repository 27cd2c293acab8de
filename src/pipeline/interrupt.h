// SPDX-License-Identifier: MIT
// Ctrl-C: the first asks the pipeline to stop at the next frame, tidy up and return an error; a
// second one ends the process at once.
#pragma once
#include "core/error.h"

namespace swallowclip::pipeline {

/// Catches SIGINT and SIGTERM from now on.
void catchInterrupts();

/// To be polled between frames and between clips. Lock-free, cheap.
bool interrupted();

/// The error to return once `interrupted()`; the cli room turns it into exit code 130.
Error interruptedError();

/// For tests: sets or clears the flag as a signal would.
void setInterrupted(bool value);
}  // namespace swallowclip::pipeline
