// SPDX-License-Identifier: MIT
#include "video/video_reader.h"

#include <cmath>
#include <cstring>

#include "video/deinterlacer.h"
#include "video/libav.h"

namespace swallowclip::video {
namespace {
// Larger than any fluoroscopy or clip; assumed, range 4096 to 16384.
constexpr int kLongestSide = 8192;
constexpr int kHdRows = 720;          // untagged video from this height on is taken as BT.709
constexpr double kMostStretched = 4;  // pixel aspect; assumed, range 3 (anamorphic film 2) to 10
// A playlist would make libav open other files or addresses, so containers only; "file" and our
// own memory are the only protocols. h264 and mpegts are what DICOM encapsulates.
constexpr const char* kContainers = "mov,avi,matroska,asf,mpeg,mpegts,h264,mjpeg";
constexpr int kMemoryBlock = 1 << 16;  // bytes handed to libav at a time

struct Memory {
  std::string bytes;
  std::size_t at = 0;

  static int read(void* opaque, std::uint8_t* into, int size) {
    auto& m = *static_cast<Memory*>(opaque);
    const std::size_t n = std::min<std::size_t>(size, m.bytes.size() - m.at);
    if (n == 0) return AVERROR_EOF;
    std::memcpy(into, m.bytes.data() + m.at, n);
    m.at += n;
    return static_cast<int>(n);
  }
  static std::int64_t seek(void* opaque, std::int64_t offset, int whence) {
    auto& m = *static_cast<Memory*>(opaque);
    const auto size = static_cast<std::int64_t>(m.bytes.size());
    if (whence & AVSEEK_SIZE) return size;
    const std::int64_t base = whence == SEEK_CUR   ? static_cast<std::int64_t>(m.at)
                              : whence == SEEK_END ? size
                                                   : 0;
    if (offset < -base || offset > size - base) return AVERROR(EINVAL);
    m.at = static_cast<std::size_t>(base + offset);
    return base + offset;
  }
};

Image turned(const Image& from, int quarterTurns) {
  if (quarterTurns == 0) return from;
  const bool swaps = quarterTurns % 2 == 1;
  Image to(swaps ? from.height : from.width, swaps ? from.width : from.height);
  for (int y = 0; y < to.height; ++y)
    for (int x = 0; x < to.width; ++x) {
      const int sx = quarterTurns == 1   ? y
                     : quarterTurns == 2 ? from.width - 1 - x
                                         : from.width - 1 - y;
      const int sy = quarterTurns == 1   ? from.height - 1 - x
                     : quarterTurns == 2 ? from.height - 1 - y
                                         : x;
      std::memcpy(to.row(y) + 4 * x, from.row(sy) + 4 * sx, 4);
    }
  return to;
}
}  // namespace

struct VideoReader::State {
  std::string place;
  Memory memory;
  AVFormatContext* file = nullptr;
  AVIOContext* io = nullptr;  ///< ours when reading from memory
  int stream = -1;
  Owned<AVCodecContext> codec;
  Owned<AVPacket> packet{av_packet_alloc()};
  Owned<AVFrame> picture{av_frame_alloc()};
  SwsContext* converter = nullptr;
  Deinterlacer deinterlacer;
  VideoInfo info;
  int codedWidth = 0, codedHeight = 0, width = 0, height = 0;  ///< width, height: before turning
  bool flushing = false;
  int decoded = 0, format = -1;

  ~State() {
    avformat_close_input(&file);
    if (io) {
      av_freep(&io->buffer);
      avio_context_free(&io);
    }
    sws_freeContext(converter);
  }
  std::unexpected<Error> refuse(const std::string& problem) const {
    return usageError(place, problem, "Name a whole video file (mp4, mov, avi, mkv, webm).");
  }
  Result<void> openContainer(const std::filesystem::path& path);
  Result<void> open(const std::filesystem::path& path);
  Result<void> layOut(AVStream* s);
  Result<void> unchanged();
  Result<Image> convert();
  Result<bool> receive();  ///< a picture is ready; false at the end
  Result<void> feed();
};

Result<void> VideoReader::State::openContainer(const std::filesystem::path& path) {
  silenceLibav();
  file = avformat_alloc_context();
  if (!file) return refuse("no memory to open it");
  if (!memory.bytes.empty()) {
    auto* block = static_cast<std::uint8_t*>(av_malloc(kMemoryBlock));
    io = avio_alloc_context(block, kMemoryBlock, 0, &memory, Memory::read, nullptr, Memory::seek);
    if (!io) return refuse("no memory to open it");
    file->pb = io;
  }
  AVDictionary* options = nullptr;
  av_dict_set(&options, "protocol_whitelist", "file", 0);
  av_dict_set(&options, "format_whitelist", kContainers, 0);
  const int code = avformat_open_input(&file, io ? nullptr : ("file:" + path.string()).c_str(),
                                       nullptr, &options);
  av_dict_free(&options);
  if (code < 0) return refuse(fmt::format("can't be opened as video ({})", libavText(code)));
  return {};
}

/// Size of the pictures handed out, from pixel aspect and rotation.
Result<void> VideoReader::State::layOut(AVStream* s) {
  codedWidth = width = codec->width;
  codedHeight = height = codec->height;
  const auto fits = [](int side) { return side >= 1 && side <= kLongestSide; };
  if (!fits(width) || !fits(height))
    return refuse(
        fmt::format("is {} x {} pixels, 1 to {} a side expected", width, height, kLongestSide));
  const AVRational aspect = av_guess_sample_aspect_ratio(file, s, nullptr);
  if (aspect.num > 0 && aspect.den > 0 && aspect.num != aspect.den) {
    const double ratio = av_q2d(aspect);
    if (ratio > kMostStretched || ratio < 1 / kMostStretched)
      return refuse(fmt::format("pixel aspect {:.3g}, 1/{} to {} expected", ratio, kMostStretched,
                                kMostStretched));
    // enlarge only: no detail is lost
    if (ratio > 1) width = static_cast<int>(std::lround(width * ratio));
    if (ratio < 1) height = static_cast<int>(std::lround(height / ratio));
    if (!fits(width) || !fits(height))
      return refuse(fmt::format("with square pixels is {} x {}", width, height));
    info.stretched = true;
  }
  const std::uint8_t* matrix = av_stream_get_side_data(s, AV_PKT_DATA_DISPLAYMATRIX, nullptr);
  if (matrix) {
    const double degrees = av_display_rotation_get(reinterpret_cast<const std::int32_t*>(matrix));
    const double turns = -degrees / 90;  // libav counts anticlockwise
    if (!std::isfinite(degrees) || std::abs(turns - std::round(turns)) > 0.01)
      return refuse(
          fmt::format("asks to be turned by {:.1f} degrees, a quarter turn expected", degrees));
    info.quarterTurns = (static_cast<int>(std::lround(turns)) % 4 + 4) % 4;
  }
  const bool swaps = info.quarterTurns % 2 == 1;
  info.width = swaps ? height : width;
  info.height = swaps ? width : height;
  return {};
}

Result<void> VideoReader::State::open(const std::filesystem::path& path) {
  if (auto opened = openContainer(path); !opened) return opened;
  int code = avformat_find_stream_info(file, nullptr);
  if (code < 0) return refuse(fmt::format("is damaged ({})", libavText(code)));
  const AVCodec* decoder = nullptr;
  stream = av_find_best_stream(file, AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0);
  if (stream < 0 || !decoder) return refuse("holds no video that can be decoded");
  AVStream* s = file->streams[stream];
  codec.reset(avcodec_alloc_context3(decoder));
  if (!codec || !packet || !picture) return refuse("no memory to decode it");
  codec->thread_count = 1;
  codec->max_pixels = static_cast<std::int64_t>(kLongestSide) * kLongestSide;
  if (avcodec_parameters_to_context(codec.get(), s->codecpar) < 0 ||
      avcodec_open2(codec.get(), decoder, nullptr) < 0)
    return refuse("can't be decoded");
  if (s->avg_frame_rate.num > 0 && s->avg_frame_rate.den > 0) info.fps = av_q2d(s->avg_frame_rate);
  if (file->duration > 0 && file->duration_estimation_method != AVFMT_DURATION_FROM_BITRATE)
    info.duration_s = static_cast<double>(file->duration) / AV_TIME_BASE;
  info.frames = std::max<std::int64_t>(0, s->nb_frames);
  return layOut(s);
}

/// Neither the deinterlacer nor the converter may meet another kind of picture.
Result<void> VideoReader::State::unchanged() {
  const AVFrame& p = *picture;
  if (p.width != codedWidth || p.height != codedHeight)
    return refuse(fmt::format("frame {} is {} x {}, {} x {} as before expected", decoded, p.width,
                              p.height, codedWidth, codedHeight));
  if (format < 0) format = p.format;
  if (p.format != format)
    return refuse(fmt::format("frame {} has another pixel format than those before", decoded));
  return {};
}

Result<Image> VideoReader::State::convert() {
  const AVFrame& p = *picture;
  converter = sws_getCachedContext(converter, p.width, p.height,
                                   static_cast<AVPixelFormat>(p.format), width, height,
                                   AV_PIX_FMT_RGBA, kExactScaling, nullptr, nullptr, nullptr);
  if (!converter) return refuse("has a pixel format that can't be converted");
  const bool hd = p.height >= kHdRows;
  int matrix = static_cast<int>(p.colorspace);
  if (p.colorspace == AVCOL_SPC_UNSPECIFIED) matrix = hd ? SWS_CS_ITU709 : SWS_CS_ITU601;
  constexpr int kUnity = 1 << 16;  // 16.16 fixed point
  sws_setColorspaceDetails(converter, sws_getCoefficients(matrix),
                           p.color_range == AVCOL_RANGE_JPEG ? 1 : 0,
                           sws_getCoefficients(SWS_CS_ITU709), 1, 0, kUnity, kUnity);
  Image image(width, height);
  std::uint8_t* target[1] = {image.rgba.data()};
  const int stride[1] = {width * 4};
  if (sws_scale(converter, p.data, p.linesize, 0, p.height, target, stride) != height)
    return refuse(fmt::format("frame {} can't be converted", decoded));
  return turned(image, info.quarterTurns);
}

VideoReader::VideoReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
VideoReader::~VideoReader() = default;
const VideoInfo& VideoReader::info() const {
  return state_->info;
}

Result<std::unique_ptr<VideoReader>> VideoReader::open(VideoSource source) {
  auto state = std::make_unique<State>();
  state->place = source.label.empty() ? source.path.string() : source.label;
  state->memory.bytes = std::move(source.bytes);
  std::error_code ec;
  if (state->memory.bytes.empty() && !std::filesystem::is_regular_file(source.path, ec))
    return usageError(state->place, "no such file", "Check the name and the folder.");
  if (auto opened = state->open(source.path); !opened) return std::unexpected(opened.error());
  return std::unique_ptr<VideoReader>(new VideoReader(std::move(state)));
}

Result<void> VideoReader::State::feed() {
  int code = av_read_frame(file, packet.get());
  if (code == AVERROR_EOF) {
    flushing = true;
    code = avcodec_send_packet(codec.get(), nullptr);
  } else if (code >= 0) {
    const AVPacket& p = *packet;
    const std::int64_t begin = p.pts != AV_NOPTS_VALUE ? p.pts : p.dts;
    if (begin != AV_NOPTS_VALUE)
      info.read_s =
          std::max(info.read_s, av_q2d(file->streams[p.stream_index]->time_base) *
                                    (static_cast<double>(begin) + static_cast<double>(p.duration)));
    if (packet->stream_index == stream) code = avcodec_send_packet(codec.get(), packet.get());
    av_packet_unref(packet.get());
  }
  if (code < 0)
    return refuse(fmt::format("is damaged after frame {} ({})", decoded, libavText(code)));
  return {};
}

Result<bool> VideoReader::State::receive() {
  for (;;) {
    if (deinterlacer.isOpen()) {
      const int code = deinterlacer.pull(picture.get());
      if (code >= 0) return true;
      if (code == AVERROR_EOF) return false;
      if (code != AVERROR(EAGAIN))
        return refuse(fmt::format("frame {} is damaged ({})", decoded, libavText(code)));
    }
    const int code = avcodec_receive_frame(codec.get(), picture.get());
    if (code == AVERROR_EOF) {
      if (!deinterlacer.isOpen()) return false;
      if (auto ended = deinterlacer.push(nullptr); !ended) return std::unexpected(ended.error());
      continue;
    }
    if (code == AVERROR(EAGAIN) && !flushing) {
      if (auto fed = feed(); !fed) return std::unexpected(fed.error());
      continue;
    }
    if (code < 0) return refuse(fmt::format("frame {} is damaged ({})", decoded, libavText(code)));
    if (auto same = unchanged(); !same) return std::unexpected(same.error());
    picture->pts = picture->best_effort_timestamp;
    if (picture->interlaced_frame && !deinterlacer.isOpen()) {
      info.interlaced = true;
      auto opened = deinterlacer.open(*picture, file->streams[stream]->time_base, place);
      if (!opened) return std::unexpected(opened.error());
    }
    if (!deinterlacer.isOpen()) return true;
    if (auto pushed = deinterlacer.push(picture.get()); !pushed)
      return std::unexpected(pushed.error());
    av_frame_unref(picture.get());
  }
}

Result<std::optional<VideoFrame>> VideoReader::next() {
  State& s = *state_;
  auto ready = s.receive();
  if (!ready) return std::unexpected(ready.error());
  if (!*ready) return std::optional<VideoFrame>();
  Result<Image> image = s.convert();
  if (!image) return std::unexpected(image.error());
  VideoFrame frame;
  frame.image = std::move(*image);
  frame.timed = s.picture->pts != AV_NOPTS_VALUE;
  if (frame.timed)
    frame.time_s =
        static_cast<double>(s.picture->pts) * av_q2d(s.file->streams[s.stream]->time_base);
  else if (s.info.fps > 0)
    frame.time_s = s.decoded / s.info.fps;
  frame.keyframe = s.picture->key_frame != 0;
  ++s.decoded;
  return frame;
}
}  // namespace swallowclip::video
