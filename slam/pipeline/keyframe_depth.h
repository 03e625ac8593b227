#pragma once

#include <functional>
#include <future>
#include <map>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/depth/dense_ground.h"
#include "slam/depth/depth_completer.h"
#include "slam/map/map.h"
#include "slam/optimization/local_bundle_adjustment.h"
#include "slam/pipeline/options.h"

namespace orb360 {

/// Where completed depth goes: each keyframe's frame index and depth.
using DepthSink = std::function<void(int frame_index, DenseDepth depth)>;

/// The depth of keyframes, completed beside tracking, one keyframe at a time, and what one unit of
/// each is in the map of today.
class KeyframeDepth {
 public:
  /// What completion tells of a keyframe, in the unit of the map of today.
  struct Completed {
    int frame_index;
    std::vector<RangePrior> priors;  // by feature
    std::optional<DenseGround> ground;
  };

  /// `sink` is called in the order of the keyframes, one at a time, on other threads; `completer`
  /// must outlive this.
  KeyframeDepth(DepthCompleter* completer, DepthSink sink, const Options& options);

  const EquirectangularCamera& camera() const { return completer_->camera(); }
  bool Wants(KeyframeId id) const { return id % options_.every_keyframes == 0; }

  /// Begins with a keyframe, where it shows enough points; none may be under way. `color` and
  /// `points` are of camera(). It is due when as many frames as configured have followed
  /// `num_frames`.
  void Start(const Keyframe& keyframe, const cv::Mat& color, std::vector<SparsePoint> points,
             int num_frames);
  bool is_pending() const { return job_.has_value(); }
  bool IsDue(int num_frames) const { return job_ && num_frames >= job_->due; }
  bool IsRunning() const;
  /// Waits for the keyframe that is pending, but not for its sink. Throws what went wrong, with
  /// the sinks of those before as well.
  Completed Take();
  /// Waits for all sinks. Throws what the last one has thrown.
  void Flush();

  /// The unit of the keyframe's map has become larger by 1 / factor; without effect on others than
  /// those that were started.
  void Rescale(int frame_index, double factor);
  /// By frame index: units of the map of today in one of the depth.
  const std::map<int, double>& scales() const { return scales_; }

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
  std::map<int, double> scales_;
};

}  // namespace orb360
