#include "slam/io/video/libav.h"

#include <algorithm>
#include <thread>

namespace orb360 {

LibavPtr<AVFormatContext> OpenFormat(const std::string& path) {
  AVFormatContext* opened = nullptr;
  // The prefix keeps names with a colon from being taken for addresses of a network.
  if (avformat_open_input(&opened, ("file:" + path).c_str(), nullptr, nullptr) < 0) return nullptr;
  LibavPtr<AVFormatContext> format(opened);
  if (avformat_find_stream_info(format.get(), nullptr) < 0) return nullptr;
  return format;
}

AVStream* FindVideoStream(AVFormatContext& format, int number) {
  for (unsigned i = 0; i < format.nb_streams; ++i) {
    AVStream* stream = format.streams[i];
    const bool is_video = stream->codecpar->codec_type == AVMEDIA_TYPE_VIDEO &&
                          (stream->disposition & AV_DISPOSITION_ATTACHED_PIC) == 0;
    if (is_video && number-- == 0) return stream;
  }
  return nullptr;
}

LibavPtr<AVCodecContext> OpenDecoder(const AVStream& stream, int threads) {
  // More pixels than any camera gives, 16384x16384, are a damaged header.
  constexpr int64_t kMaxPixels = int64_t{1} << 28;
  const AVCodec* codec = avcodec_find_decoder(stream.codecpar->codec_id);
  if (codec == nullptr) return nullptr;
  LibavPtr<AVCodecContext> decoder(avcodec_alloc_context3(codec));
  if (!decoder || avcodec_parameters_to_context(decoder.get(), stream.codecpar) < 0) return nullptr;
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  decoder->thread_count = threads > 0 ? threads : cores;
  decoder->pkt_timebase = stream.time_base;
  decoder->max_pixels = kMaxPixels;
  if (avcodec_open2(decoder.get(), codec, nullptr) < 0) return nullptr;
  return decoder;
}

}  // namespace orb360
