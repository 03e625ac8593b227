#pragma once

#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "slam/io/bounded_queue.h"
#include "slam/io/frame_source.h"

namespace orb360 {

/// Which frames of an input are used, and how.
struct SequenceOptions {
  /// Frames a second, in place of the input's own rate and timestamps; 0: as the input says.
  double fps = 0.0;
  /// Every stride-th frame, at least 1.
  int stride = 1;
  /// The first frame, from 0.
  int start = 0;
  /// At most so many frames; 0: all.
  int max_frames = 0;
  /// Scales every image to this size; empty: as it is. Must be near 2:1 (IsFullSphere).
  cv::Size resize;
};

/// The frames a user asked for, in order, decoded ahead on a thread of its own. One thread calls.
class Sequence {
 public:
  /// Throws UserError when the images cannot be a full sphere, ContractError for options out of
  /// range.
  Sequence(std::unique_ptr<FrameSource> source, const SequenceOptions& options);
  ~Sequence();
  Sequence(const Sequence&) = delete;
  Sequence& operator=(const Sequence&) = delete;

  /// The next frame that can be decoded; nullopt at the end, for good. Throws UserError where the
  /// input becomes unusable (an image of another size) and at the end of an input that gave no
  /// frame at all.
  std::optional<Frame> Next();

  /// Of the images that Next gives.
  cv::Size image_size() const { return image_size_; }
  /// Frames a second of the source, before stride.
  double frame_rate() const { return frame_rate_; }
  /// About how many frames Next will give, where that is known; for progress displays only.
  std::optional<int> frame_count() const { return frame_count_; }
  /// Height of the camera above the ground in metres, where the input states it.
  std::optional<double> camera_height() const { return camera_height_; }

  /// What the user should know about the frames so far, one line each: damaged images, a truncated
  /// video. Each is given once.
  std::vector<std::string> TakeWarnings() { return std::exchange(warnings_, {}); }

 private:
  /// What the decoding thread hands over.
  struct Step {
    std::optional<Frame> frame;
    std::vector<std::string> warnings;
    std::exception_ptr error;
  };

  void DecodeAhead();
  bool DecodeAll();

  const std::unique_ptr<FrameSource> source_;  // Of the decoding thread once that runs.
  const SequenceOptions options_;
  const std::string name_;
  const std::optional<double> camera_height_;
  cv::Size image_size_;
  double frame_rate_ = 0.0;
  std::optional<int> frame_count_;
  std::vector<std::string> warnings_;
  bool has_given_frame_ = false;
  BoundedQueue<Step> queue_;
  std::thread decoder_;  // Last: it uses the others.
};

/// Opens a video file, a folder of images, or a sequence folder (Dataset). Throws UserError when
/// there is no such input, it cannot be read, or its pictures are not full spheres.
std::unique_ptr<Sequence> OpenSequence(const std::string& input, const SequenceOptions& options);

}  // namespace orb360
