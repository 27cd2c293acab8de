// SPDX-License-Identifier: MIT
// Makes interlaced frames progressive: libavfilter's yadif, one picture per frame, which keeps
// still parts at full resolution. Private to this room.
#pragma once
#include "core/error.h"
#include "video/libav.h"

namespace swallowclip::video {

class Deinterlacer {
 public:
  /// For pictures of the size and format of `first`, times in `timeBase`.
  Result<void> open(const AVFrame& first, AVRational timeBase, const std::string& place);
  bool isOpen() const { return graph_ != nullptr; }
  /// One frame in, nullptr at the end. Frames that are progressive pass through.
  Result<void> push(AVFrame* frame);
  /// 0: a picture, its pts in the time base of open(); else AVERROR(EAGAIN), AVERROR_EOF, an error.
  int pull(AVFrame* frame);

 private:
  Owned<AVFilterGraph> graph_;
  AVFilterContext *in_ = nullptr, *out_ = nullptr;
  AVRational timeBase_{1, 1};
  std::string place_;
};
}  // namespace swallowclip::video
