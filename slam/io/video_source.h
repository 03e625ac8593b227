#pragma once

#include <string>
#include <vector>

#include <opencv2/videoio.hpp>

#include <orb360/slam/io/frame_source.h>

namespace orb360 {

/// Reads the frames of a video file by OpenCV's FFmpeg reader. Timestamps are the file's where they
/// increase, otherwise the previous frame's plus one frame time. A file that ends before its
/// announced number of frames (truncated, damaged) gives the frames that can be decoded and a
/// warning. Silences FFmpeg's own messages in the whole process unless OPENCV_FFMPEG_LOGLEVEL is
/// set.
class VideoSource : public FrameSource {
 public:
  /// Throws UserError if no video can be read from `path`.
  explicit VideoSource(const std::string& path);

  const SourceInfo& info() const override { return info_; }
  std::optional<Frame> Read() override;
  bool Skip() override;
  std::vector<std::string> TakeWarnings() override { return std::exchange(warnings_, {}); }

 private:
  cv::VideoCapture capture_;
  SourceInfo info_;
  std::vector<std::string> warnings_;
  int next_index_ = 0;
  double last_timestamp_ = 0.0;
};

}  // namespace orb360
