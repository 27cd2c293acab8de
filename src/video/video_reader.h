// SPDX-License-Identifier: MIT
// Any video that libav reads, as pictures with their own times, in display order.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>

#include "core/error.h"
#include "core/image.h"

namespace swallowclip::video {

struct VideoFrame {
  Image image;
  double time_s = 0;  ///< from the file, first frame as the file says
  bool keyframe = false;
};

struct VideoInfo {
  int width = 0, height = 0;
  double fps = 0;         ///< average rate; 0 when the file does not say
  double duration_s = 0;  ///< 0 when the file does not say
};

/// Reads one file from its start to its end. Colours are converted by the matrix and range that
/// the file is tagged with (untagged: BT.709 from 720 rows on, else BT.601).
class VideoReader {
 public:
  static Result<std::unique_ptr<VideoReader>> open(const std::filesystem::path& path);
  ~VideoReader();
  const VideoInfo& info() const;
  /// The next picture, nothing at the end.
  Result<std::optional<VideoFrame>> next();

 private:
  struct State;
  explicit VideoReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};
}  // namespace swallowclip::video
