#include "slam/io/video_source.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

/// Many containers compute frame counts from durations, and edit lists hide a frame or two, so only
/// a larger difference deserves a warning.
constexpr int kFrameCountSlack = 2;

/// Frame rate of a video that does not state one, frames per second.
constexpr double kDefaultFrameRate = 30.0;

cv::VideoCapture Open(const std::string& path) {
  // OpenCV reads this variable when it first opens a video; -8 is FFmpeg's AV_LOG_QUIET.
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", /*overwrite=*/0);
  cv::VideoCapture capture(path, cv::CAP_FFMPEG);
  if (capture.isOpened()) return capture;
  if (std::filesystem::file_size(path) == 0) throw UserError(path + ": is empty (0 bytes)");
  throw UserError(path +
                  ": cannot be read as a video; check that it plays (a recording that was cut off "
                  "may lack its index: repair it with a video tool)");
}

}  // namespace

VideoSource::VideoSource(const std::string& path) : capture_(Open(path)) {
  info_.name = path;
  info_.image_size = {static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_WIDTH)),
                      static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_HEIGHT))};
  const double rate = capture_.get(cv::CAP_PROP_FPS);
  info_.frame_rate = std::isfinite(rate) && rate > 0.0 ? rate : kDefaultFrameRate;
  const double count = capture_.get(cv::CAP_PROP_FRAME_COUNT);
  if (count >= 1.0 && count < 1e9) info_.frame_count = static_cast<int>(count);
}

bool VideoSource::Skip() {
  if (!capture_.grab()) {
    if (info_.frame_count && next_index_ + kFrameCountSlack < *info_.frame_count) {
      warnings_.push_back(info_.name + ": ends at frame " + std::to_string(next_index_) + " of " +
                          std::to_string(*info_.frame_count) +
                          " (truncated or damaged); what was decoded is kept");
    }
    return false;
  }
  const double timestamp = capture_.get(cv::CAP_PROP_POS_MSEC) / 1000.0;
  const bool is_sane =
      std::isfinite(timestamp) && (next_index_ == 0 || timestamp > last_timestamp_);
  if (is_sane) {
    last_timestamp_ = timestamp;
  } else if (next_index_ > 0) {
    last_timestamp_ += 1.0 / info_.frame_rate;
  }
  ++next_index_;
  return true;
}

std::optional<Frame> VideoSource::Read() {
  const int index = next_index_;
  if (!Skip()) return std::nullopt;
  Frame frame{index, last_timestamp_, {}};
  if (!capture_.retrieve(frame.image)) frame.image.release();
  if (frame.image.empty()) {
    warnings_.push_back(info_.name + ": frame " + std::to_string(index) +
                        " cannot be decoded; skipped");
  }
  return frame;
}

}  // namespace orb360
