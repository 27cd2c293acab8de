// SPDX-License-Identifier: MIT
#include "video/deinterlacer.h"

namespace swallowclip::video {

Result<void> Deinterlacer::open(const AVFrame& first, AVRational timeBase,
                                const std::string& place) {
  place_ = place;
  timeBase_ = timeBase;
  graph_.reset(avfilter_graph_alloc());
  const std::string picture =
      fmt::format("video_size={}x{}:pix_fmt={}:time_base={}/{}:pixel_aspect=1/1", first.width,
                  first.height, static_cast<int>(first.format), timeBase.num, timeBase.den);
  int code = graph_ ? 0 : AVERROR(ENOMEM);
  if (code >= 0) {
    graph_->nb_threads = 1;
    code = avfilter_graph_create_filter(&in_, avfilter_get_by_name("buffer"), "in", picture.c_str(),
                                        nullptr, graph_.get());
  }
  AVFilterContext* yadif = nullptr;
  if (code >= 0)
    code = avfilter_graph_create_filter(&yadif, avfilter_get_by_name("yadif"), "yadif",
                                        "mode=send_frame:parity=auto:deint=interlaced", nullptr,
                                        graph_.get());
  if (code >= 0)
    code = avfilter_graph_create_filter(&out_, avfilter_get_by_name("buffersink"), "out", nullptr,
                                        nullptr, graph_.get());
  if (code >= 0) code = avfilter_link(in_, 0, yadif, 0);
  if (code >= 0) code = avfilter_link(yadif, 0, out_, 0);
  if (code >= 0) code = avfilter_graph_config(graph_.get(), nullptr);
  if (code < 0)
    return failure(place_, fmt::format("can't be deinterlaced ({})", libavText(code)),
                   "Convert it to progressive video with another program.");
  return {};
}

Result<void> Deinterlacer::push(AVFrame* frame) {
  if (const int code = av_buffersrc_add_frame_flags(in_, frame, AV_BUFFERSRC_FLAG_KEEP_REF);
      code < 0)
    return failure(place_, fmt::format("can't be deinterlaced ({})", libavText(code)),
                   "Convert it to progressive video with another program.");
  return {};
}

int Deinterlacer::pull(AVFrame* frame) {
  const int code = av_buffersink_get_frame(out_, frame);
  if (code >= 0 && frame->pts != AV_NOPTS_VALUE)  // yadif counts in halves
    frame->pts = av_rescale_q(frame->pts, av_buffersink_get_time_base(out_), timeBase_);
  return code;
}
}  // namespace swallowclip::video
