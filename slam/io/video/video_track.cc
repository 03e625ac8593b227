#include "slam/io/video/video_track.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// Many containers compute frame counts from durations, and edit lists hide a frame or two, so only
/// a larger difference deserves a warning.
constexpr int kFrameCountSlack = 2;

/// Frame rate of a video that does not state one, frames per second.
constexpr double kDefaultFrameRate = 30.0;

/// The error of a file in which there is no video.
UserError NoVideo(const std::string& path) {
  if (std::filesystem::file_size(path) == 0) return UserError(path + ": is empty (0 bytes)");
  return UserError(path +
                   ": cannot be read as a video; check that it plays (a recording that was cut off "
                   "may lack its index: repair it with a video tool)");
}

double PerSecond(AVRational rate) { return rate.num > 0 && rate.den > 0 ? av_q2d(rate) : 0.0; }

/// The nominal rate, or the mean where the rate varies so much that FFmpeg takes the finest step of
/// the times for the nominal rate.
double FrameRate(AVFormatContext& format, AVStream& stream) {
  constexpr double kMaxRatio = 2.0;
  const double nominal = PerSecond(av_guess_frame_rate(&format, &stream, nullptr));
  const double mean = PerSecond(stream.avg_frame_rate);
  if (mean > 0.0 && nominal > kMaxRatio * mean) return mean;
  return nominal > 0.0 ? nominal : kDefaultFrameRate;
}

std::optional<int> FrameCount(const AVFormatContext& format, const AVStream& stream, double rate) {
  double count = static_cast<double>(stream.nb_frames);
  if (count <= 0.0 && format.duration != AV_NOPTS_VALUE) {
    count = std::floor(static_cast<double>(format.duration) / AV_TIME_BASE * rate + 0.5);
  }
  if (count >= 1.0 && count < 1e9) return static_cast<int>(count);
  return std::nullopt;
}

}  // namespace

VideoTrack::VideoTrack(const std::string& path, int number, int threads)
    : path_(path), number_(number), packet_(av_packet_alloc()) {
  Open(threads);
  if (size().width <= 0 || size().height <= 0) {
    throw UserError(path + ": does not tell the size of its images; check that it plays");
  }
  frame_rate_ = FrameRate(*format_, *stream_);
  frame_count_ = FrameCount(*format_, *stream_, frame_rate_);
}

void VideoTrack::Open(int threads) {
  decoder_.reset();
  format_ = OpenFormat(path_);
  stream_ = format_ ? FindVideoStream(*format_, number_) : nullptr;
  if (stream_ == nullptr) {
    if (number_ == 0 || CountVideoTracks(path_) == 0) throw NoVideo(path_);
    throw UserError(path_ + ": has no video track " + std::to_string(number_ + 1));
  }
  for (unsigned i = 0; i < format_->nb_streams; ++i) {
    if (format_->streams[i] != stream_) format_->streams[i]->discard = AVDISCARD_ALL;
  }
  decoder_ = OpenDecoder(*stream_, threads);
  if (!decoder_) {
    throw UserError(path_ + ": its video is coded as " +
                    avcodec_get_name(stream_->codecpar->codec_id) +
                    ", which cannot be decoded; convert it to H.264 or HEVC");
  }
  has_one_thread_ = decoder_->thread_count == 1;
  has_sent_all_ = false;
  is_damaged_ = false;
}

double VideoTrack::sample_aspect() const {
  const AVRational aspect = av_guess_sample_aspect_ratio(format_.get(), stream_, nullptr);
  return aspect.num > 0 && aspect.den > 0 ? av_q2d(aspect) : 1.0;
}

/// Sends the next packet of the track to the decoder, or tells it that there is none left. The
/// decoder drops a packet that it cannot use.
void VideoTrack::SendPacket() {
  while (av_read_frame(format_.get(), packet_.get()) >= 0) {
    const bool is_ours = packet_->stream_index == stream_->index;
    if (is_ours && (packet_->flags & AV_PKT_FLAG_DISCARD) != 0) ++hidden_frames_;
    if (is_ours) is_damaged_ |= avcodec_send_packet(decoder_.get(), packet_.get()) < 0;
    av_packet_unref(packet_.get());
    if (is_ours) return;
  }
  avcodec_send_packet(decoder_.get(), nullptr);
  has_sent_all_ = true;
}

/// Returns the next frame in the order of display, or null at the end.
LibavPtr<AVFrame> VideoTrack::DecodeFrame() {
  LibavPtr<AVFrame> frame(av_frame_alloc());
  while (true) {
    const int result = avcodec_receive_frame(decoder_.get(), frame.get());
    if (result == 0) {
      is_damaged_ |= frame->decode_error_flags != 0 || (frame->flags & AV_FRAME_FLAG_CORRUPT) != 0;
      return frame;
    }
    if (result == AVERROR_EOF) return nullptr;
    if (result == AVERROR(EAGAIN)) {
      if (has_sent_all_) return nullptr;
      SendPacket();
    } else {
      is_damaged_ = true;  // of one frame; the decoder is ready for the next
    }
  }
}

/// Goes back to the keyframe before the frame that was given last, or to the start if there is
/// none, and on to the frame after it.
void VideoTrack::RestartWithOneThread() {
  ahead_.clear();
  const int hidden_frames = hidden_frames_;
  Open(1);
  const std::int64_t last = frame_ ? frame_->best_effort_timestamp : AV_NOPTS_VALUE;
  if (index_ < 0) return;
  const bool can_seek = last != AV_NOPTS_VALUE && av_seek_frame(format_.get(), stream_->index, last,
                                                                AVSEEK_FLAG_BACKWARD) >= 0;
  for (int i = 0; can_seek || i <= index_; ++i) {
    LibavPtr<AVFrame> frame = DecodeFrame();
    if (!frame) break;
    if (can_seek && frame->best_effort_timestamp > last) {
      ahead_.push_back(std::move(frame));
      break;
    }
  }
  hidden_frames_ = hidden_frames;
}

/// Decodes the next frame and as many behind it as can have been decoded before it, because they
/// would show that it is damaged. Returns false at the end.
bool VideoTrack::DecodeAhead() {
  while (true) {
    const auto wanted =
        static_cast<size_t>(has_one_thread_ ? 1 : 2 + std::max(decoder_->has_b_frames, 0));
    if (ahead_.size() >= wanted) return true;
    LibavPtr<AVFrame> frame = DecodeFrame();
    if (is_damaged_ && !has_one_thread_) {
      RestartWithOneThread();
    } else if (frame) {
      ahead_.push_back(std::move(frame));
    } else {
      return !ahead_.empty();
    }
  }
}

double VideoTrack::start_time() const {
  const std::int64_t start = stream_->start_time == AV_NOPTS_VALUE ? 0 : stream_->start_time;
  return static_cast<double>(start) * av_q2d(stream_->time_base);
}

bool VideoTrack::Advance() {
  if (!DecodeAhead()) return false;
  frame_ = std::move(ahead_.front());
  ahead_.pop_front();
  ++index_;
  const std::int64_t pts = frame_->best_effort_timestamp;
  const std::int64_t start = stream_->start_time == AV_NOPTS_VALUE ? 0 : stream_->start_time;
  const double timestamp = static_cast<double>(pts - start) * av_q2d(stream_->time_base);
  if (pts != AV_NOPTS_VALUE && (index_ == 0 || timestamp > timestamp_)) {
    timestamp_ = timestamp;
  } else if (index_ > 0) {
    timestamp_ += 1.0 / frame_rate_;
  }
  return true;
}

std::optional<std::string> VideoTrack::EarlyEnd() const {
  if (!frame_count_) return std::nullopt;
  const int frames = index_ + 1;
  bool is_early = frames + hidden_frames_ + kFrameCountSlack < *frame_count_;
  if (stream_->nb_frames <= 0 && frames > 1) {
    // The count is an estimate that variable frame rates mislead; the duration is not.
    const double interval = std::max(1.0 / frame_rate_, timestamp_ / (frames - 1));
    const double end = timestamp_ + (1 + kFrameCountSlack) * interval;
    is_early &= end < static_cast<double>(format_->duration) / AV_TIME_BASE;
  }
  if (!is_early) return std::nullopt;
  return path_ + ": ends at frame " + std::to_string(frames) + " of " +
         std::to_string(*frame_count_) + " (truncated or damaged); what was decoded is kept";
}

int CountVideoTracks(const std::string& path) {
  const LibavPtr<AVFormatContext> format = OpenFormat(path);
  int count = 0;
  while (format && FindVideoStream(*format, count) != nullptr) ++count;
  return count;
}

}  // namespace orb360
