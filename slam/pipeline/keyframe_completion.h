#pragma once

#include <functional>
#include <future>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/depth/dense_ground.h"
#include "slam/depth/depth_completer.h"
#include "slam/map/map.h"
#include "slam/pipeline/depth_options.h"

namespace orb360 {

/// Where completed depth goes: each keyframe's frame index and depth.
using DepthSink = std::function<void(int frame_index, DenseDepth depth)>;

/// What completion tells of a keyframe.
struct CompletedKeyframe {
  int frame_index;
  std::vector<RangePrior> priors;  // by feature
  std::optional<DenseGround> ground;
};

/// Completes the depth of keyframes beside tracking, one keyframe at a time.
class KeyframeCompletion {
 public:
  /// `sink` is called in the order of the keyframes, one at a time, on other threads; `completer`
  /// must outlive this.
  KeyframeCompletion(DepthCompleter* completer, DepthSink sink, const DepthOptions& options);

  /// Begins with a keyframe, and says whether it shows enough points for that; none may be under
  /// way. `color` and `points` are of the completer's camera. It is due when as many frames as
  /// configured have followed `num_frames`.
  bool Start(const Keyframe& keyframe, const cv::Mat& color, std::vector<SparsePoint> points,
             int num_frames);
  /// Frame index of the keyframe that is pending; none where there is none.
  std::optional<int> pending() const;
  bool IsDue(int num_frames) const { return job_ && num_frames >= job_->due; }
  bool IsRunning() const;
  /// Waits for the keyframe that is pending, but not for its sink. `unit_scale`: units of the map
  /// of today in one unit of the map when it was started. Throws what went wrong, with the sinks of
  /// those before as well.
  CompletedKeyframe Take(double unit_scale);
  /// Waits for all sinks. Throws what the last one has thrown.
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
  std::future<void> stored_;  // of the newest keyframe: the sink is done
};

}  // namespace orb360
