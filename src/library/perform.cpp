// SPDX-License-Identifier: MIT
#include "library/perform.h"

#include "core/digest.h"
#include "core/file.h"
#include "frame/history_file.h"
#include "library/clip_check.h"
#include "library/store.h"
#include "pipeline/clips.h"
#include "pipeline/confirm.h"
#include "pipeline/interrupt.h"
#include "pipeline/simulation.h"
#include "scene/json_reader.h"
#include "scene/json_text.h"
#include "scene/preset_file.h"
#include "scene/side_file.h"
#include "scoring/measure.h"

namespace swallowclip::library {
namespace fs = std::filesystem;
namespace {
struct Work {
  const Job& job;
  const Root& root;
  const fs::path& part;
  pipeline::Progress& progress;

  /// A file of what the job needs.
  fs::path needed(std::size_t which, const std::string& file) const {
    return root.product(job.needs.at(which)) / file;
  }

  /// The motion alone, without fluid: a swallow that can't be baked stops here, not once per bolus.
  Result<void> bake() const {
    auto h =
        pipeline::simulateSwallow(job.choice.options(), job.choice.score, job.choice.fps, progress);
    if (!h) return std::unexpected(h.error());
    std::uint64_t digest = 0;
    for (int k = 0; k < h->frames(); ++k) {
      const std::uint64_t one = h->digest(k);
      digest = stateDigest(&one, sizeof one, digest);
    }
    std::string events;
    for (const frame::Event& e : h->plannedEvents)
      events += fmt::format("{}{}: {:.6g}", events.empty() ? "" : ", ", scene::quotedJson(e.name),
                            e.time_s);
    return writeFile(
        part / "motion.json",
        fmt::format("{{\"swallow\": {}, \"frames\": {}, \"fps\": {}, "
                    "\"motion_digest\": \"{:016x}\",\n \"planned_events_s\": {{{}}}}}\n",
                    scene::quotedJson(h->meta.swallow), h->frames(), h->meta.fps, digest, events));
  }

  /// Goes on where a killed job has left its checkpoint; a damaged one only costs the time saved.
  Result<void> simulate() const {
    pipeline::RunOptions o = job.choice.options();
    o.commandLine = fmt::format("swallowclip job {} --out '{}'", job.key, root.path.string());
    o.checkpoint = root.run() / "checkpoints" / job.key;
    std::error_code ec;
    const bool resumed = fs::exists(o.checkpoint, ec);
    auto h = pipeline::simulateSwallow(o, job.choice.score, job.choice.fps, progress);
    if (!h && resumed && !pipeline::interrupted()) {
      progress.note(fmt::format("{}\nonce more, without the checkpoint", h.error().text()));
      fs::remove(o.checkpoint, ec);
      h = pipeline::simulateSwallow(o, job.choice.score, job.choice.fps, progress);
    }
    if (!h) return std::unexpected(h.error());
    return frame::saveHistory(*h, part / "history.h5");
  }

  Result<void> measure() const {
    auto h = frame::loadHistory(needed(0, "history.h5"));
    if (!h) return std::unexpected(h.error());
    auto metrics = pipeline::measureHistory(job.choice.options().scenesFolder(), *h);
    if (!metrics) return std::unexpected(metrics.error());
    return writeFile(part / "measures.json", scene::sideFileText(*h, *metrics));
  }

  Result<void> draw() const {
    pipeline::RunOptions o = job.choice.options();
    auto preset = scene::loadPreset(o.presetsFolder(), o.preset);
    if (!preset) return std::unexpected(preset.error());
    auto h = frame::loadHistory(needed(0, "history.h5"));
    if (!h) return std::unexpected(h.error());
    auto metrics = pipeline::measureHistory(job.choice.options().scenesFolder(), *h);
    if (!metrics) return std::unexpected(metrics.error());
    auto times = pipeline::drawClips(o, *preset, *h, *metrics, part, job.choice.stem(), progress);
    if (!times) return std::unexpected(times.error());
    return {};
  }

  Result<void> verify() const {
    auto measures = scene::JsonFile::load(needed(0, "measures.json"));
    if (!measures) return std::unexpected(measures.error());
    const int frames = measures->root().integer("frames", 1, 1'000'000);
    const double fps = measures->root().number("fps", 1, 1000);
    const std::string stem = fmt::format("{}-{}", job.choice.stem(), job.choice.view);
    auto facts = readBack(needed(1, stem + ".mp4"), frames, fps, job.choice.sheet, part);
    if (!facts) return std::unexpected(facts.error());
    return writeFile(part / "verify.json",
                     fmt::format("{{\"frames\": {}, \"fps\": {}, \"width_px\": {}, "
                                 "\"height_px\": {}}}\n",
                                 facts->frames, facts->fps, facts->width, facts->height));
  }
};
}  // namespace

Result<void> perform(const Job& job, const Root& root, const fs::path& part,
                     pipeline::Progress& progress) {
  const Work work{job, root, part, progress};
  switch (job.stage) {
    case Stage::bake:
      return work.bake();
    case Stage::simulate:
      return work.simulate();
    case Stage::measure:
      return work.measure();
    case Stage::draw:
      return work.draw();
    case Stage::verify:
      break;
  }
  return work.verify();
}
}  // namespace swallowclip::library
