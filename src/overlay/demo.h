// SPDX-License-Identifier: MIT
// A study without a patient: simulated fluoroscopy of another swallow, as a video file with its
// events file, and the truth that a real study never tells.
#pragma once
#include <filesystem>
#include <vector>

#include "frame/history.h"
#include "overlay/marks.h"
#include "overlay/registration.h"
#include "render/render_preset.h"

namespace swallowclip::overlay {

/// All values assumed: another patient, another room.
struct DemoDef {
  int width = 640, height = 480;
  double pixelsPerMm = 3.05;     ///< the fluoroscope's scale
  double startAngle_deg = -1.5;  ///< head pose ...
  double turn_deg = 5;           ///< ... turned by this over the clip, evenly
  Vec2 drift_px{9, -6};          ///< and moved by this
  double noise = 3.5;            ///< grey levels, standard deviation, on top of the renderer's
  double landmarkNoise_px = 1;   ///< standard deviation per axis of the marked points
  int landmarkEvery = 6;         ///< frames between marked ones
  double aperture = 0.485;       ///< radius of the image intensifier / height
};

struct DemoTruth {
  std::vector<Similarity> place;  ///< [study frame]
};

struct DemoStudy {
  std::filesystem::path video, events;
  DemoTruth truth;
};

/// Truth of one frame of `frames`; `target_m` is the point of the plane in the picture's middle.
Similarity demoPlace(const DemoDef& def, const Vec2& target_m, int frame, int frames);

/// Marks with noise from the swallow's own landmarks and measured events.
Marks demoMarks(const DemoDef& def, const frame::History& swallow,
                const std::vector<StudyEvent>& events, const DemoTruth& truth);

/// The text of an events file.
std::string marksText(const Marks& marks);

/// Films `swallow` with the preset's view "fluoro" and writes FOLDER/demo-study.mp4 and
/// FOLDER/demo-study.events.json.
Result<DemoStudy> makeDemoStudy(const DemoDef& def, const frame::History& swallow,
                                const std::vector<StudyEvent>& events,
                                const render::RenderPreset& preset,
                                const std::filesystem::path& shaders,
                                const std::filesystem::path& folder);
}  // namespace swallowclip::overlay
