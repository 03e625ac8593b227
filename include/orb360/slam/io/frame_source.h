#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace orb360 {

/// One image of a sequence.
struct Frame {
  /// Index in the source, from 0. Skipped and damaged frames count.
  int index = 0;
  /// Time by the source's clock, seconds.
  double timestamp = 0.0;
  /// Image of the full sphere in equirectangular projection, CV_8UC3, BGR. Sequence scales it where
  /// it has not the size that the source announces.
  cv::Mat image;
};

/// What is known of an input before it is read.
struct SourceInfo {
  /// The path as the user gave it; messages use it.
  std::string name;
  /// Width and height of the full sphere as it is shown, pixels. Stored images have other sizes
  /// where their pixels are not square.
  cv::Size image_size;
  /// Frame rate, frames per second.
  double frame_rate = 0.0;
  /// Estimate of the number of frames. It is good enough for progress displays only, because
  /// containers may state a wrong number.
  std::optional<int> frame_count;
  /// Height of the camera above the ground, metres, if the input states it.
  std::optional<double> camera_height;
  /// CV_8U, a full sphere of any size: 0 where no image of the input shows anything. Empty if the
  /// images cover the whole sphere.
  cv::Mat coverage{};
};

/// Frames in order, from a file, a folder or a renderer. Sequence selects the frames that a user
/// asked for and decodes them ahead.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// Returns what is known of the input.
  virtual const SourceInfo& info() const = 0;

  /// Returns the next frame, or nullopt at the end. The image of a damaged frame is empty.
  virtual std::optional<Frame> Read() = 0;

  /// Skips the next frame without decoding more than necessary. Returns false at the end.
  virtual bool Skip() = 0;

  /// Returns one line for each problem found in what was read since the last call.
  virtual std::vector<std::string> TakeWarnings() { return {}; }
};

}  // namespace orb360
