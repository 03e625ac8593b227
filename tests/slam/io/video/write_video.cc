#include "tests/slam/io/video/write_video.h"

#include <cstring>
#include <stdexcept>

#include "tests/slam/io/temp_folder.h"

namespace orb360 {
namespace {

void Require(bool is_good, const char* what) {
  if (!is_good) throw std::runtime_error(std::string("writing a video: ") + what);
}

LibavPtr<AVCodecContext> OpenEncoder(const TrackSpec& spec, bool wants_global_header) {
  const AVCodec* codec = avcodec_find_encoder_by_name(spec.encoder);
  Require(codec != nullptr, spec.encoder);
  LibavPtr<AVCodecContext> encoder(avcodec_alloc_context3(codec));
  encoder->width = spec.images[0].cols;
  encoder->height = spec.images[0].rows;
  encoder->pix_fmt = spec.format;
  encoder->time_base = {1, 1000};
  encoder->framerate = {25, 1};
  encoder->colorspace = spec.matrix;
  encoder->color_range = spec.range;
  encoder->color_trc = spec.transfer;
  encoder->sample_aspect_ratio = spec.sample_aspect;
  encoder->strict_std_compliance = FF_COMPLIANCE_UNOFFICIAL;
  encoder->thread_count = 1;
  encoder->flags |= AV_CODEC_FLAG_QSCALE;
  encoder->global_quality = 2 * FF_QP2LAMBDA;
  if (wants_global_header) encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  AVDictionary* options = nullptr;
  // Of a video with fewer frames than its B-frames need, x265 leaves times undefined.
  av_dict_set(&options, "x265-params", "log-level=none:crf=4:bframes=0", 0);
  av_dict_set(&options, "crf", "4", 0);
  av_dict_set(&options, "preset", "ultrafast", 0);
  const int result = avcodec_open2(encoder.get(), codec, &options);
  av_dict_free(&options);
  Require(result >= 0, "the encoder does not open");
  return encoder;
}

/// Copies side data to a stream.
void AddSideData(AVStream* stream, AVPacketSideDataType type, const void* data, size_t size) {
  std::uint8_t* copy = av_stream_new_side_data(stream, type, size);
  Require(copy != nullptr, "no side data");
  std::memcpy(copy, data, size);
}

/// Packets of one stream in the order of the encoder.
struct TrackWriter {
  LibavPtr<AVCodecContext> encoder;
  AVStream* stream = nullptr;

  void Encode(const AVFrame* frame, AVFormatContext* format) const {
    Require(avcodec_send_frame(encoder.get(), frame) >= 0, "a frame is not taken");
    const LibavPtr<AVPacket> packet(av_packet_alloc());
    while (avcodec_receive_packet(encoder.get(), packet.get()) >= 0) {
      av_packet_rescale_ts(packet.get(), encoder->time_base, stream->time_base);
      if (packet->duration == 0) packet->duration = av_rescale_q(40, {1, 1000}, stream->time_base);
      packet->stream_index = stream->index;
      Require(av_interleaved_write_frame(format, packet.get()) >= 0, "a packet is not written");
    }
  }
};

LibavPtr<AVFrame> ToFrame(const cv::Mat& image, const TrackSpec& spec, std::int64_t time) {
  LibavPtr<AVFrame> frame(av_frame_alloc());
  frame->width = image.cols;
  frame->height = image.rows;
  frame->format = spec.format;
  frame->pts = time;
  Require(av_frame_get_buffer(frame.get(), 0) >= 0, "no memory");
  const AVPixelFormat source = image.depth() == CV_16U ? AV_PIX_FMT_BGR48LE : AV_PIX_FMT_BGR24;
  const LibavPtr<SwsContext> scaler(
      sws_getContext(image.cols, image.rows, source, image.cols, image.rows, spec.format,
                     SWS_BICUBIC | SWS_ACCURATE_RND, nullptr, nullptr, nullptr));
  Require(scaler != nullptr, "no conversion");
  const int matrix = spec.matrix == AVCOL_SPC_BT709        ? SWS_CS_ITU709
                     : spec.matrix == AVCOL_SPC_BT2020_NCL ? SWS_CS_BT2020
                                                           : SWS_CS_ITU601;
  sws_setColorspaceDetails(scaler.get(), sws_getCoefficients(SWS_CS_DEFAULT), 1,
                           sws_getCoefficients(matrix), spec.range == AVCOL_RANGE_JPEG ? 1 : 0, 0,
                           1 << 16, 1 << 16);
  const std::uint8_t* const planes[] = {image.data};
  const int strides[] = {static_cast<int>(image.step)};
  sws_scale(scaler.get(), planes, strides, 0, image.rows, frame->data, frame->linesize);
  return frame;
}

std::uint32_t ReadSize(const std::string& bytes, size_t at) {
  std::uint32_t size = 0;
  for (size_t i = 0; i < 4; ++i) size = size << 8 | static_cast<unsigned char>(bytes[at + i]);
  return size;
}

void WriteSize(std::string* bytes, size_t at, std::uint32_t size) {
  for (size_t i = 0; i < 4; ++i) (*bytes)[at + i] = static_cast<char>(size >> (24 - 8 * i));
}

}  // namespace

bool HasEncoder(const char* name) { return avcodec_find_encoder_by_name(name) != nullptr; }

void WriteVideoFile(const std::filesystem::path& path, const std::vector<TrackSpec>& tracks) {
  AVFormatContext* opened = nullptr;
  avformat_alloc_output_context2(&opened, nullptr, nullptr, path.c_str());
  Require(opened != nullptr, "an unknown format");
  const std::unique_ptr<AVFormatContext, decltype(&avformat_free_context)> format(
      opened, &avformat_free_context);
  format->strict_std_compliance = FF_COMPLIANCE_UNOFFICIAL;
  std::vector<TrackWriter> writers;
  for (const TrackSpec& spec : tracks) {
    TrackWriter writer;
    writer.encoder = OpenEncoder(spec, (format->oformat->flags & AVFMT_GLOBALHEADER) != 0);
    writer.stream = avformat_new_stream(format.get(), nullptr);
    writer.stream->time_base = writer.encoder->time_base;
    writer.stream->sample_aspect_ratio = spec.sample_aspect;
    avcodec_parameters_from_context(writer.stream->codecpar, writer.encoder.get());
    if (spec.display_matrix) {
      AddSideData(writer.stream, AV_PKT_DATA_DISPLAYMATRIX, spec.display_matrix->data(), 36);
    }
    if (spec.spherical) {
      AddSideData(writer.stream, AV_PKT_DATA_SPHERICAL, &*spec.spherical, sizeof *spec.spherical);
    }
    if (spec.stereo) {
      AddSideData(writer.stream, AV_PKT_DATA_STEREO3D, &*spec.stereo, sizeof *spec.stereo);
    }
    writers.push_back(std::move(writer));
  }
  Require(avio_open(&format->pb, path.c_str(), AVIO_FLAG_WRITE) >= 0, "the file does not open");
  Require(avformat_write_header(format.get(), nullptr) >= 0, "no header");
  size_t count = 0;
  for (const TrackSpec& spec : tracks) count = std::max(count, spec.images.size());
  for (size_t i = 0; i < count; ++i) {
    for (size_t track = 0; track < tracks.size(); ++track) {
      const TrackSpec& spec = tracks[track];
      if (i >= spec.images.size()) continue;
      const std::int64_t time =
          spec.times.empty() ? static_cast<std::int64_t>(40 * i) : spec.times[i];
      writers[track].Encode(ToFrame(spec.images[i], spec, time).get(), format.get());
    }
  }
  for (const TrackWriter& writer : writers) writer.Encode(nullptr, format.get());
  Require(av_write_trailer(format.get()) >= 0, "no trailer");
  avio_closep(&format->pb);
}

void InsertGSphericalXml(const std::filesystem::path& path, const std::string& xml) {
  std::string bytes = ReadText(path);
  const size_t movie = bytes.rfind("moov") - 4;
  const size_t track = bytes.find("trak", movie) - 4;
  std::string box(4, '\0');
  box += "uuid";
  box += std::string("\xff\xcc\x82\x63\xf8\x55\x4a\x93\x88\x14\x58\x7a\x02\x52\x1f\xdd", 16) + xml;
  WriteSize(&box, 0, static_cast<std::uint32_t>(box.size()));
  const auto added = static_cast<std::uint32_t>(box.size());
  bytes.insert(track + ReadSize(bytes, track), box);
  WriteSize(&bytes, track, ReadSize(bytes, track) + added);
  WriteSize(&bytes, movie, ReadSize(bytes, movie) + added);
  WriteText(path, bytes);
}

}  // namespace orb360
