// SPDX-License-Identifier: MIT
#pragma once
#include "verify/case.h"
#include "verify/result.h"

namespace swallowclip::verify {

/// Runs a case with one thread, coarser spacings first. A run that stops is a result too; only an
/// interruption is an error.
Result<CaseResult> runCase(const CaseDef& def);
/// Integrals, first moments and slopes of all kernels; no fluid.
CaseResult runKernelCase(const CaseDef& def);
}  // namespace swallowclip::verify
