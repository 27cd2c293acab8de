// SPDX-License-Identifier: MIT
// What of the program itself shapes a product: our sources per stage, and the libraries that are
// loaded now, by their build ids (a security update of x264 redraws, one of libssl does not).
#pragma once
#include <string>

#include "library/job.h"

namespace swallowclip::library {

/// Digest over the sources of a stage and the compiler; made at build time.
std::string sourceVersion(Stage stage);

/// "libhdf5_serial.so.103=1f2e... libm.so.6=..." of the loaded libraries that shape the stage.
std::string libraryVersions(Stage stage);
}  // namespace swallowclip::library
