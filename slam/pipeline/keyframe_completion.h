#pragma once

#include <functional>
#include <future>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/depth/dense_ground.h"
#include <orb360/slam/depth/depth_completer.h>
#include <orb360/slam/map/map.h>
#include <orb360/slam/pipeline/depth_options.h>

namespace orb360 {

/// Receives the frame index and the completed depth of each keyframe.
using DepthSink = std::function<void(int frame_index, DenseDepth depth)>;

/// The result of completion that mapping uses.
struct CompletedKeyframe {
  int frame_index;
  std::vector<RangePrior> priors;  ///< By feature.
  std::optional<DenseGround> ground;
};

/// Completes the depth of keyframes beside tracking, one keyframe at a time.
class KeyframeCompletion {
 public:
  /// `sink` is called on other threads, one call at a time, in the order of the keyframes.
  /// `completer` must outlive the object.
  KeyframeCompletion(DepthCompleter* completer, DepthSink sink, const DepthOptions& options);

  /// Starts the completion of a keyframe. False where the keyframe shows too few points. `color`
  /// (CV_8UC3, BGR) and `points` are those of the completer's camera. The result is due when the
  /// configured number of frames have followed `num_frames`. Contract: no keyframe is pending.
  bool Start(const Keyframe& keyframe, const cv::Mat& color, std::vector<SparsePoint> points,
             int num_frames);
  /// Frame index of the pending keyframe, if there is one.
  std::optional<int> pending() const;
  bool IsDue(int num_frames) const { return job_ && num_frames >= job_->due; }
  bool IsRunning() const;
  /// Waits for the pending keyframe, but not for its sink. `unit_scale` is the number of present
  /// units of the map in one unit of the map when the completion was started. Throws what the
  /// completion or the sink of an earlier keyframe has thrown.
  CompletedKeyframe Take(double unit_scale);
  /// Waits for all sinks. Throws what the last of them has thrown.
  void Flush();

 private:
  struct Found {
    std::vector<RangePrior> priors;
    std::optional<DenseGround> ground;
  };
  struct Job {
    std::future<Found> found;
    int frame_index;
    int due;
  };

  DepthCompleter* const completer_;
  const DepthSink sink_;
  const DepthOptions options_;
  std::optional<Job> job_;
  /// Ready when the sink has returned for the newest keyframe.
  std::future<void> stored_;
};

}  // namespace orb360
