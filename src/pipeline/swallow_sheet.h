// SPDX-License-Identifier: MIT
// One page per swallow: who moves when (a Gantt chart of the measured events), where contact front
// and bolus are along the path, the ways of hyoid and larynx, the gaps that decide, what is left.
#pragma once
#include "frame/history.h"
#include "plot/figure.h"
#include "scoring/metrics.h"

namespace swallowclip::pipeline {

plot::Figure swallowSheet(const frame::History& history, const scoring::Metrics& metrics);
}  // namespace swallowclip::pipeline
