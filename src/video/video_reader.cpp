// SPDX-License-Identifier: MIT
#include "video/video_reader.h"

#include "video/libav.h"

namespace swallowclip::video {
namespace {
// Larger than any fluoroscopy or clip; assumed, range 4096 to 16384.
constexpr int kLongestSide = 8192;
constexpr int kHdRows = 720;  // untagged video from this height on is taken as BT.709
}  // namespace

struct VideoReader::State {
  std::string place;
  AVFormatContext* file = nullptr;
  int stream = -1;
  Owned<AVCodecContext> codec;
  Owned<AVPacket> packet{av_packet_alloc()};
  Owned<AVFrame> picture{av_frame_alloc()};
  SwsContext* converter = nullptr;
  VideoInfo info;
  bool flushing = false;
  int decoded = 0;

  ~State() {
    avformat_close_input(&file);
    sws_freeContext(converter);
  }
  std::unexpected<Error> refuse(const std::string& problem) const {
    return usageError(place, problem, "Name a whole video file (mp4, mov, avi, mkv, webm).");
  }
  Result<void> open();
  Result<Image> convert();
};

Result<void> VideoReader::State::open() {
  silenceLibav();
  int code = avformat_open_input(&file, ("file:" + place).c_str(), nullptr, nullptr);
  if (code < 0) return refuse(fmt::format("can't be opened as video ({})", libavText(code)));
  code = avformat_find_stream_info(file, nullptr);
  if (code < 0) return refuse(fmt::format("is damaged ({})", libavText(code)));
  const AVCodec* decoder = nullptr;
  stream = av_find_best_stream(file, AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0);
  if (stream < 0 || !decoder) return refuse("holds no video that can be decoded");
  const AVStream* s = file->streams[stream];
  codec.reset(avcodec_alloc_context3(decoder));
  if (!codec || !packet || !picture) return refuse("no memory to decode it");
  codec->thread_count = 1;
  codec->max_pixels = static_cast<std::int64_t>(kLongestSide) * kLongestSide;
  if (avcodec_parameters_to_context(codec.get(), s->codecpar) < 0 ||
      avcodec_open2(codec.get(), decoder, nullptr) < 0)
    return refuse("can't be decoded");
  info.width = codec->width;
  info.height = codec->height;
  if (info.width < 1 || info.height < 1 || info.width > kLongestSide || info.height > kLongestSide)
    return refuse(fmt::format("is {} x {} pixels, 1 to {} a side expected", info.width, info.height,
                              kLongestSide));
  if (s->avg_frame_rate.num > 0 && s->avg_frame_rate.den > 0) info.fps = av_q2d(s->avg_frame_rate);
  if (file->duration > 0) info.duration_s = static_cast<double>(file->duration) / AV_TIME_BASE;
  return {};
}

Result<Image> VideoReader::State::convert() {
  const AVFrame& p = *picture;
  if (p.width != info.width || p.height != info.height)
    return refuse(fmt::format("frame {} is {} x {}, {} x {} as before expected", decoded, p.width,
                              p.height, info.width, info.height));
  converter = sws_getCachedContext(converter, p.width, p.height,
                                   static_cast<AVPixelFormat>(p.format), p.width, p.height,
                                   AV_PIX_FMT_RGBA, kExactScaling, nullptr, nullptr, nullptr);
  if (!converter) return refuse("has a pixel format that can't be converted");
  const bool hd = p.height >= kHdRows;
  int matrix = static_cast<int>(p.colorspace);
  if (p.colorspace == AVCOL_SPC_UNSPECIFIED) matrix = hd ? SWS_CS_ITU709 : SWS_CS_ITU601;
  constexpr int kUnity = 1 << 16;  // 16.16 fixed point
  sws_setColorspaceDetails(converter, sws_getCoefficients(matrix),
                           p.color_range == AVCOL_RANGE_JPEG ? 1 : 0,
                           sws_getCoefficients(SWS_CS_ITU709), 1, 0, kUnity, kUnity);
  Image image(p.width, p.height);
  std::uint8_t* target[1] = {image.rgba.data()};
  const int stride[1] = {p.width * 4};
  if (sws_scale(converter, p.data, p.linesize, 0, p.height, target, stride) != p.height)
    return refuse(fmt::format("frame {} can't be converted", decoded));
  return image;
}

VideoReader::VideoReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
VideoReader::~VideoReader() = default;
const VideoInfo& VideoReader::info() const {
  return state_->info;
}

Result<std::unique_ptr<VideoReader>> VideoReader::open(const std::filesystem::path& path) {
  std::error_code ec;
  if (!std::filesystem::is_regular_file(path, ec))
    return usageError(path.string(), "no such file", "Check the name and the folder.");
  auto state = std::make_unique<State>();
  state->place = path.string();
  if (auto opened = state->open(); !opened) return std::unexpected(opened.error());
  return std::unique_ptr<VideoReader>(new VideoReader(std::move(state)));
}

Result<std::optional<VideoFrame>> VideoReader::next() {
  State& s = *state_;
  for (;;) {
    int code = avcodec_receive_frame(s.codec.get(), s.picture.get());
    if (code >= 0) {
      Result<Image> image = s.convert();
      if (!image) return std::unexpected(image.error());
      const std::int64_t stamp = s.picture->best_effort_timestamp;
      const double time_s =
          stamp == AV_NOPTS_VALUE
              ? (s.info.fps > 0 ? s.decoded / s.info.fps : 0)
              : static_cast<double>(stamp) * av_q2d(s.file->streams[s.stream]->time_base);
      ++s.decoded;
      return VideoFrame{std::move(*image), time_s, s.picture->key_frame != 0};
    }
    if (code == AVERROR_EOF) return std::optional<VideoFrame>();
    if (code != AVERROR(EAGAIN) || s.flushing)
      return s.refuse(fmt::format("frame {} is damaged ({})", s.decoded, libavText(code)));

    code = av_read_frame(s.file, s.packet.get());
    if (code == AVERROR_EOF) {
      s.flushing = true;
      code = avcodec_send_packet(s.codec.get(), nullptr);
    } else if (code >= 0) {
      if (s.packet->stream_index == s.stream)
        code = avcodec_send_packet(s.codec.get(), s.packet.get());
      av_packet_unref(s.packet.get());
    }
    if (code < 0)
      return s.refuse(fmt::format("is damaged after frame {} ({})", s.decoded, libavText(code)));
  }
}
}  // namespace swallowclip::video
