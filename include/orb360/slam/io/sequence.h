#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <orb360/slam/io/frame_source.h>

namespace orb360 {

/// The frames of an input that are used, and how.
struct SequenceOptions {
  /// Frame rate that replaces the input's own rate and timestamps, frames per second. 0: as the
  /// input says.
  double fps = 0.0;
  /// Every stride-th frame is used; at least 1.
  int stride = 1;
  /// Index of the first frame, from 0.
  int start = 0;
  /// Largest number of frames; 0: all.
  int max_frames = 0;
  /// Indices of the only frames that are used, ascending, each once, in place of the selection by
  /// the numbers above; empty: not given.
  /// Others are not decoded where the format allows it.
  std::vector<int> only = {};
  /// Size to which every image is scaled; empty: not scaled. Must be near 2:1 (IsFullSphere).
  cv::Size resize;
  /// Calibration file or name of a preset, for a video or folder of images of two fisheye lenses
  /// that are stitched while they are read. Empty: the input is equirectangular, or tells its
  /// projection.
  std::string lens;
};

/// The frames that a user asked for, in order. They are decoded ahead on another thread. All
/// methods must be called from one thread.
class Sequence {
 public:
  /// Throws UserError when the images cannot be a full sphere, and ContractError for options out of
  /// range.
  Sequence(std::unique_ptr<FrameSource> source, const SequenceOptions& options);
  ~Sequence();
  Sequence(const Sequence&) = delete;
  Sequence& operator=(const Sequence&) = delete;

  /// Returns the next frame that can be decoded, or nullopt at the end. Throws UserError if the
  /// input becomes unusable (an image of another size), and at the end of an input that gave no
  /// frame at all.
  std::optional<Frame> Next();

  /// Size of the images that Next returns.
  cv::Size image_size() const { return image_size_; }
  /// Frame rate of the source before stride, frames per second.
  double frame_rate() const { return frame_rate_; }
  /// Approximate number of frames that Next will return, if it is known; for progress displays
  /// only.
  std::optional<int> frame_count() const { return frame_count_; }
  /// Height of the camera above the ground, metres, if the input states it.
  std::optional<double> camera_height() const { return camera_height_; }
  /// Mask of image_size, CV_8U: 0 where the input shows nothing, 255 elsewhere. Empty if it shows
  /// the whole sphere.
  const cv::Mat& coverage() const { return coverage_; }

  /// Returns one line for each problem of the frames so far, such as damaged images or a truncated
  /// video. Each line is returned once.
  std::vector<std::string> TakeWarnings() { return std::exchange(warnings_, {}); }

 private:
  class Decoder;  // reads the source on a thread of its own

  const SequenceOptions options_;
  const std::string name_;
  const std::optional<double> camera_height_;
  cv::Size image_size_;
  double frame_rate_ = 0.0;
  std::optional<int> frame_count_;
  cv::Mat coverage_;
  std::vector<std::string> warnings_;
  bool has_given_frame_ = false;
  std::unique_ptr<Decoder> decoder_;
};

/// Opens a video file, a folder of images, or a sequence folder (Dataset). A `.360` file and, with
/// options.lens, videos and images of two fisheye lenses are stitched. Throws UserError if the
/// input does not exist, cannot be read, or does not consist of full spheres.
std::unique_ptr<Sequence> OpenSequence(const std::string& input, const SequenceOptions& options);

}  // namespace orb360
