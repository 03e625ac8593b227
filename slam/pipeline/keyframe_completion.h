#pragma once

#include <future>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/depth/dense_ground.h"
#include <orb360/slam/depth/depth_completer.h>
#include <orb360/slam/map/map.h>
#include <orb360/slam/pipeline/depth_options.h>

namespace orb360 {

/// What mapping uses of the completed depth of a keyframe (paper III-D).
struct CompletedKeyframe {
  int frame_index;
  std::vector<RangePrior> priors;  ///< By feature.
  std::optional<DenseGround> ground;
};

/// Completes the depth of keyframes for mapping, beside tracking, one keyframe at a time.
class KeyframeCompletion {
 public:
  /// `completer` must outlive the object.
  KeyframeCompletion(DepthCompleter* completer, const DepthOptions& options)
      : completer_(completer), options_(options) {}

  /// Starts the completion of a keyframe, unless it shows too few points. `color` (CV_8UC3, BGR)
  /// and `points` are those of the completer's camera. The result is due when the configured number
  /// of frames have followed `num_frames`. Contract: no keyframe is pending.
  void Start(const Keyframe& keyframe, const cv::Mat& color, std::vector<SparsePoint> points,
             int num_frames);
  /// Frame index of the pending keyframe, if there is one.
  std::optional<int> pending() const;
  bool IsDue(int num_frames) const { return job_ && num_frames >= job_->due; }
  bool IsRunning() const;
  /// Waits for the pending keyframe. `unit_scale` is the number of present units of the map in one
  /// unit of the map when the completion was started. Throws what the completion has thrown.
  CompletedKeyframe Take(double unit_scale);
  /// Waits for the pending keyframe, if there is one, and drops its result.
  void Drop() { job_.reset(); }

 private:
  struct Job {
    std::future<CompletedKeyframe> result;
    int frame_index;
    int due;
  };

  DepthCompleter* const completer_;
  const DepthOptions options_;
  std::optional<Job> job_;
};

}  // namespace orb360
