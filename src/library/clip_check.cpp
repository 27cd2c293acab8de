// SPDX-License-Identifier: MIT
#include "library/clip_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "core/file.h"
#include "video/png.h"
#include "video/video_reader.h"

namespace swallowclip::library {
namespace fs = std::filesystem;
namespace {
constexpr int kThumb_px = 320;  // wide enough for a card of the report on a dense screen
constexpr int kBlock_px = 8;    // as in Wang et al. 2004
constexpr double kC1 = 6.5025, kC2 = 58.5225;  // (0.01 * 255)^2, (0.03 * 255)^2; Wang et al. 2004

auto wrong(const fs::path& file, std::string problem) {
  return failure(file.string(), std::move(problem),
                 "Delete the product's folder; the next night draws it again.");
}

void paste(const Image& from, Image& to, int x0, int y0) {
  const int width = std::min(from.width, to.width - x0);
  for (int y = 0; y < std::min(from.height, to.height - y0); ++y)
    std::memcpy(to.row(y0 + y) + 4 * x0, from.row(y), static_cast<std::size_t>(width) * 4);
}

Result<void> readBeside(const fs::path& clip, int width, int height) {
  fs::path poster = clip, chapters = clip;
  auto image = video::readPng(poster.replace_extension(".png"));
  if (!image) return std::unexpected(image.error());
  if (image->width != width || image->height != height)
    return wrong(poster, fmt::format("{} x {}, the clip is {} x {}", image->width, image->height,
                                     width, height));
  auto text = readFile(chapters.replace_extension(".vtt"));
  if (!text) return std::unexpected(text.error());
  if (!text->starts_with("WEBVTT\n") || text->find("-->") == std::string::npos)
    return wrong(chapters, "no chapter track");
  return {};
}

double luma(const std::uint8_t* p) {  // BT.709
  return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
}

/// Structural similarity of one block, eq. 13 of Wang et al. 2004.
double similarity(const Image& a, const Image& b, int x0, int y0) {
  double sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  for (int y = y0; y < y0 + kBlock_px; ++y)
    for (int x = x0; x < x0 + kBlock_px; ++x) {
      const double u = luma(a.row(y) + 4 * x), v = luma(b.row(y) + 4 * x);
      sa += u;
      sb += v;
      saa += u * u;
      sbb += v * v;
      sab += u * v;
    }
  constexpr double n = kBlock_px * kBlock_px;
  const double ma = sa / n, mb = sb / n;
  const double va = saa / n - ma * ma, vb = sbb / n - mb * mb, cov = sab / n - ma * mb;
  return (2 * ma * mb + kC1) * (2 * cov + kC2) / ((ma * ma + mb * mb + kC1) * (va + vb + kC2));
}
}  // namespace

Image shrink(const Image& image, int width_px) {
  const int w = std::clamp(width_px, 1, image.width);
  const int h = std::max(1, image.height * w / image.width);
  Image small(w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const int x0 = x * image.width / w, x1 = std::max(x0 + 1, (x + 1) * image.width / w);
      const int y0 = y * image.height / h, y1 = std::max(y0 + 1, (y + 1) * image.height / h);
      std::array<int, 3> sum{};
      for (int v = y0; v < y1; ++v)
        for (int u = x0; u < x1; ++u)
          for (int c = 0; c < 3; ++c) sum[c] += image.row(v)[4 * u + c];
      for (int c = 0; c < 3; ++c)
        small.row(y)[4 * x + c] = static_cast<std::uint8_t>(sum[c] / ((x1 - x0) * (y1 - y0)));
    }
  return small;
}

double visibleDifference(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height) return 1;
  double sum = 0;
  int blocks = 0;
  for (int y = 0; y + kBlock_px <= a.height; y += kBlock_px)
    for (int x = 0; x + kBlock_px <= a.width; x += kBlock_px, ++blocks)
      sum += similarity(a, b, x, y);
  return blocks > 0 ? 1 - sum / blocks : 0;
}

Result<ClipFacts> readBack(const fs::path& clip, int frames, double fps, const SheetDef& def,
                           const fs::path& folder) {
  auto reader = video::VideoReader::open(clip);
  if (!reader) return std::unexpected(reader.error());
  ClipFacts facts;
  facts.width = (*reader)->info().width;
  facts.height = (*reader)->info().height;
  facts.fps = (*reader)->info().fps;
  const int tiles = def.columns * def.rows;
  Image sheet;
  for (;; ++facts.frames) {
    auto frame = (*reader)->next();
    if (!frame) return std::unexpected(frame.error());
    if (!*frame) break;
    // Half a frame of slack: times are stored in whole ticks.
    if (std::abs((**frame).time_s - facts.frames / fps) > 0.5 / fps)
      return wrong(clip, fmt::format("frame {} comes at {:.3f} s, {:.3f} s expected", facts.frames,
                                     (**frame).time_s, facts.frames / fps));
    // The middle frame of each of `tiles` equal parts.
    const int tile = facts.frames * tiles / std::max(frames, 1);
    const int first = (2 * tile + 1) * frames / (2 * tiles);
    if (facts.frames != first || tile >= tiles) continue;
    const Image small = shrink((**frame).image, def.width_px);
    if (sheet.width == 0) sheet = Image(small.width * def.columns, small.height * def.rows);
    paste(small, sheet, tile % def.columns * small.width, tile / def.columns * small.height);
  }
  if (facts.frames != frames)
    return wrong(clip, fmt::format("{} frames, {} expected", facts.frames, frames));
  if (auto beside = readBeside(clip, facts.width, facts.height); !beside)
    return std::unexpected(beside.error());
  if (auto written = video::writePng(sheet, folder / "sheet.png"); !written)
    return std::unexpected(written.error());
  fs::path poster = clip;
  const auto image = video::readPng(poster.replace_extension(".png"));
  if (auto written = video::writePng(shrink(*image, kThumb_px), folder / "thumb.png"); !written)
    return std::unexpected(written.error());
  return facts;
}
}  // namespace swallowclip::library
