#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace orb360 {

/// One picture of a sequence.
struct Frame {
  /// Position in the source, from 0; skipped and damaged frames count.
  int index = 0;
  /// Seconds, by the source's clock.
  double timestamp = 0.0;
  /// CV_8UC3, BGR, the full sphere in equirectangular projection.
  cv::Mat image;
};

/// What is known of an input before it is read.
struct SourceInfo {
  /// How messages call it: the path as the user gave it.
  std::string name;
  cv::Size image_size;
  /// Frames a second.
  double frame_rate = 0.0;
  /// An estimate, fit for progress displays only: containers announce what they like.
  std::optional<int> frame_count;
  /// Height of the camera above the ground in metres, where the input states it.
  std::optional<double> camera_height;
};

/// Frames one after the other, as a file, a folder or a renderer has them. Sequence makes of it
/// what a user asked for: every n-th frame, from the m-th on, decoded ahead.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  virtual const SourceInfo& info() const = 0;

  /// The next frame; its image is empty where it is damaged. nullopt at the end.
  virtual std::optional<Frame> Read() = 0;

  /// Passes over the next frame without decoding more than necessary. False at the end.
  virtual bool Skip() = 0;

  /// One line for each thing a user should know about what was read since the last call.
  virtual std::vector<std::string> TakeWarnings() { return {}; }
};

}  // namespace orb360
