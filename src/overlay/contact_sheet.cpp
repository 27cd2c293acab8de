// SPDX-License-Identifier: MIT
#include "overlay/contact_sheet.h"

#include <algorithm>

#include "core/file.h"
#include "overlay/canvas.h"
#include "pipeline/interrupt.h"
#include "render/captions.h"
#include "video/png.h"

namespace swallowclip::overlay {
namespace {
constexpr int kColumns = 5, kRows = 6, kThumb_px = 300, kGap_px = 4;  // a sheet is 1520 px wide

constexpr int kStrip_px = 64;  // more than 3.4 caption sizes

constexpr const char* kTemplate = R"({
  "version": 1,
  "comment": "Frames as numbered on the sheets, pixels as in landmarks.png. See docs/overlay.md.",
  "facing": "left",
  "events": {"BPM": 0},
  "landmarks": [
    {"name": "C2_anterior_inferior", "x_px": 0, "y_px": 0},
    {"name": "C4_anterior_inferior", "x_px": 0, "y_px": 0}
  ]
}
)";
}  // namespace

Result<int> writeContactSheets(study::Study& study, const study::Protector& protector,
                               const std::filesystem::path& folder, pipeline::Progress& progress) {
  const study::StudyInfo& info = study.info();
  const study::Rectangle& o = protector.opening();
  const double zoom = static_cast<double>(kThumb_px) / o.width;
  const int high = std::max(1, static_cast<int>(std::lround(zoom * o.height)));
  render::CaptionDef caption;
  caption.size_px = 18;
  caption.timeBar = false;
  caption.credit = "";
  const int perSheet = kColumns * kRows;
  Image sheet;
  int sheets = 0;
  for (int k = 0; k < info.frames(); ++k) {
    if (pipeline::interrupted()) return std::unexpected(pipeline::interruptedError());
    auto image = study.frame(k);
    if (!image) return std::unexpected(image.error());
    protector.apply(*image);
    if (k == info.frames() / 2)
      if (auto written = video::writePng(*image, folder / "landmarks.png"); !written)
        return std::unexpected(written.error());
    const int cell = k % perSheet, left = std::min(perSheet, info.frames() - k + cell);
    if (cell == 0)
      sheet = Image(kColumns * (kThumb_px + kGap_px),
                    (left + kColumns - 1) / kColumns * (high + kGap_px));
    Image thumb(kThumb_px, high + kStrip_px);  // the strip takes the clip's time bar, unseen
    lay(
        thumb, {0, 0, kThumb_px, high}, *image,
        [&](const Vec2& p) { return Vec2(p / zoom + Vec2(o.x, o.y)); }, 1 / zoom);
    render::CaptionText words;
    words.title = fmt::format("{}    {:.3f} s", k, info.time_s[static_cast<std::size_t>(k)]);
    if (auto drawn = render::drawCaptions(thumb, caption, words); !drawn)
      return std::unexpected(drawn.error());
    thumb.height = high;
    paste(sheet, thumb, cell % kColumns * (kThumb_px + kGap_px),
          cell / kColumns * (high + kGap_px));
    if (cell + 1 == left) {
      ++sheets;
      if (auto written = video::writePng(sheet, folder / fmt::format("sheet-{:02}.png", sheets));
          !written)
        return std::unexpected(written.error());
    }
    progress.update(static_cast<double>(k + 1) / info.frames());
  }
  const auto file = folder / "study.events.json";
  std::error_code ec;
  if (!std::filesystem::exists(file, ec))
    if (auto written = writeFile(file, kTemplate); !written)
      return std::unexpected(written.error());
  return sheets;
}
}  // namespace swallowclip::overlay
