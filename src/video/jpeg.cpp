// SPDX-License-Identifier: MIT
#include "video/jpeg.h"

#include "video/libav.h"

namespace swallowclip::video {

Result<std::string> encodeJpeg(const Image& image, int quantiser) {
  silenceLibav();
  const auto fail = [](const char* doing, int code) {
    return failure("JPEG", fmt::format("{} ({})", doing, libavText(code)),
                   "Report it with the size of the picture.");
  };
  const AVCodec* encoder = avcodec_find_encoder(AV_CODEC_ID_MJPEG);
  Owned<AVCodecContext> codec(avcodec_alloc_context3(encoder));
  Owned<AVFrame> picture(av_frame_alloc());
  Owned<AVPacket> packet(av_packet_alloc());
  if (!encoder || !codec || !picture || !packet) return fail("no encoder", AVERROR(ENOMEM));
  codec->width = picture->width = image.width;
  codec->height = picture->height = image.height;
  codec->pix_fmt = AV_PIX_FMT_YUVJ422P;
  codec->time_base = {1, 30};
  codec->thread_count = 1;
  codec->flags |= AV_CODEC_FLAG_QSCALE | AV_CODEC_FLAG_BITEXACT;
  codec->global_quality = FF_QP2LAMBDA * quantiser;
  if (const int code = avcodec_open2(codec.get(), encoder, nullptr); code < 0)
    return fail("can't be opened", code);
  picture->format = codec->pix_fmt;
  picture->quality = codec->global_quality;
  if (const int code = av_frame_get_buffer(picture.get(), 0); code < 0)
    return fail("no memory", code);
  Owned<SwsContext> converter(sws_getContext(image.width, image.height, AV_PIX_FMT_RGBA,
                                             image.width, image.height, AV_PIX_FMT_YUV422P,
                                             kExactScaling, nullptr, nullptr, nullptr));
  if (!converter) return fail("can't be converted", AVERROR(EINVAL));
  constexpr int kUnity = 1 << 16;  // 16.16 fixed point
  sws_setColorspaceDetails(converter.get(), sws_getCoefficients(SWS_CS_ITU709), 1,
                           sws_getCoefficients(SWS_CS_ITU601), 1, 0, kUnity, kUnity);
  const std::uint8_t* from[1] = {image.rgba.data()};
  const int stride[1] = {image.width * 4};
  sws_scale(converter.get(), from, stride, 0, image.height, picture->data, picture->linesize);
  int code = avcodec_send_frame(codec.get(), picture.get());
  if (code >= 0) code = avcodec_receive_packet(codec.get(), packet.get());
  if (code < 0) return fail("can't be encoded", code);
  return std::string(reinterpret_cast<const char*>(packet->data),
                     static_cast<std::size_t>(packet->size));
}
}  // namespace swallowclip::video
