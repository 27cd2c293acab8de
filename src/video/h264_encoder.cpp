// SPDX-License-Identifier: MIT
// libav 5.1: the muxer is named ("mp4"), since the aside name may say anything; faststart opens
// the file a second time by its path, so it must be a real file.
#include "video/h264_encoder.h"

namespace swallowclip::video {

H264Encoder::~H264Encoder() {
  if (!muxer_) return;
  if (muxer_->pb) avio_closep(&muxer_->pb);
  avformat_free_context(muxer_);
}

std::unexpected<Error> H264Encoder::fail(const std::string& doing, int code) const {
  return failure(place_, fmt::format("{} ({})", doing, libavText(code)),
                 code == AVERROR(ENOSPC) || code == AVERROR(EFBIG)
                     ? "Free space or choose another folder with --out."
                     : "Check that the folder exists and is writable.");
}

Result<void> H264Encoder::open(const Mp4Def& def, const std::filesystem::path& file) {
  silenceLibav();
  place_ = def.path.string();
  packet_.reset(av_packet_alloc());
  if (!packet_) return fail("no memory for a packet", AVERROR(ENOMEM));
  if (auto done = openCodec(def); !done) return done;
  if (auto done = openConverter(def); !done) return done;
  return openMuxer(def, file);
}

Result<void> H264Encoder::openCodec(const Mp4Def& def) {
  const AVCodec* h264 = avcodec_find_encoder_by_name("libx264");
  if (!h264)
    return failure(place_, "this libav has no libx264 encoder",
                   "Install the distribution's own libavcodec (Debian: libavcodec59).");
  codec_.reset(avcodec_alloc_context3(h264));
  AVCodecContext* c = codec_.get();
  if (!c) return fail("no memory for the encoder", AVERROR(ENOMEM));
  c->width = def.width;
  c->height = def.height;
  c->pix_fmt = AV_PIX_FMT_YUV420P;
  c->time_base = {def.rateDenominator, def.rateNumerator};
  c->framerate = {def.rateNumerator, def.rateDenominator};
  c->sample_aspect_ratio = {1, 1};
  c->gop_size = def.keyframeEvery;
  c->thread_count = 1;  // x264's pixels depend on the number of threads
  c->flags |= AV_CODEC_FLAG_GLOBAL_HEADER | AV_CODEC_FLAG_BITEXACT;
  c->color_range = AVCOL_RANGE_MPEG;
  c->colorspace = AVCOL_SPC_BT709;
  c->color_primaries = AVCOL_PRI_BT709;
  c->color_trc = AVCOL_TRC_BT709;
  c->chroma_sample_location = AVCHROMA_LOC_LEFT;

  // scenecut off and min-keyint = keyint: a keyframe exactly every keyframeEvery frames.
  // cpu-independent: SSE2 and AVX2 machines give the same pixels.
  const std::string x264 =
      fmt::format("threads=1:cpu-independent=1:keyint={0}:min-keyint={0}:scenecut=0:open-gop=0",
                  def.keyframeEvery);
  av_opt_set(c->priv_data, "preset", def.preset.c_str(), 0);
  av_opt_set(c->priv_data, "profile", "high", 0);
  av_opt_set(c->priv_data, "crf", std::to_string(def.crf).c_str(), 0);
  av_opt_set(c->priv_data, "x264-params", x264.c_str(), 0);
  if (const int code = avcodec_open2(c, h264, nullptr); code < 0)
    return fail(
        fmt::format("x264 refuses {} x {} at preset \"{}\"", def.width, def.height, def.preset),
        code);
  return {};
}

Result<void> H264Encoder::openConverter(const Mp4Def& def) {
  picture_.reset(av_frame_alloc());
  if (!picture_) return fail("no memory for a picture", AVERROR(ENOMEM));
  picture_->format = AV_PIX_FMT_YUV420P;
  picture_->width = def.width;
  picture_->height = def.height;
  picture_->color_range = AVCOL_RANGE_MPEG;
  picture_->colorspace = AVCOL_SPC_BT709;
  picture_->color_primaries = AVCOL_PRI_BT709;
  picture_->color_trc = AVCOL_TRC_BT709;
  picture_->chroma_location = AVCHROMA_LOC_LEFT;
  if (const int code = av_frame_get_buffer(picture_.get(), 0); code < 0)
    return fail("no memory for a picture", code);

  converter_.reset(sws_alloc_context());
  SwsContext* s = converter_.get();
  if (!s) return fail("no memory for the colour conversion", AVERROR(ENOMEM));
  for (const auto& [key, value] :
       {std::pair{"srcw", def.width},
        {"srch", def.height},
        {"dstw", def.width},
        {"dsth", def.height},
        {"src_format", static_cast<int>(AV_PIX_FMT_RGB0)},
        {"dst_format", static_cast<int>(AV_PIX_FMT_YUV420P)},
        {"sws_flags", kExactScaling},
        // Chroma samples lie left (0) and midway between rows (128 of 256), as tagged above.
        {"dst_h_chr_pos", 0},
        {"dst_v_chr_pos", 128}})
    av_opt_set_int(s, key, value, 0);
  if (const int code = sws_init_context(s, nullptr, nullptr); code < 0)
    return fail("no colour conversion", code);
  constexpr int kFullRange = 1, kVideoRange = 0, kUnity = 1 << 16;  // 16.16 fixed point
  const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
  if (const int code =
          sws_setColorspaceDetails(s, bt709, kFullRange, bt709, kVideoRange, 0, kUnity, kUnity);
      code < 0)
    return fail("no BT.709 conversion", code);
  return {};
}

Result<void> H264Encoder::openMuxer(const Mp4Def& def, const std::filesystem::path& file) {
  int code = avformat_alloc_output_context2(&muxer_, nullptr, "mp4", file.c_str());
  if (code < 0) return fail("no mp4 writer", code);
  muxer_->flags |= AVFMT_FLAG_BITEXACT;  // no times, no version words
  stream_ = avformat_new_stream(muxer_, nullptr);
  if (!stream_) return fail("no memory for the stream", AVERROR(ENOMEM));
  code = avcodec_parameters_from_context(stream_->codecpar, codec_.get());
  if (code < 0) return fail("no stream settings", code);
  stream_->time_base = codec_->time_base;
  stream_->avg_frame_rate = stream_->r_frame_rate = codec_->framerate;
  stream_->sample_aspect_ratio = codec_->sample_aspect_ratio;
  code = avio_open(&muxer_->pb, file.c_str(), AVIO_FLAG_WRITE);
  if (code < 0) return fail("can't be created", code);
  AVDictionary* options = nullptr;
  av_dict_set(&options, "movflags", "+faststart", 0);
  // A time scale that holds whole frames: 1/512 of a frame at least, and within 32 bits.
  av_dict_set_int(&options, "video_track_timescale", def.rateNumerator * 512LL, 0);
  code = avformat_write_header(muxer_, &options);
  av_dict_free(&options);
  if (code < 0) return fail("the header can't be written", code);
  return {};
}

Result<void> H264Encoder::encode(const Image& image) {
  if (const int code = av_frame_make_writable(picture_.get()); code < 0)
    return fail("no memory for a picture", code);
  const std::uint8_t* source[1] = {image.rgba.data()};
  const int stride[1] = {image.width * 4};
  sws_scale(converter_.get(), source, stride, 0, image.height, picture_->data, picture_->linesize);
  picture_->pts = frames_++;
  picture_->pict_type = AV_PICTURE_TYPE_NONE;
  if (const int code = avcodec_send_frame(codec_.get(), picture_.get()); code < 0)
    return fail(fmt::format("frame {} can't be encoded", frames_ - 1), code);
  return drain();
}

Result<void> H264Encoder::drain() {
  for (;;) {
    int code = avcodec_receive_packet(codec_.get(), packet_.get());
    if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return {};
    if (code < 0) return fail("a frame can't be encoded", code);
    packet_->duration = 1;
    packet_->stream_index = stream_->index;
    av_packet_rescale_ts(packet_.get(), codec_->time_base, stream_->time_base);
    code = av_interleaved_write_frame(muxer_, packet_.get());
    if (code >= 0) code = muxer_->pb->error;
    if (code < 0) return fail("can't be written", code);
  }
}

Result<void> H264Encoder::close() {
  if (const int code = avcodec_send_frame(codec_.get(), nullptr); code < 0)
    return fail("the last frames can't be encoded", code);
  if (auto done = drain(); !done) return done;
  int code = av_write_trailer(muxer_);
  if (code >= 0 && muxer_->pb) code = muxer_->pb->error;
  const int closed = avio_closep(&muxer_->pb);
  if (code >= 0) code = closed;
  if (code < 0) return fail("the clip can't be completed", code);
  return {};
}
}  // namespace swallowclip::video
