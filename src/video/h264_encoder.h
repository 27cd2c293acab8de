// SPDX-License-Identifier: MIT
// One H.264 clip written to one file, on the caller's thread. Private to this room.
#pragma once
#include "video/frame_sink.h"
#include "video/libav.h"

namespace swallowclip::video {

class H264Encoder {
 public:
  ~H264Encoder();
  /// Opens `file` (its extension is not looked at) and writes the header.
  Result<void> open(const Mp4Def& def, const std::filesystem::path& file);
  Result<void> encode(const Image& image);
  /// Flushes, writes the index in front, closes.
  Result<void> close();

 private:
  Result<void> openCodec(const Mp4Def& def);
  Result<void> openConverter(const Mp4Def& def);
  Result<void> openMuxer(const Mp4Def& def, const std::filesystem::path& file);
  Result<void> drain();
  std::unexpected<Error> fail(const std::string& doing, int code) const;

  std::string place_;
  Owned<AVCodecContext> codec_;
  Owned<AVFrame> picture_;
  Owned<AVPacket> packet_;
  Owned<SwsContext> converter_;
  AVFormatContext* muxer_ = nullptr;
  AVStream* stream_ = nullptr;
  std::int64_t frames_ = 0;
};
}  // namespace swallowclip::video
