// SPDX-License-Identifier: MIT
// The one door to OpenGL: a current core-profile 4.5 context without a window. OSMesa today
// (llvmpipe); upstream Mesa dropped OSMesa after 25.0, so another maker can stand in here.
// One context per thread; LP_NUM_THREADS in the environment sets llvmpipe's workers.
#pragma once
#include <memory>
#include <string>

#include "core/error.h"

namespace swallowclip::render {

class Context {
 public:
  virtual ~Context() = default;
  /// Makes the context current on this thread.
  virtual Result<void> makeCurrent() = 0;
  /// Driver and version, for reports.
  virtual std::string description() const = 0;
};

/// Off-screen context through OSMesa, current on return.
Result<std::unique_ptr<Context>> createOsmesaContext();
}  // namespace swallowclip::render
