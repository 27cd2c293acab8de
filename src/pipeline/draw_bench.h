// SPDX-License-Identifier: MIT
// `swallowclip draw --bench`: what a frame costs in every view, beside one light on the same
// triangles at the same size in the same run.
#pragma once
#include "core/error.h"
#include "frame/history.h"
#include "pipeline/progress.h"
#include "pipeline/run_options.h"
#include "render/render_preset.h"

namespace swallowclip::pipeline {

Result<void> benchDrawing(const RunOptions& options, const render::RenderPreset& preset,
                          const frame::History& history, Progress& progress);
}  // namespace swallowclip::pipeline
