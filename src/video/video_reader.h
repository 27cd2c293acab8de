// SPDX-License-Identifier: MIT
// Any video that libav reads, as pictures with their own times, in display order.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/error.h"
#include "core/image.h"

namespace swallowclip::video {

struct VideoFrame {
  Image image;
  double time_s = 0;   ///< from the file, first frame as the file says
  bool timed = false;  ///< the file gives this frame a time of its own
  bool keyframe = false;
};

struct VideoInfo {
  int width = 0, height = 0;  ///< of the pictures handed out: upright, square pixels
  double fps = 0;             ///< average rate; 0 when the file does not say
  double duration_s = 0;      ///< 0 when the file does not say
  double read_s = 0;          ///< where the pictures and sounds end that were read so far
  std::int64_t frames = 0;    ///< as the container counts them; 0 when it does not say
  bool interlaced = false;    ///< frames so far were made progressive
  bool stretched = false;     ///< pixels were not square
  int quarterTurns = 0;       ///< clockwise, as the file asks for
};

/// What to read: a file, or the bytes of one.
struct VideoSource {
  std::filesystem::path path;
  std::string bytes;  ///< used instead of `path` when not empty
  std::string label;  ///< name in messages; empty: the path. A path may name a patient.
};

/// Reads one file from its start to its end. Colours are converted by the matrix and range that
/// the file is tagged with (untagged: BT.709 from 720 rows on, else BT.601). Rotation and pixel
/// aspect are applied; interlaced frames are made progressive (yadif, one picture per frame).
class VideoReader {
 public:
  static Result<std::unique_ptr<VideoReader>> open(const std::filesystem::path& path) {
    return open(VideoSource{path, {}, {}});
  }
  static Result<std::unique_ptr<VideoReader>> open(VideoSource source);
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
