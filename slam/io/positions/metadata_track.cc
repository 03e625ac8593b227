#include "slam/io/positions/metadata_track.h"

#include <system_error>

#include "slam/io/positions/utc_time.h"
#include "slam/io/video/libav.h"
#include <orb360/nn/base/check.h>

extern "C" {
#include <libavutil/log.h>
}

namespace orb360 {
namespace {

/// Keeps libav from writing to standard error, while it lives; UserErrors tell what was wrong.
class QuietLibav {
 public:
  QuietLibav() : level_(av_log_get_level()) { av_log_set_level(AV_LOG_QUIET); }
  ~QuietLibav() { av_log_set_level(level_); }
  QuietLibav(const QuietLibav&) = delete;
  QuietLibav& operator=(const QuietLibav&) = delete;

 private:
  int level_;
};

LibavPtr<AVFormatContext> Open(const std::filesystem::path& path) {
  AVFormatContext* context = nullptr;
  // The prefix keeps a name with a colon from being taken for a protocol.
  if (avformat_open_input(&context, ("file:" + path.string()).c_str(), nullptr, nullptr) == 0) {
    return LibavPtr<AVFormatContext>(context);
  }
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw UserError(path.string() + ": no such file or folder");
  }
  if (std::filesystem::file_size(path, error) == 0 && !error) {
    throw UserError(path.string() + ": is empty (0 bytes)");
  }
  throw UserError(path.string() +
                  ": is neither GPX nor a video with positions (a recording that was cut off may "
                  "lack its index: repair it with a video tool)");
}

std::uint32_t TagOf(std::string_view tag) {
  ORB360_CHECK(tag.size() == 4, tag);
  return MKTAG(tag[0], tag[1], tag[2], tag[3]);
}

}  // namespace

MetadataSummary ReadMetadataTrack(const std::filesystem::path& path, std::string_view tag,
                                  const std::function<void(const MetadataSample&)>& take) {
  const std::uint32_t wanted = TagOf(tag);
  const QuietLibav quiet;
  const auto context = Open(path);
  MetadataSummary summary;
  const AVDictionaryEntry* entry = av_dict_get(context->metadata, "creation_time", nullptr, 0);
  if (entry != nullptr) summary.creation_time = ParseIsoTime(entry->value);
  double video_start = 0;
  bool has_track = false;
  bool has_video = false;
  for (unsigned i = 0; i < context->nb_streams; ++i) {
    AVStream& stream = *context->streams[i];
    const bool is_wanted = stream.codecpar->codec_tag == wanted;
    has_track = has_track || is_wanted;
    if (!is_wanted) stream.discard = AVDISCARD_ALL;
    const bool is_video = stream.codecpar->codec_type == AVMEDIA_TYPE_VIDEO;
    if (is_video && !has_video && stream.start_time != AV_NOPTS_VALUE) {
      video_start = static_cast<double>(stream.start_time) * av_q2d(stream.time_base);
    }
    has_video = has_video || is_video;
  }
  if (!has_track) return summary;
  const LibavPtr<AVPacket> packet(av_packet_alloc());
  while (av_read_frame(context.get(), packet.get()) == 0) {
    const AVStream& stream = *context->streams[packet->stream_index];
    if (stream.codecpar->codec_tag == wanted && packet->pts != AV_NOPTS_VALUE) {
      const double unit = av_q2d(stream.time_base);
      take({static_cast<double>(packet->pts) * unit - video_start,
            static_cast<double>(packet->duration) * unit,
            {reinterpret_cast<const char*>(packet->data), static_cast<size_t>(packet->size)}});
      ++summary.num_samples;
    }
    av_packet_unref(packet.get());
  }
  return summary;
}

}  // namespace orb360
