#pragma once

#include <memory>
#include <string>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libswscale/swscale.h>
}

namespace orb360 {

/// Frees what FFmpeg's libraries have allocated. Their functions take the address of the pointer.
struct LibavDeleter {
  void operator()(AVFormatContext* format) const { avformat_close_input(&format); }
  void operator()(AVCodecContext* codec) const { avcodec_free_context(&codec); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};

/// Owns an object of FFmpeg's libraries.
template <typename T>
using LibavPtr = std::unique_ptr<T, LibavDeleter>;

/// Opens a media file and reads as much of it as tells the parameters of its streams. Returns null
/// if no demuxer of FFmpeg understands it.
LibavPtr<AVFormatContext> OpenFormat(const std::string& path);

/// Returns the number-th video stream of an opened file, counted from 0, or null. Cover images do
/// not count.
AVStream* FindVideoStream(AVFormatContext& format, int number);

/// Opens the decoder of a stream with that many threads, 0 for one for each core. Returns null if
/// FFmpeg has none. The decoder gives the same images for any number of threads.
LibavPtr<AVCodecContext> OpenDecoder(const AVStream& stream, int threads);

}  // namespace orb360
