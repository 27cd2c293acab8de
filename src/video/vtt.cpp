// SPDX-License-Identifier: MIT
#include "video/vtt.h"

#include <algorithm>
#include <cmath>

#include "core/file.h"

namespace swallowclip::video {
namespace {
// WebVTT hours may have any number of digits; a clip is minutes. assumed, range 1 h to 100 h.
constexpr double kLongest_s = 24 * 3600;

std::string timestamp(long long ms) {
  return fmt::format("{:02}:{:02}:{:02}.{:03}", ms / 3600000, ms / 60000 % 60, ms / 1000 % 60,
                     ms % 1000);
}

/// Cue text may hold no markup and no line break; "-->" can't survive the escape of ">".
std::string cueText(const std::string& name) {
  std::string text;
  for (char c : name) {
    if (c == '&')
      text += "&amp;";
    else if (c == '<')
      text += "&lt;";
    else if (c == '>')
      text += "&gt;";
    else if (static_cast<unsigned char>(c) < 0x20)
      text += ' ';
    else
      text += c;
  }
  return text;
}

bool blank(const std::string& text) {
  return std::all_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) <= ' '; });
}
}  // namespace

Result<std::string> vttText(std::vector<Chapter> chapters, double duration_s,
                            const std::string& opening) {
  if (!(duration_s > 0 && duration_s <= kLongest_s))
    return usageError(
        "chapters",
        fmt::format("clip of {} s, more than 0 and up to {} expected", duration_s, kLongest_s),
        "Give the clip's own duration.");
  for (const Chapter& c : chapters)
    if (!std::isfinite(c.start_s) || blank(c.name))
      return usageError(
          "chapters",
          fmt::format("\"{}\" at {} s: a name and a finite time expected", c.name, c.start_s),
          "Leave out events that did not happen.");
  std::stable_sort(chapters.begin(), chapters.end(),
                   [](const Chapter& a, const Chapter& b) { return a.start_s < b.start_s; });

  struct Cue {
    long long start_ms;
    std::string text;
    bool early;  ///< began before the clip, so a later early one takes its place
  };
  const long long end_ms = std::max(1LL, std::llround(duration_s * 1000));
  std::vector<Cue> cues = {{0, cueText(opening), true}};
  for (const Chapter& c : chapters) {
    if (c.start_s >= duration_s) continue;
    const bool early = c.start_s < 0;
    const long long ms = early ? 0 : std::llround(c.start_s * 1000);
    if (ms >= end_ms) continue;
    if (ms != cues.back().start_ms)
      cues.push_back({ms, cueText(c.name), false});
    else if (cues.back().early)
      cues.back() = {ms, cueText(c.name), early};
    else
      cues.back().text += ", " + cueText(c.name);
  }
  std::string vtt = "WEBVTT\n";
  for (std::size_t i = 0; i < cues.size(); ++i)
    vtt +=
        fmt::format("\n{}\n{} --> {}\n{}\n", i + 1, timestamp(cues[i].start_ms),
                    timestamp(i + 1 < cues.size() ? cues[i + 1].start_ms : end_ms), cues[i].text);
  return vtt;
}

Result<void> writeVtt(const std::vector<Chapter>& chapters, double duration_s,
                      const std::filesystem::path& path, const std::string& opening) {
  Result<std::string> text = vttText(chapters, duration_s, opening);
  if (!text) {
    text.error().place = path.string();
    return std::unexpected(text.error());
  }
  return writeFile(path, *text);
}
}  // namespace swallowclip::video
