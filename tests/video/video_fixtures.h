// SPDX-License-Identifier: MIT
// A folder that goes away, test pictures, and what ffprobe says.
#pragma once
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/image.h"
#include "scratch.h"
#include "video/frame_sink.h"

namespace swallowclip::video {

using test::Scratch;

/// A ramp with a square that moves to the right by 2 pixels a frame.
inline Image movingPicture(int width, int height, int frame) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      std::uint8_t* p = image.row(y) + 4 * x;
      const bool square = x >= 2 * frame && x < 2 * frame + 24 && y > 10 && y < 34;
      p[0] = square ? 220 : static_cast<std::uint8_t>(x * 255 / width);
      p[1] = square ? 60 : static_cast<std::uint8_t>(y * 255 / height);
      p[2] = square ? 40 : 90;
    }
  return image;
}

inline Image plainPicture(int width, int height, std::array<int, 3> rgb) {
  Image image(width, height);
  for (std::size_t i = 0; i < image.rgba.size(); ++i)
    if (i % 4 != 3) image.rgba[i] = static_cast<std::uint8_t>(rgb[i % 4]);
  return image;
}

inline void put(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<long>(bytes.size()));
}

inline std::string ffprobe(const std::string& entries, const std::filesystem::path& file) {
  const std::string command =
      fmt::format("ffprobe -v error -select_streams v:0 -show_entries {} -of compact '{}' 2>&1",
                  entries, file.string());
  std::string text;
  FILE* pipe = ::popen(command.c_str(), "r");
  for (int c; pipe && (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  if (pipe) ::pclose(pipe);
  return text;
}

/// Writes `frames` moving pictures; the result of the last step.
inline Result<void> writeClip(const Mp4Def& def, int frames) {
  auto sink = makeMp4Sink(def);
  if (!sink) return std::unexpected(sink.error());
  for (int f = 0; f < frames; ++f)
    if (auto pushed = (*sink)->push(movingPicture(def.width, def.height, f)); !pushed)
      return pushed;
  return (*sink)->finish();
}
}  // namespace swallowclip::video
