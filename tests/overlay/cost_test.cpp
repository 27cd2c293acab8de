// SPDX-License-Identifier: MIT
// What a clip beside an X-ray costs, over what the 3D view's own clip of the same frames costs.
// Processor time, so that a busy machine measures the same; seconds by the clock are only printed.
#include <chrono>
#include <cstdio>
#include <ctime>

#include "overlay/demo.h"
#include "overlay/film.h"
#include "pipeline/clips.h"
#include "pipeline/confirm.h"
#include "pipeline/simulation.h"
#include "run.h"
#include "scene/preset_file.h"

namespace swallowclip::overlay {
namespace {
constexpr int kFrames = 110;
constexpr double kRate_hz = 30;

struct Spent {
  double processor_s = 1e9, clock_s = 1e9;
};
/// The cheaper of what was spent before and what `work` spends.
template <class Work>
Spent cheaper(const Spent& before, Work work) {
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t processor = std::clock();
  work();
  const double processor_s = static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC;
  const std::chrono::duration<double> clock = std::chrono::steady_clock::now() - start;
  return {std::min(before.processor_s, processor_s), std::min(before.clock_s, clock.count())};
}
}  // namespace

// Acceptance: side-by-side of 110 frames at 720p costs at most 1.3 times the view's own clip.
TEST(OverlayCost, SideBySideOverTheViewAlone) {
  test::Scratch scratch;
  Said said;
  pipeline::RunOptions o = options(scratch);
  o.component = 4;
  o.bolus = "thin";
  o.views = {"oblique"};
  auto preset = scene::loadPreset(o.presetsFolder(), "training");
  ASSERT_TRUE(preset);
  ASSERT_EQ(preset->height, 720);
  auto simulated = pipeline::simulateSwallow(o, 0, kRate_hz, said);
  ASSERT_TRUE(simulated) << simulated.error().text();
  auto metrics = pipeline::measureHistory(o.scenesFolder(), *simulated);
  ASSERT_TRUE(metrics) << metrics.error().text();
  std::vector<double> time_s;
  for (int k = 0; k < kFrames; ++k) time_s.push_back(k / kRate_hz);
  const frame::History model = retimed(*simulated, TimeWarp::shift(0), time_s, kRate_hz);
  const auto shaders = o.data / "shaders";
  const auto* hyb = metrics->event("HYB");
  ASSERT_TRUE(hyb && hyb->frame >= 0 && hyb->frame < kFrames);
  auto made = makeDemoStudy({}, model, {{"HYB", hyb->frame}}, *preset, shaders, scratch.path());
  ASSERT_TRUE(made) << made.error().text();

  // everything but the simulation: reading, covering, placing, drawing, encoding
  const auto beside = [&] {
    auto s = study::Study::open({made->video});
    ASSERT_TRUE(s);
    ASSERT_EQ((*s)->info().frames(), kFrames);
    study::ProtectDef vouched;
    vouched.noBurnedInText = true;
    auto protector = study::Protector::make(**s, vouched);
    auto marks = loadMarks(made->events, (*s)->info());
    ASSERT_TRUE(protector && marks);
    const Clock clock = makeClock((*s)->info());
    const auto shown = retimed(*simulated, TimeWarp::shift(0), clock.time_s, clock.rate.hz());
    auto place = Registration::make(*marks, shown, clock.clipFrameOf);
    auto composer = Composer::make({}, *preset, shaders, protector->opening());
    ASSERT_TRUE(place && composer);
    FilmDef def;
    def.path = scratch / "beside.mp4";
    ASSERT_TRUE(film(def, **s, *protector, *marks, clock, shown, *place, *composer, said));
  };
  const auto alone = [&] {
    ASSERT_TRUE(pipeline::drawClips(o, *preset, model, *metrics, scratch.path(), "alone", said));
  };
  Spent both, view;
  for (int round = 0; round < 3; ++round) {
    both = cheaper(both, beside);
    view = cheaper(view, alone);
  }
  std::fprintf(stderr,
               "side by side %.2f s (%.2f s of processor), view alone %.2f s (%.2f s): %.2f times "
               "by the clock, %.2f by the processor\n",
               both.clock_s, both.processor_s, view.clock_s, view.processor_s,
               both.clock_s / view.clock_s, both.processor_s / view.processor_s);
  EXPECT_LE(both.processor_s, 1.3 * view.processor_s);
}
}  // namespace swallowclip::overlay
