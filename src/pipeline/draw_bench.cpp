// SPDX-License-Identifier: MIT
#include "pipeline/draw_bench.h"

#include <sys/resource.h>

#include <chrono>
#include <ctime>

#include "core/file.h"
#include "render/renderer.h"
#include "video/png.h"

namespace swallowclip::pipeline {
namespace {
constexpr int kFrames = 12;  // spread over the clip

// Processor time of all threads, so that a busy machine measures the same; and the wall's.
struct Cost {
  double cpu_ms = 0, wall_ms = 0;

  template <class Draw>
  static Result<Cost> of(Draw&& draw) {
    const auto wall = std::chrono::steady_clock::now();
    const std::clock_t cpu = std::clock();
    if (auto drawn = draw(); !drawn) return std::unexpected(drawn.error());
    return Cost{
        1e3 * static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC,
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - wall).count()};
  }
  void add(const Cost& c) {
    cpu_ms += c.cpu_ms / kFrames;
    wall_ms += c.wall_ms / kFrames;
  }
};

struct Row {
  Cost full, plain;
  int triangles = 0;  ///< most of any frame
};

// What was timed, for the eye.
Result<void> keep(const Image& image, const std::filesystem::path& folder, const std::string& view,
                  int frame) {
  if (auto ready = prepareFolder(folder); !ready) return ready;
  return video::writePng(image, folder / fmt::format("{}-{:04}.png", view, frame));
}
}  // namespace

Result<void> benchDrawing(const RunOptions& o, const render::RenderPreset& preset,
                          const frame::History& h, Progress& progress) {
  auto renderer = render::Renderer::create(o.data / "shaders", preset);
  if (!renderer) return std::unexpected(renderer.error());
  std::vector<Row> rows(o.views.size());
  render::CaptionText words;
  words.title = h.meta.swallow;
  for (int k = -1; k < kFrames; ++k) {  // the first round compiles, and is not counted
    const int frame = std::max(k, 0) * (h.frames() - 1) / kFrames;
    for (const bool plain : {false, true})
      for (std::size_t v = 0; v < rows.size(); ++v) {
        Image image;
        const auto cost = Cost::of([&] {
          auto drawn = plain ? renderer->drawPlain(h, frame, o.views[v])
                             : renderer->draw(h, frame, o.views[v], words);
          if (drawn) image = std::move(*drawn);
          return drawn;
        });
        if (!cost) return std::unexpected(cost.error());
        if (k == kFrames / 2 && !plain)
          if (auto kept = keep(image, o.out, o.views[v], frame); !kept) return kept;
        if (k >= 0) (plain ? rows[v].plain : rows[v].full).add(*cost);
        rows[v].triangles = std::max(rows[v].triangles, renderer->trianglesDrawn());
      }
    progress.update((k + 1.0) / (kFrames + 1));
  }
  std::string text =
      fmt::format("{}: {} x {}, {} frames, milliseconds of processor time per frame\n", preset.name,
                  preset.width, preset.height, kFrames);
  const auto line = [&](const std::string& name, int triangles, const Row& r) {
    text += fmt::format(
        "{:10} {:6} triangles  {:6.1f}  plain {:5.1f}  {:4.1f} times  {:5.1f} frames/s\n", name,
        triangles, r.full.cpu_ms, r.plain.cpu_ms, r.full.cpu_ms / r.plain.cpu_ms,
        1e3 / r.full.wall_ms);
  };
  Row mean;
  for (std::size_t v = 0; v < rows.size(); ++v) {
    line(o.views[v], rows[v].triangles, rows[v]);
    const double share = 1.0 / static_cast<double>(rows.size());
    for (auto [sum, one] : {std::pair(&mean.full, &rows[v].full), {&mean.plain, &rows[v].plain}}) {
      sum->cpu_ms += share * one->cpu_ms;
      sum->wall_ms += share * one->wall_ms;
    }
    mean.triangles = std::max(mean.triangles, rows[v].triangles);
  }
  line("mean", mean.triangles, mean);
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  text += fmt::format("peak memory {:.2f} GB; {}\n", static_cast<double>(used.ru_maxrss) * 1024e-9,
                      renderer->description());
  progress.print(text);
  return {};
}
}  // namespace swallowclip::pipeline
