// SPDX-License-Identifier: MIT
// Studies with known pixels and times, other programs to ask about them, and how pictures differ.
#pragma once
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/file.h"
#include "scratch.h"
#include "study/dicom_writer.h"
#include "study/study.h"

namespace swallowclip::study {

/// Smooth grey picture with a dark blob that moves by 2 pixels a frame; grey values tell frames
/// apart in every codec.
inline Image fluoroPicture(int width, int height, int frame) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double dx = x - 20 - 2 * frame, dy = y - height / 2.0;
      const double grey = 90 + 60 * std::sin(0.05 * x + 0.03 * y) + 2 * frame -
                          70 * std::exp(-(dx * dx + dy * dy) / 100);
      std::uint8_t* p = image.row(y) + 4 * x;
      p[0] = p[1] = p[2] =
          static_cast<std::uint8_t>(std::lround(std::min(255.0, std::max(0.0, grey))));
    }
  return image;
}

/// Mean and largest difference over the colour channels.
struct Difference {
  double mean = 0;
  int largest = 0;
};
inline Difference difference(const Image& a, const Image& b) {
  Difference d;
  if (a.rgba.size() != b.rgba.size()) return {1e9, 255};
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    const int step = std::abs(int(a.rgba[i]) - int(b.rgba[i]));
    d.mean += step / (0.75 * static_cast<double>(a.rgba.size()));
    d.largest = std::max(d.largest, step);
  }
  return d;
}

/// What a command prints, both streams.
inline std::string output(const std::string& command, int* status = nullptr) {
  std::string text;
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  for (int c; pipe && (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  const int result = pipe ? ::pclose(pipe) : -1;
  if (status) *status = result;
  return text;
}
inline bool hasProgram(const std::string& name) {
  return std::system(("command -v " + name + " >/dev/null 2>&1").c_str()) == 0;
}

/// A Python with pydicom, Pillow and numpy; empty when there is none.
inline std::string pythonWithPydicom() {
  for (const char* name : {"python3", "/usr/bin/python3"})
    if (std::system(fmt::format("{} -c 'import pydicom, PIL, numpy' 2>/dev/null", name).c_str()) ==
        0)
      return name;
  return "";
}

inline Result<void> writeDicom(const DicomDef& def, int frames) {
  auto sink = makeDicomSink(def);
  if (!sink) return std::unexpected(sink.error());
  for (int k = 0; k < frames; ++k)
    if (auto pushed = (*sink)->push(fluoroPicture(def.width, def.height, k)); !pushed)
      return pushed;
  return (*sink)->finish();
}

/// Through the ffmpeg program, which can write what our own sink refuses (rates below 30).
inline void writeVideo(const std::filesystem::path& path, int width, int height, int frames,
                       const std::string& rate, const std::string& options) {
  const std::filesystem::path raw = path.string() + ".raw";
  std::ofstream out(raw, std::ios::binary);
  for (int k = 0; k < frames; ++k) {
    const Image image = fluoroPicture(width, height, k);
    out.write(reinterpret_cast<const char*>(image.rgba.data()),
              static_cast<long>(image.rgba.size()));
  }
  out.close();
  int status = 0;
  const std::string said = output(
      fmt::format("ffmpeg -y -v error -f rawvideo -pix_fmt rgba -s {}x{} -r {} -i '{}' {} '{}'",
                  width, height, rate, raw.string(), options, path.string()),
      &status);
  EXPECT_EQ(status, 0) << said;
  std::filesystem::remove(raw);
}
}  // namespace swallowclip::study
