// SPDX-License-Identifier: MIT
// Owners of libav's objects and its error words, private to this room.
#pragma once
extern "C" {
#include <libavcodec/avcodec.h>
#include <libavfilter/avfilter.h>
#include <libavfilter/buffersink.h>
#include <libavfilter/buffersrc.h>
#include <libavformat/avformat.h>
#include <libavutil/display.h>
#include <libavutil/imgutils.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <memory>
#include <string>

namespace swallowclip::video {

inline std::string libavText(int code) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(code, text, sizeof text);
  return text;
}

struct LibavDelete {
  void operator()(AVCodecContext* c) const { avcodec_free_context(&c); }
  void operator()(AVFrame* f) const { av_frame_free(&f); }
  void operator()(AVPacket* p) const { av_packet_free(&p); }
  void operator()(SwsContext* s) const { sws_freeContext(s); }
  void operator()(AVFilterGraph* g) const { avfilter_graph_free(&g); }
};
template <class T>
using Owned = std::unique_ptr<T, LibavDelete>;

// Scaling flags that give the same pixels on every run (ecosystem note, section 2).
inline constexpr int kExactScaling =
    SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT | SWS_BITEXACT;

/// libav would print to stderr by itself; what went wrong is in our Result.
inline void silenceLibav() {
  av_log_set_level(AV_LOG_QUIET);
}
}  // namespace swallowclip::video
