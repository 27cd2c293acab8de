// SPDX-License-Identifier: MIT
// A finished history drawn and encoded: one clip per view, with chapters and a poster beside it.
#pragma once
#include <filesystem>
#include <string>

#include "core/error.h"
#include "frame/history.h"
#include "pipeline/progress.h"
#include "pipeline/run_options.h"
#include "render/render_preset.h"
#include "scoring/metrics.h"

namespace swallowclip::pipeline {

/// Seconds of one clip set, for the job's own account.
struct ClipTimes {
  double drawing_s = 0, encoding_s = 0;
};

/// Writes FOLDER/STEM-VIEW.mp4, .vtt and .png for every view of the options.
Result<ClipTimes> drawClips(const RunOptions& options, const render::RenderPreset& preset,
                            const frame::History& history, const scoring::Metrics& metrics,
                            const std::filesystem::path& folder, const std::string& stem,
                            Progress& progress);

/// "c04-s3-thesis-honey", or the swallow's and the bolus' name when no score is meant.
std::string clipStem(const frame::Meta& meta);
}  // namespace swallowclip::pipeline
