#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/io/video/libav.h"

namespace orb360 {

/// Decodes the frames of one video track of a file by FFmpeg's libraries (libav*). A file of
/// several tracks is opened once for each.
///
/// The images do not depend on the number of threads: FFmpeg's decoders give the same for an
/// undamaged stream, but how they conceal damage depends on timing, so a stream is decoded by one
/// thread from the keyframe before the first damage on.
class VideoTrack {
 public:
  /// Opens the number-th video track of a file, counted from 0, and decodes it by that many
  /// threads, 0 for one for each core. Throws UserError if it cannot be read.
  explicit VideoTrack(const std::string& path, int number = 0, int threads = 0);

  /// Decodes the next frame. Returns false at the end. Packets that cannot be decoded are passed
  /// over.
  bool Advance();

  /// The frame that was decoded last.
  const AVFrame& frame() const { return *frame_; }
  /// Its index, from 0.
  int index() const { return index_; }
  /// Its time after the start of the track, seconds: the file's where it increases, otherwise the
  /// previous frame's plus one frame time.
  double timestamp() const { return timestamp_; }
  /// When the track starts by the clock that all tracks of the file have, seconds.
  double start_time() const;

  const std::string& path() const { return path_; }
  const AVStream& stream() const { return *stream_; }
  /// Width and height of the stored images, pixels.
  cv::Size size() const { return {stream_->codecpar->width, stream_->codecpar->height}; }
  /// Width of a stored pixel over its height as shown; 1 where the file does not tell.
  double sample_aspect() const;
  /// Frames per second; the mean where the rate varies.
  double frame_rate() const { return frame_rate_; }
  /// Number of frames as stated or computed from the duration, for progress displays only.
  std::optional<int> frame_count() const { return frame_count_; }

  /// After the end: returns one line if the track has ended before its stated end, otherwise
  /// nullopt. Messages call the file `path`.
  std::optional<std::string> EarlyEnd() const;

 private:
  void Open(int threads);
  void SendPacket();
  LibavPtr<AVFrame> DecodeFrame();
  bool DecodeAhead();
  void RestartWithOneThread();

  const std::string path_;
  const int number_;
  LibavPtr<AVFormatContext> format_;
  AVStream* stream_ = nullptr;  // owned by format_
  LibavPtr<AVCodecContext> decoder_;
  const LibavPtr<AVPacket> packet_;
  LibavPtr<AVFrame> frame_;
  std::deque<LibavPtr<AVFrame>> ahead_;  // decoded after frame_
  double frame_rate_ = 0.0;
  std::optional<int> frame_count_;
  bool has_one_thread_ = false;
  bool has_sent_all_ = false;
  bool is_damaged_ = false;  // what was decoded since the last start
  int hidden_frames_ = 0;    // decoded but left out by the file's edit list
  int index_ = -1;
  double timestamp_ = 0.0;
};

/// Returns the number of video tracks of a file; 0 if it cannot be read.
int CountVideoTracks(const std::string& path);

}  // namespace orb360
